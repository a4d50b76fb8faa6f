#include "firmware/site/rejection.h"

namespace etcm::firmware {

const char* explain(const Rejection& rejection) {
  switch (rejection.domain) {
    case DomainPlace::outside:
      return "It stands outside the domain; correct its position, or the outline in the site file.";
    case DomainPlace::in_hole:
      return "It stands in a hole of the domain; correct its position, or the hole in the site "
             "file.";
    case DomainPlace::inside:
      break;
  }
  return etcm::explain(rejection.mesh);
}

bool is_want_of_room(const Rejection& rejection) {
  switch (rejection.mesh) {
    case Status::out_of_vertices:
    case Status::out_of_features:
    case Status::steiner_budget:
    case Status::work_limit:
    case Status::grid_exhausted:
      return true;
    default:
      return false;
  }
}

}  // namespace etcm::firmware

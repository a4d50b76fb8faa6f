#include "firmware/publish/quarantine_reason.h"

#include <algorithm>
#include <array>

namespace etcm::firmware {

namespace {

constexpr auto reasons = std::to_array<QuarantineReason>({
    {1, DomainPlace::outside, IdentityConflict::none, "it stands outside the domain"},
    {2, DomainPlace::in_hole, IdentityConflict::none, "it stands in a hole of the domain"},
    {10, Status::duplicate_vertex, IdentityConflict::none, "another node stands exactly there"},
    {11, Status::bad_coordinate, IdentityConflict::none, "a coordinate is out of range"},
    {12, Status::zero_length_feature, IdentityConflict::none, "the feature begins where it ends"},
    {13, Status::repeated_feature, IdentityConflict::none, "the feature is in the mesh already"},
    {14, Status::overlapping_features, IdentityConflict::none,
     "the feature runs along a part of another"},
    {15, Status::crossing_features, IdentityConflict::none, "features would cross"},
    {16, Status::endpoint_in_use, IdentityConflict::none, "a feature ends there"},
    {20, Status::out_of_vertices, IdentityConflict::none, "vertices_max is reached"},
    {21, Status::out_of_features, IdentityConflict::none, "features_max is reached"},
    {22, Status::steiner_budget, IdentityConflict::none, "steiner_max is reached"},
    {23, Status::work_limit, IdentityConflict::none, "work_max is reached"},
    {24, Status::grid_exhausted, IdentityConflict::none,
     "a subsegment of a feature is too short to be split"},
    {30, Status::ok, IdentityConflict::same_serial, "another node has this serial"},
    {31, Status::ok, IdentityConflict::same_unit, "another node answers at this unit"},
    {32, Status::ok, IdentityConflict::swapped_words, "a known serial with its words swapped"},
    {33, Status::ok, IdentityConflict::no_room, "too many nodes without a unit are known"},
    {34, Status::ok, IdentityConflict::other_gateway,
     "another gateway hears this serial in another place"},
    {other_reason, Status::ok, IdentityConflict::none, "anything else; the log says what"},
});

constexpr bool has_codes_in_order() {
  for (std::size_t i = 1; i < reasons.size(); ++i) {
    if (reasons[i - 1].code >= reasons[i].code) return false;
  }
  return true;
}
static_assert(has_codes_in_order());

}  // namespace

std::span<const QuarantineReason> quarantine_reasons() { return reasons; }

std::uint16_t reason_code(const Rejection& rejection, IdentityConflict conflict) {
  const auto found = std::find_if(reasons.begin(), reasons.end(), [&](const auto& reason) {
    return reason.rejection == rejection && reason.conflict == conflict;
  });
  return found == reasons.end() ? other_reason : found->code;
}

}  // namespace etcm::firmware

#include "compare/systems/attempt.h"

#include <algorithm>

#include "etcm/audit.h"

namespace etcm::compare {

const char* to_string(Verdict verdict) noexcept {
  switch (verdict) {
    case Verdict::ok:
      return "ok";
    case Verdict::not_ended:
      return "not_ended";
    case Verdict::out_of_room:
      return "out_of_room";
    case Verdict::not_delaunay:
      return "not_delaunay";
    case Verdict::not_conforming:
      return "not_conforming";
  }
  return "unknown";
}

Verdict verdict_of(const Mesh& mesh) noexcept {
  switch (audit(mesh).broken) {
    case Rule::none:
      return Verdict::ok;
    case Rule::on_feature:
    case Rule::conforming:
      return Verdict::not_conforming;
    default:
      return Verdict::not_delaunay;
  }
}

std::size_t steiner_room(const inputs::Graph& graph) noexcept {
  return std::min<std::size_t>(60 * graph.nodes.size() + 4000, 2'000'000);
}

}  // namespace etcm::compare

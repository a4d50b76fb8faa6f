#include "firmware/publish/quarantine_reason.h"

#include <algorithm>
#include <array>

namespace etcm::firmware {

namespace {

constexpr auto reasons = std::to_array<QuarantineReason>({
    {1, DomainPlace::outside, Doubt::none, "it stands outside the domain"},
    {2, DomainPlace::in_hole, Doubt::none, "it stands in a hole of the domain"},
    {10, Status::duplicate_vertex, Doubt::none, "another node stands exactly there"},
    {11, Status::bad_coordinate, Doubt::none, "a coordinate is out of range"},
    {12, Status::zero_length_feature, Doubt::none, "the feature begins where it ends"},
    {13, Status::repeated_feature, Doubt::none, "the feature is in the mesh already"},
    {14, Status::overlapping_features, Doubt::none, "the feature runs along a part of another"},
    {15, Status::crossing_features, Doubt::none, "features would cross"},
    {16, Status::endpoint_in_use, Doubt::none, "a feature ends there"},
    {20, Status::out_of_vertices, Doubt::none, "vertices_max is reached"},
    {21, Status::out_of_features, Doubt::none, "features_max is reached"},
    {22, Status::steiner_budget, Doubt::none, "steiner_max is reached"},
    {23, Status::step_limit, Doubt::none, "steps_max is reached"},
    {24, Status::grid_exhausted, Doubt::none, "a stretch of a feature is too short to be split"},
    {30, Status::ok, Doubt::same_serial, "another node has this serial"},
    {31, Status::ok, Doubt::same_unit, "another node answers at this unit"},
    {32, Status::ok, Doubt::swapped_words, "a known serial with its words swapped"},
    {33, Status::ok, Doubt::no_room, "too many nodes without a unit are known"},
    {other_reason, Status::ok, Doubt::none, "anything else; the log says what"},
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

std::uint16_t reason_code(const Refusal& refusal, Doubt doubt) {
  const auto found = std::find_if(reasons.begin(), reasons.end(), [&](const auto& reason) {
    return reason.refusal == refusal && reason.doubt == doubt;
  });
  return found == reasons.end() ? other_reason : found->code;
}

}  // namespace etcm::firmware

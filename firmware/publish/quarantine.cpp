#include "firmware/publish/quarantine.h"

namespace etcm::firmware {

const char* explain(const QuarantineEntry& entry) {
  switch (entry.conflict) {
    case IdentityConflict::none:
    case IdentityConflict::waiting:
      return explain(entry.rejection);
    case IdentityConflict::same_serial:
      return "another node has this serial too: give one of them a serial of its own";
    case IdentityConflict::same_unit:
      return "another node answers at this unit too: give one of them a unit of its own";
    case IdentityConflict::swapped_words:
      return "a known serial with its words swapped: set `word_order` of the bus";
    case IdentityConflict::no_room:
      return "too many nodes without a unit are known already: wait for them to leave";
    case IdentityConflict::other_gateway:
      return "another gateway hears a node with this serial too, in another place: give one of "
             "them "
             "a serial of its own";
  }
  return "";
}

std::size_t quarantine_max(const NodeTable& nodes, const FeatureTable& features,
                           const AnchorTable& anchors, const Admission& admission) {
  return nodes.records().size() + features.records().size() + anchors.records().size() +
         admission.conflicts().size();
}

void list_quarantine(const NodeTable& nodes, const FeatureTable& features,
                     const AnchorTable& anchors, const Admission& admission,
                     std::vector<QuarantineEntry>& list) {
  list.clear();
  for (const NodeRecord& node : nodes.records()) {
    if (!node.is_known() || !node.is_quarantined()) continue;
    list.push_back({.serial = node.serial,
                    .unit_index = node.unit_index,
                    .position = node.rejected_at,
                    .rejection = node.rejection,
                    .since = node.rejected_since});
  }
  std::uint32_t number = 0;
  for (const FeatureRecord& feature : features.records()) {
    ++number;
    if (feature.rejection == Status::ok) continue;
    list.push_back({.feature = number,
                    .blocker = feature.blocker,
                    .rejection = feature.rejection,
                    .since = feature.rejected_since});
  }
  for (const AnchorRecord& anchor : anchors.records()) {
    if (anchor.rejection.is_none()) continue;
    list.push_back({.position = anchor.settings.position,
                    .rejection = anchor.rejection,
                    .since = anchor.rejected_since});
  }
  UnitIndex unit{0};
  for (const UnitConflict& conflict : admission.conflicts()) {
    if (conflict.is_alarm()) {
      list.push_back({.serial = conflict.serial,
                      .unit_index = unit,
                      .conflict = conflict.conflict,
                      .since = conflict.since});
    }
    ++unit.value;
  }
}

}  // namespace etcm::firmware

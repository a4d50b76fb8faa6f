#include "firmware/publish/quarantine.h"

namespace etcm::firmware {

const char* explain(const QuarantineEntry& entry) {
  switch (entry.doubt) {
    case Doubt::none:
    case Doubt::waiting:
      return explain(entry.refusal);
    case Doubt::same_serial:
      return "another node has this serial too: give one of them a serial of its own";
    case Doubt::same_unit:
      return "another node answers at this unit too: give one of them a unit of its own";
    case Doubt::swapped_words:
      return "a known serial with its words swapped: set `word_order` of the bus";
    case Doubt::no_room:
      return "too many nodes without a unit are known already: wait for them to leave";
  }
  return "";
}

std::size_t quarantine_max(const Roster& roster, const FeatureBook& features,
                           const AnchorBook& anchors, const Admission& admission) {
  return roster.records().size() + features.records().size() + anchors.records().size() +
         admission.doubts().size();
}

void list_quarantine(const Roster& roster, const FeatureBook& features, const AnchorBook& anchors,
                     const Admission& admission, std::vector<QuarantineEntry>& list) {
  list.clear();
  for (const NodeRecord& node : roster.records()) {
    if (!node.is_known() || !node.is_quarantined()) continue;
    list.push_back({.serial = node.serial,
                    .unit = node.unit,
                    .place = node.refused_at,
                    .refusal = node.refusal,
                    .since = node.refused_since});
  }
  std::uint32_t number = 0;
  for (const FeatureRecord& feature : features.records()) {
    ++number;
    if (feature.refusal == Status::ok) continue;
    list.push_back({.feature = number, .refusal = feature.refusal, .since = feature.refused_since});
  }
  for (const AnchorRecord& anchor : anchors.records()) {
    if (anchor.refusal.is_none()) continue;
    list.push_back({.place = anchor.settings.position,
                    .refusal = anchor.refusal,
                    .since = anchor.refused_since});
  }
  std::uint32_t unit = 0;
  for (const UnitDoubt& doubt : admission.doubts()) {
    if (doubt.is_alarm()) {
      list.push_back(
          {.serial = doubt.serial, .unit = unit, .doubt = doubt.doubt, .since = doubt.since});
    }
    ++unit;
  }
}

}  // namespace etcm::firmware

#include "firmware/alarms/refusal_text.h"

#include "firmware/alarms/alarm_subject.h"
#include "firmware/mesh/feature_reason.h"

namespace etcm::firmware {

Sentence parts_of(std::string_view sentence) {
  for (const std::string_view separator : {"; ", ": "}) {
    const std::size_t at = sentence.find(separator);
    if (at == std::string_view::npos) continue;
    return {sentence.substr(0, at), sentence.substr(at + separator.size())};
  }
  return {sentence, {}};
}

std::optional<RefusalText> refusal_text(const Gateway& gateway, const QuarantineEntry& entry) {
  Sentence why = parts_of(explain(entry));
  std::optional<FeatureReason> reason;
  TextLine text;
  AlarmKey key;
  if (entry.conflict != IdentityConflict::none) {
    const std::uint64_t unit = entry.unit_index.is_none() ? 0 : entry.unit_index.value + 1;
    key = {AlarmKind::identity_conflict, std::uint64_t{entry.serial.value} << 32 | unit};
    text << gateway.nodes().called(entry.serial);
  } else if (!entry.serial.is_none()) {
    key = {AlarmKind::refused_node, entry.serial.value};
    const NodeRecord* const node = gateway.nodes().find(entry.serial);
    if (node != nullptr) write_node(text, gateway, *node);
    text << " is not in the mesh where it is";
  } else if (entry.feature != 0) {
    if (entry.feature > gateway.features().size()) return std::nullopt;
    const FeatureSettings& feature = gateway.features()[entry.feature - 1].settings;
    key = {AlarmKind::refused_feature, subject_of(feature)};
    text << PlacedFeature{entry.feature, feature} << " is not in the mesh";
    reason = reason_of(feature, entry.rejection.mesh, entry.blocker, gateway.features(),
                       gateway.nodes(), gateway.settings().site.plane());
    if (reason) why = {.what = reason->what, .cure = reason->cure};
  } else {
    key = {AlarmKind::refused_anchor, subject_of(entry.position)};
    text << "the anchor at (" << entry.position.x << ", " << entry.position.y
         << ") is not in the mesh";
  }
  text << ": " << why.what;
  TextLine cure;
  cure << why.cure;
  return RefusalText{.key = key, .what = text, .cure = cure};
}

}  // namespace etcm::firmware

#include "firmware/status/features_document.h"

#include <array>

#include "firmware/alarms/alarm_subject.h"
#include "firmware/alarms/refusal_text.h"
#include "firmware/mesh/feature_reason.h"

namespace etcm::firmware {

namespace {

// Sections of the document.
enum : std::uint32_t { features_head, all_features };
// Pieces of one of them.
enum : std::uint32_t { feature_ends, feature_reason };

// The serial of a node, the place of an anchor.
void write_end(std::string_view name, const FeatureEnd& end, TextWriter& piece) {
  piece << ",\"" << name << "\":";
  if (end.is_anchor) {
    piece << "[" << end.position.x << "," << end.position.y << "]";
  } else {
    piece << end.serial.value;
  }
}

// An end that is not in the mesh keeps the feature out.
void explain_end(const Gateway& gateway, const FeatureSettings& feature, const FeatureEnd& end,
                 FeatureReason& reason) {
  if (end.is_anchor) return;
  const NodeRecord* const node = gateway.nodes().find(end.serial);
  if (node != nullptr && node->is_placed() && !node->leave_rejected) return;
  if (!reason.what.view().empty()) reason.what << ", and ";
  if (!reason.cure.view().empty()) reason.cure << "; ";
  reason.what << gateway.nodes().called(end.serial);
  if (node == nullptr) {
    const NodeEnd* const unheard = gateway.unheard_ends().find(end.serial);
    const NodeEnd who = unheard != nullptr ? *unheard : NodeEnd{.serial = end.serial};
    reason.what << (who.is_heard ? ", where it ends, has left or was dismissed"
                                 : ", where it ends, has not been heard since the start");
    TextLine where;
    where << "in " << feature.source;
    UnheardEnds::write_cure(who, gateway.nodes(), where, reason.cure);
  } else if (node->is_missing) {
    reason.what << ", where it ends, is missing";
    write_missing_cure(reason.cure, gateway, *node);
  } else if (node->is_quarantined()) {
    const Sentence why = parts_of(explain(node->rejection));
    reason.what << ", where it ends, is not in the mesh: " << why.what;
    reason.cure << why.cure;
  } else if (node->has_asked_to_leave()) {
    reason.what << ", where it ends, has said that it leaves";
    reason.cure << "let it join again, or take the feature out of " << feature.source;
  } else {
    const DevicePosition::State told = told_at(gateway.poller(), node->last_unit);
    const NoPosition why = explain(told);
    reason.what << ", where it ends, has told no position yet";
    if (told != DevicePosition::State::value) reason.what << ": it " << why.what;
    reason.cure << why.cure;
  }
}

FeatureReason reason_for(const Gateway& gateway, const FeatureRecord& feature,
                         std::uint32_t number) {
  if (feature.rejection != Status::ok) {
    const SitePlane plane = gateway.settings().site.plane();
    if (const auto reason = reason_of(number, gateway.features(), gateway.nodes(), plane))
      return *reason;
    FeatureReason reason;
    const Sentence why = parts_of(explain(Rejection(feature.rejection)));
    reason.what << why.what;
    reason.cure << why.cure;
    return reason;
  }
  FeatureReason reason;
  for (const FeatureEnd& end : {feature.settings.from, feature.settings.to}) {
    explain_end(gateway, feature.settings, end, reason);
  }
  if (reason.what.view().empty()) {
    reason.what << "an anchor where it ends is not in the mesh";
    reason.cure << "the log says why; correct the site file";
  }
  return reason;
}

}  // namespace

bool FeaturesDocument::write_next(Cursor& cursor, port::Instant, TextWriter& piece) const {
  const auto features = sources_.gateway.features();
  switch (cursor.section) {
    case features_head:
      piece << "{\"instance\":\"";
      piece.hex(instance_of(sources_)) << "\",\"features\":[";
      cursor.next_section();
      return true;
    case all_features:
      if (cursor.item >= features.size()) {
        // A reload may have taken out the one that has begun.
        if (cursor.part == feature_reason) {
          piece << R"(,"in_mesh":false,"refused":false,"why":"it was taken out","cure":""})";
        }
        piece << "]}\n";
        cursor.next_section();
      } else if (cursor.part == feature_ends) {
        piece << cursor.separator() << "\n";
        write_feature(cursor.item, piece);
        cursor.part = feature_reason;
      } else {
        write_reason(features[cursor.item], cursor.item, piece);
        piece << "}";
        cursor.part = feature_ends;
        ++cursor.item;
      }
      return true;
    default:
      return false;
  }
}

void FeaturesDocument::write_feature(std::uint32_t number, TextWriter& piece) const {
  constexpr std::size_t source_shown_max = 300;
  const FeatureSettings& feature = sources_.gateway.features()[number].settings;
  piece << "{\"feature\":" << number + 1;
  if (!feature.name.empty()) {
    piece << ",\"name\":";
    piece.json(feature.name);
  }
  piece << ",\"source\":";
  piece.json(port::cut_utf8(feature.source, source_shown_max));
  write_end("from", feature.from, piece);
  write_end("to", feature.to, piece);
}

void FeaturesDocument::write_reason(const FeatureRecord& feature, std::uint32_t number,
                                    TextWriter& piece) const {
  piece << ",\"in_mesh\":";
  piece.yes_or_no(feature.is_active());
  if (feature.is_active()) return;
  const FeatureReason reason = reason_for(sources_.gateway, feature, number);
  piece << ",\"refused\":";
  piece.yes_or_no(feature.rejection != Status::ok) << ",\"why\":";
  piece.json(reason.what) << ",\"cure\":";
  piece.json(reason.cure);
  if (feature.blocker) write_blocker(*feature.blocker, piece);
}

void FeaturesDocument::write_blocker(const Blocker& blocker, TextWriter& piece) const {
  piece << ",\"blocker\":" << blocker.number + 1;
  if (!blocker.near) return;
  piece << ",\"near\":[" << blocker.near->x << "," << blocker.near->y << "]";
  const auto degrees =
      earth_point(sources_.gateway.settings().site.plane(), to_point(*blocker.near));
  if (!degrees) return;
  piece << ",\"longitude\":";
  piece.nano(degrees->longitude) << ",\"latitude\":";
  piece.nano(degrees->latitude);
}

}  // namespace etcm::firmware

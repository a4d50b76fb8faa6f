#include "firmware/gateway/unheard_ends.h"

#include <algorithm>
#include <tuple>
#include <utility>

namespace etcm::firmware {

namespace {

bool has_asked_all(const Poller& poller) {
  for (UnitIndex unit{0}; unit.value < poller.unit_count(); ++unit.value) {
    if (poller.counters(unit).requests == 0) return false;
  }
  return true;
}

bool knows_others(const FleetReport* fleet) {
  if (fleet == nullptr) return true;
  return fleet->is_connected &&
         std::none_of(fleet->members.begin(), fleet->members.end(), [](const auto& member) {
           return member.state == MemberState::waiting || member.state == MemberState::unknown;
         });
}

}  // namespace

void UnheardEnds::take_site(port::Instant now) {
  const std::vector<NodeEnd> before = std::move(ends_);
  ends_.clear();
  const std::span<const FeatureRecord> features = features_.records();
  for (std::uint32_t number = 0; number < features.size(); ++number) {
    for (const FeatureEnd& end : {features[number].settings.from, features[number].settings.to}) {
      if (!end.is_anchor) ends_.push_back({.serial = end.serial, .feature = number});
    }
  }
  const auto by_serial = [](const NodeEnd& a, const NodeEnd& b) { return a.serial < b.serial; };
  std::sort(ends_.begin(), ends_.end(), [](const NodeEnd& a, const NodeEnd& b) {
    return std::tie(a.serial, a.feature) < std::tie(b.serial, b.feature);
  });
  const auto is_same = [](const NodeEnd& a, const NodeEnd& b) { return a.serial == b.serial; };
  ends_.erase(std::unique(ends_.begin(), ends_.end(), is_same), ends_.end());
  for (NodeEnd& end : ends_) {
    const auto known = std::lower_bound(before.begin(), before.end(), end, by_serial);
    if (known == before.end() || known->serial != end.serial) continue;
    end.is_heard = known->is_heard;
    end.last_unit = known->last_unit;
    end.is_told = known->is_told;
  }
  since_ = now;
  is_known_ = false;
}

void UnheardEnds::look(const NodeTable& nodes, const Poller& poller, const FleetReport* fleet,
                       port::Duration patience, port::Instant now) {
  is_known_ =
      is_known_ || (now - since_ >= patience && has_asked_all(poller) && knows_others(fleet));
  for (NodeEnd& end : ends_) {
    const NodeRecord* const node = nodes.find(end.serial);
    const bool is_here = node != nullptr;
    end.is_heard |= is_here;
    if (is_here) end.last_unit = node->last_unit;
    end.is_told = end.is_told && !is_here;
    const bool is_to_be_told = !is_here && (end.is_heard || is_known_);
    if (!is_to_be_told || std::exchange(end.is_told, true)) continue;
    TextLine line;
    explain(end, nodes, line);
    line << "; ";
    write_cure(end, nodes, "there", line);
    log_.write(port::Level::warning, line);
  }
}

const NodeEnd* UnheardEnds::find(Serial serial) const {
  const auto found =
      std::lower_bound(ends_.begin(), ends_.end(), serial,
                       [](const NodeEnd& end, Serial wanted) { return end.serial < wanted; });
  return found == ends_.end() || found->serial != serial ? nullptr : &*found;
}

void UnheardEnds::explain(const NodeEnd& end, const NodeTable& nodes, TextLine& text) const {
  const FeatureSettings& feature = features_.records()[end.feature].settings;
  text << nodes.called(end.serial)
       << (end.is_heard ? " has left or was dismissed, and "
                        : " has not been heard since the start, and ")
       << PlacedFeature{end.feature + 1, feature} << " waits for it";
}

void UnheardEnds::write_cure(const NodeEnd& end, const NodeTable& nodes, std::string_view where,
                             TextLine& cure) {
  const NodeRecord* const other = end.last_unit.is_none() ? nullptr : nodes.at(end.last_unit);
  if (other == nullptr) {
    cure << "correct the serial " << where << ", or look for the node";
  } else {
    cure << nodes.called(*other) << " answers now where it was; if that is in its place: write "
         << other->serial.value << " " << where << ", and reload";
  }
}

}  // namespace etcm::firmware

#include "firmware/records/anchor_table.h"

#include <algorithm>
#include <utility>

namespace etcm::firmware {

namespace {

std::uint64_t key_of(Position position) { return FeatureEnd::anchor(position).key(); }

bool is_before(const AnchorRecord& record, std::uint64_t key) {
  return key_of(record.settings.position) < key;
}

}  // namespace

AnchorTable::AnchorTable(std::span<const AnchorSettings> anchors) { replace(anchors); }

void AnchorTable::replace(std::span<const AnchorSettings> anchors) {
  std::vector<AnchorRecord> old = std::exchange(records_, {});
  records_.reserve(anchors.size() + old.size());
  for (const AnchorSettings& anchor : anchors) records_.emplace_back().settings = anchor;
  const auto sort = [&] {
    std::sort(records_.begin(), records_.end(), [](const AnchorRecord& a, const AnchorRecord& b) {
      return is_before(a, key_of(b.settings.position));
    });
  };
  sort();
  const std::size_t wanted = records_.size();
  for (AnchorRecord& record : old) {
    const auto end = records_.begin() + static_cast<std::ptrdiff_t>(wanted);
    const std::uint64_t key = key_of(record.settings.position);
    const auto same = std::lower_bound(records_.begin(), end, key, is_before);
    if (same != end && key_of(same->settings.position) == key) {
      same->vertex = record.vertex;
      same->is_taken = record.is_taken;
      same->rejection = record.rejection;
      same->rejected_epoch = record.rejected_epoch;
      same->rejected_since = record.rejected_since;
    } else if (record.is_vacant()) {
      record.is_obsolete = true;
      record.rejection = {};
      records_.push_back(std::move(record));
    }
  }
  sort();
}

void AnchorTable::tidy() {
  std::erase_if(records_, [](const AnchorRecord& record) {
    return record.is_obsolete && !record.is_placed();
  });
}

const AnchorRecord* AnchorTable::find(Position position) const {
  const std::uint64_t key = key_of(position);
  const auto found = std::lower_bound(records_.begin(), records_.end(), key, is_before);
  if (found == records_.end() || key_of(found->settings.position) != key) return nullptr;
  return &*found;
}

AnchorRecord* AnchorTable::find(Position position) {
  return const_cast<AnchorRecord*>(std::as_const(*this).find(position));
}

std::uint32_t AnchorTable::vacant_count() const {
  return static_cast<std::uint32_t>(
      std::count_if(records_.begin(), records_.end(),
                    [](const AnchorRecord& record) { return record.is_vacant(); }));
}

std::string name_of(const AnchorRecord& anchor) {
  return "the anchor at " + to_string(FeatureEnd::anchor(anchor.settings.position)) + " (" +
         anchor.settings.source + ")";
}

}  // namespace etcm::firmware

#include "firmware/records/feature_table.h"

#include <algorithm>
#include <utility>

#include "firmware/logging/text_line.h"

namespace etcm::firmware {

FeatureTable::FeatureTable(std::span<const FeatureSettings> features, std::uint32_t feature_ids_max)
    : number_by_id_(feature_ids_max) {
  std::vector<std::pair<std::uint64_t, std::uint32_t>> pairs;  // end, number
  for (std::uint32_t number = 0; number < features.size(); ++number) {
    records_.push_back({.settings = features[number], .id = {}});
    pairs.emplace_back(features[number].from.key(), number);
    pairs.emplace_back(features[number].to.key(), number);
  }
  std::sort(pairs.begin(), pairs.end());
  for (const auto& [key, number] : pairs) {
    if (ends_.empty() || ends_.back().key != key) {
      ends_.push_back(
          {.key = key, .first = static_cast<std::uint32_t>(numbers_.size()), .count = 0});
    }
    numbers_.push_back(number);
    ++ends_.back().count;
  }
}

std::span<const std::uint32_t> FeatureTable::ending_at(const FeatureEnd& end) const {
  const std::uint64_t key = end.key();
  const auto found =
      std::lower_bound(ends_.begin(), ends_.end(), key,
                       [](const End& entry, std::uint64_t wanted) { return entry.key < wanted; });
  if (found == ends_.end() || found->key != key) return {};
  return std::span(numbers_).subspan(found->first, found->count);
}

void FeatureTable::activate(std::uint32_t number, FeatureId id) {
  clear_rejection(records_[number]);
  records_[number].id = id;
  number_by_id_[id.value] = number;
  ++active_count_;
}

void FeatureTable::deactivate(std::uint32_t number) {
  FeatureRecord& record = records_[number];
  clear_rejection(record);
  if (record.is_active()) --active_count_;
  record.id = FeatureId::none();
}

void FeatureTable::reject(std::uint32_t number, Status why, const std::optional<Blocker>& blocker,
                          std::uint32_t epoch, port::Instant now) {
  FeatureRecord& record = records_[number];
  if (record.rejection == Status::ok) ++rejected_count_;
  if (record.rejection != why) record.rejected_since = now;
  record.rejection = why;
  record.blocker = blocker;
  record.rejected_epoch = epoch;
}

void FeatureTable::clear_rejection(FeatureRecord& record) {
  if (record.rejection != Status::ok) --rejected_count_;
  record.rejection = Status::ok;
  record.blocker.reset();
}

std::string FeatureTable::name(std::uint32_t number) const {
  TextLine line;
  line << PlacedFeature{number + 1, records_[number].settings};
  return std::string(line.view());
}

}  // namespace etcm::firmware

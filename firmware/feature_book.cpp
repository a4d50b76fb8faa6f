#include "feature_book.h"

#include <algorithm>
#include <utility>

namespace etcm::firmware {

FeatureBook::FeatureBook(std::span<const FeatureSettings> features, std::uint32_t feature_ids_max)
    : number_by_id_(feature_ids_max) {
  std::vector<std::pair<std::uint32_t, std::uint32_t>> pairs;  // serial, number
  for (std::uint32_t number = 0; number < features.size(); ++number) {
    records_.push_back({.settings = features[number], .id = {}});
    pairs.emplace_back(features[number].from, number);
    pairs.emplace_back(features[number].to, number);
  }
  std::sort(pairs.begin(), pairs.end());
  for (const auto& [serial, number] : pairs) {
    if (ends_.empty() || ends_.back().serial != serial) {
      ends_.push_back(
          {.serial = serial, .first = static_cast<std::uint32_t>(numbers_.size()), .count = 0});
    }
    numbers_.push_back(number);
    ++ends_.back().count;
  }
}

std::span<const std::uint32_t> FeatureBook::ending_at(std::uint32_t serial) const {
  const auto found =
      std::lower_bound(ends_.begin(), ends_.end(), serial,
                       [](const End& end, std::uint32_t wanted) { return end.serial < wanted; });
  if (found == ends_.end() || found->serial != serial) return {};
  return std::span(numbers_).subspan(found->first, found->count);
}

void FeatureBook::activate(std::uint32_t number, FeatureId id) {
  clear_refusal(records_[number]);
  records_[number].id = id;
  number_by_id_[id.value] = number;
  ++active_count_;
}

void FeatureBook::deactivate(std::uint32_t number) {
  FeatureRecord& record = records_[number];
  clear_refusal(record);
  if (record.is_active()) --active_count_;
  record.id = FeatureId::none();
}

void FeatureBook::refuse(std::uint32_t number, Status why, std::uint32_t epoch) {
  FeatureRecord& record = records_[number];
  if (record.refusal == Status::ok) ++refused_count_;
  record.refusal = why;
  record.refused_epoch = epoch;
}

void FeatureBook::clear_refusal(FeatureRecord& record) {
  if (record.refusal != Status::ok) --refused_count_;
  record.refusal = Status::ok;
}

std::string FeatureBook::name(std::uint32_t number) const {
  const FeatureSettings& feature = records_[number].settings;
  return "feature " + std::to_string(number + 1) + " (" + std::to_string(feature.from) + "-" +
         std::to_string(feature.to) + ", " + feature.place + ")";
}

}  // namespace etcm::firmware

#include "roster.h"

#include <algorithm>
#include <utility>

namespace etcm::firmware {

Roster::Roster(std::uint32_t unit_count) : records_(unit_count) { by_serial_.reserve(unit_count); }

std::vector<Roster::Entry>::iterator Roster::lower_bound(std::uint32_t serial) {
  return std::lower_bound(
      by_serial_.begin(), by_serial_.end(), serial,
      [](const Entry& entry, std::uint32_t wanted) { return entry.serial < wanted; });
}

NodeRecord* Roster::find(std::uint32_t serial) {
  const auto found = lower_bound(serial);
  if (found == by_serial_.end() || found->serial != serial) return nullptr;
  return &records_[found->unit];
}

std::uint32_t Roster::unit_of(const NodeRecord& record) const {
  return static_cast<std::uint32_t>(&record - records_.data());
}

void Roster::bind(std::uint32_t unit, std::uint32_t serial) {
  by_serial_.insert(lower_bound(serial), {.serial = serial, .unit = unit});
  records_[unit] = {};
  records_[unit].serial = serial;
}

void Roster::move(NodeRecord& record, std::uint32_t unit) {
  lower_bound(record.serial)->unit = unit;
  records_[unit] = std::exchange(record, {});
}

void Roster::release(NodeRecord& record) {
  by_serial_.erase(lower_bound(record.serial));
  record = {};
}

}  // namespace etcm::firmware

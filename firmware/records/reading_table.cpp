#include "firmware/records/reading_table.h"

namespace etcm::firmware {

void ReadingTable::add_units(const Poller& poller) {
  first_of_.reserve(poller.unit_count());
  const auto known = static_cast<std::uint32_t>(first_of_.size());
  for (UnitIndex unit{known}; unit.value < poller.unit_count(); ++unit.value) {
    first_of_.push_back(static_cast<std::uint32_t>(records_.size()));
    for (std::size_t i = 0; i < poller.quantities(unit).size(); ++i) {
      ReadingRecord record;
      record.unit_index = unit;
      record.quantity = poller.quantities(unit)[i];
      record.definition = poller.definitions(unit)[i];
      records_.push_back(record);
    }
  }
}

void ReadingTable::take(UnitIndex unit, Serial serial, std::span<const Measurement> measured,
                        port::Instant now) {
  std::size_t at = first_of_[unit.value];
  for (const Measurement& measurement : measured) {
    ReadingRecord& record = records_[at++];
    has_other_values_ = has_other_values_ || record.serial != serial ||
                        record.nano != measurement.nano || record.is_stale;
    has_news_ = true;
    record.serial = serial;
    record.nano = measurement.nano;
    record.taken_at = now;
    record.is_stale = false;
  }
}

void ReadingTable::set_stale(ReadingRecord& record) {
  has_news_ = has_other_values_ = true;
  record.is_stale = true;
}

}  // namespace etcm::firmware

// What one other member has on the broker about nodes, as it came in this connection.
#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <optional>

#include "firmware/fleet/fleet_record.h"
#include "firmware/fleet/header_codec.h"

namespace etcm::firmware {

class RemoteSet {
 public:
  using Record = std::shared_ptr<const FleetRecord>;

  void clear();
  void put(Record record);
  void erase(Serial serial);
  void set_summary(std::optional<FleetSetSummary> summary) { summary_ = summary; }

  // All that its summary counts is here, and nothing else.
  bool is_complete() const {
    return summary_ && summary_->count == entries_.size() && summary_->hash == hash_;
  }
  // Null: there is none.
  Record find(Serial serial) const;
  std::size_t size() const { return entries_.size(); }

  // By serial: visit(record).
  template <class Visit>
  void for_each(Visit visit) const {
    for (const auto& [serial, entry] : entries_) visit(entry.record);
  }

 private:
  struct Entry {
    Record record;
    std::uint64_t hash;
  };
  std::map<Serial, Entry> entries_;
  std::uint64_t hash_ = 0;
  std::optional<FleetSetSummary> summary_;
};

}  // namespace etcm::firmware

#include "firmware/fleet/remote_set.h"

#include <utility>

#include "firmware/fleet/fleet_hash.h"

namespace etcm::firmware {

void RemoteSet::clear() { *this = {}; }

void RemoteSet::put(Record record) {
  const Serial serial = record->node.serial;
  const std::uint64_t hash = record_hash(*record);
  erase(serial);
  entries_.emplace(serial, Entry{std::move(record), hash});
  hash_ += hash;
}

void RemoteSet::erase(Serial serial) {
  const auto at = entries_.find(serial);
  if (at == entries_.end()) return;
  hash_ -= at->second.hash;
  entries_.erase(at);
}

RemoteSet::Record RemoteSet::find(Serial serial) const {
  const auto at = entries_.find(serial);
  return at == entries_.end() ? nullptr : at->second.record;
}

}  // namespace etcm::firmware

// All that is known of the nodes of a site: of each the greatest record that was ever offered.
// So it does not matter in which order they come, how often, or from whom.
#pragma once

#include <cstdint>
#include <map>
#include <memory>

#include "etcm/port/clock.h"
#include "firmware/fleet/fleet_record.h"

namespace etcm::firmware {

struct MergedNode {
  std::shared_ptr<const FleetRecord> record;
  std::uint64_t record_hash = 0;
  port::Instant received_at{};
  // What the gateway was told last.
  enum class Told : std::uint8_t { nothing, own, foreign } told = Told::nothing;
  bool told_stale = false;
  std::shared_ptr<const FleetRecord> told_record{};
  // Since when no set on the broker has it, or nobody needs the tombstone; never: that is not so.
  port::Instant uncovered_since = port::never;
  port::Instant needless_since = port::never;
};

class MergedSet {
 public:
  using Nodes = std::map<Serial, MergedNode>;
  enum class Offered : std::uint8_t { older, same, newer, no_room };

  // Of nodes that are there; of others that have left as many again.
  explicit MergedSet(std::uint32_t nodes_max) : nodes_max_(nodes_max) {}

  // `same`: it says the same of what decides, and is taken for the rest. O(log n), as the rest.
  Offered offer(std::shared_ptr<const FleetRecord> record, port::Instant now);
  // Takes it though it is of the version that is here: for what nobody else has seen yet.
  void amend(std::shared_ptr<const FleetRecord> record, port::Instant now);
  Nodes::iterator forget(Nodes::iterator at);

  MergedNode* find(Serial serial);
  const MergedNode* find(Serial serial) const;
  Nodes& nodes() { return nodes_; }
  const Nodes& nodes() const { return nodes_; }

  // Of those that are there; the hash is that of all that have a place.
  std::uint32_t count() const { return count_; }
  std::uint64_t hash() const { return hash_; }
  // Of all that counts of them (record_hash): versions and owners too.
  std::uint64_t record_hash() const { return record_hash_; }

 private:
  void set(MergedNode& node, std::shared_ptr<const FleetRecord> record, port::Instant now);
  void add(const MergedNode& node);
  void subtract(const MergedNode& node);

  std::uint32_t nodes_max_;
  Nodes nodes_;
  std::uint32_t count_ = 0;
  std::uint64_t hash_ = 0;
  std::uint64_t record_hash_ = 0;
};

}  // namespace etcm::firmware

// Announces the nodes of this gateway to Home Assistant, and takes back those that are known no
// more.
//
// It sends through the broker of the fleet, whose listener that is: what it sends is kept by the
// broker, and sent again in each session and each hour, so that nobody has to hear whether it has
// arrived. The fleet's own messages go before, for a broker may hang up on who says what it does
// not let it say; after such a one it is tried again with the repetition.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "etcm/port/clock.h"
#include "etcm/port/message_broker.h"
#include "firmware/config/settings.h"
#include "firmware/home_assistant/discovery.h"
#include "firmware/publish/reading_snapshot.h"
#include "firmware/records/node_table.h"

namespace etcm::firmware {

// What the member of the fleet whose broker it is says of that.
struct FleetStanding {
  bool has_told_all = false;              // in this session
  std::uint64_t other_refused_count = 0;  // messages that were not the member's, ever
};

class Announcer {
 public:
  // All but the settings must outlive it. REQUIRES: settings.mqtt with a prefix for it.
  Announcer(const Settings& settings, std::string_view version, const NodeTable& nodes,
            const ReadingSnapshot& readings, port::MessageBroker& broker);

  // There may be more devices than before, and another site; and what was refused is tried again.
  void update_settings(const Settings& settings);

  // Sends what is due, a part of it at a time.
  void step(port::Instant now, const FleetStanding& fleet);
  port::Instant next_deadline() const;

 private:
  // What a record of the node table was announced as.
  struct Announced {
    Serial serial;            // none: nothing is announced
    std::uint64_t shape = 0;  // of its entities
  };
  enum class Outcome : std::uint8_t { nothing, sent, no_room };

  void begin_round(port::Instant now);
  Outcome look_at(std::size_t slot);
  Outcome take_back(Announced& announced);
  Outcome announce(const NodeRecord& node, Announced& announced);
  void collect_readings(Serial serial);
  std::uint64_t shape(std::string_view name) const;
  bool send(Serial serial, const std::string& payload);

  const std::string version_;
  const NodeTable& nodes_;
  const ReadingSnapshot& snapshot_;
  port::MessageBroker& broker_;
  std::string prefix_;
  std::string site_;
  std::string gateway_;
  bool has_degrees_ = false;
  std::vector<Announced> announced_;  // by record of the node table
  std::vector<AnnouncedReading> readings_;
  std::uint64_t session_ = 0;        // of the broker, in which all was announced
  std::uint64_t refused_count_ = 0;  // that is known of
  bool is_under_way_ = false;
  std::size_t next_slot_ = 0;
  port::Instant due_{};
  port::Instant repeat_due_{};
};

}  // namespace etcm::firmware

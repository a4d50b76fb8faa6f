// What a member has to say: of each topic only the last state waits, however often it has changed.
#pragma once

#include <compare>
#include <cstdint>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <utility>

#include "etcm/port/clock.h"
#include "etcm/port/message_broker.h"
#include "firmware/fleet/fleet_topics.h"

namespace etcm::firmware {

struct OutKey {
  TopicKind kind = TopicKind::header;
  Serial serial{};
  friend auto operator<=>(const OutKey&, const OutKey&) = default;
};

struct OutMessage {
  std::string payload;            // empty: to empty the topic
  std::uint64_t record_hash = 0;  // of a node (fleet_hash.h); 0: there is none
};

class Outgoing {
 public:
  struct Slot {
    port::Instant due = port::never;
    port::Instant sent_at{};
    std::uint64_t hash = 0;  // of what was sent last; 0: the topic was emptied, or never written
    std::uint64_t record_hash = 0;  // of a node; 0 as above
    std::uint32_t in_flight = 0;    // token of what was sent last; 0: it was delivered
    bool was_sent = false;
    bool is_refused = false;  // what was sent last, in this connection
  };

  // The topic is to be sent, at `due` at the latest.
  void mark(OutKey key, port::Instant due);
  // It need not be sent.
  void unmark(OutKey key);
  // Null: nothing was ever sent on it, nor is to be.
  const Slot* find(OutKey key) const;
  const std::map<OutKey, Slot>& slots() const { return slots_; }

  // Sends what is due, for as long as the broker takes it: encode(key) gives the message,
  // topic_of(key) its topic. Returns whether the broker took all of it.
  template <class Encode, class TopicOf>
  bool pump(port::Instant now, port::MessageBroker& broker, Encode encode, TopicOf topic_of);
  struct Delivered {
    OutKey key;
    std::uint64_t hash = 0;
  };
  // What this token was; none for a message that another one has followed on its topic.
  std::optional<Delivered> take_delivered(std::uint32_t token);
  // What was refused is not on the broker. As take_delivered().
  std::optional<OutKey> take_refused(std::uint32_t token, port::Instant now);
  void on_disconnected();
  // Another program says from now on what there is of nodes.
  void forget_nodes(port::Instant now);

  port::Instant next_due() const { return due_.empty() ? port::never : due_.begin()->first; }
  // Due by now or not delivered.
  std::uint32_t waiting_count(port::Instant now) const;
  std::uint64_t sent_count() const { return sent_count_; }

  // Of the messages about nodes that have been sent and not taken back.
  std::uint32_t node_count() const { return node_count_; }
  std::uint64_t node_hash() const { return node_hash_; }

 private:
  void note_sent(OutKey key, Slot& slot, const OutMessage& message, port::Instant now);
  void set_record(OutKey key, Slot& slot, std::uint64_t record_hash, port::Instant now);

  std::map<OutKey, Slot> slots_;
  std::set<std::pair<port::Instant, OutKey>> due_;
  std::map<std::uint32_t, OutKey> in_flight_;
  std::uint32_t token_ = 0;
  std::uint64_t sent_count_ = 0;
  std::uint32_t node_count_ = 0;
  std::uint64_t node_hash_ = 0;
};

// 0 for an empty one alone.
std::uint64_t payload_hash(std::string_view payload);

template <class Encode, class TopicOf>
bool Outgoing::pump(port::Instant now, port::MessageBroker& broker, Encode encode,
                    TopicOf topic_of) {
  while (next_due() <= now) {
    const OutKey key = due_.begin()->second;
    const std::string topic = topic_of(key);
    const OutMessage message = encode(key);
    if (!broker.publish({.topic = topic, .payload = message.payload, .retained = true},
                        token_ + 1)) {
      return false;
    }
    note_sent(key, slots_[key], message, now);
  }
  return true;
}

}  // namespace etcm::firmware

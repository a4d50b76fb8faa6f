// A broker of messages: a program between the gateways of a fleet that hands each message on to all
// who want it, and keeps the last one of a topic for those who come later (MQTT 5).
//
// Nothing here waits. What comes in is told to the listener from within step() alone; between two
// steps bytes arrive (the adapter waits for them with its own event loop). A lost connection is
// brought back by step(), for ever, with pauses between the attempts.
#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>

#include "etcm/port/clock.h"

namespace etcm::port {

// The most bytes that topic and payload of one message may have together. One that comes with more
// ends the connection.
inline constexpr std::size_t broker_message_bytes_max = std::size_t{256} * 1024;
// The most bytes, of topics and payloads, that may be sent and not yet delivered.
inline constexpr std::size_t broker_held_bytes_max = 2 * broker_message_bytes_max;

// Who has no connection tries again after no more than this: so long after a broker has come back
// all are there again whose programs run.
inline constexpr Duration broker_pause_max = std::chrono::seconds(90);

struct BrokerMessage {
  std::string_view topic;
  std::string_view payload;  // any bytes; empty: the topic has no message any more
  // Of one that came: the broker had kept it, it is not news. Of one that is sent: the broker is to
  // keep it.
  bool retained = false;
  // Of one that is sent: for those who listen now, and lost where the connection ends (QoS 0).
  bool at_most_once = false;
};

class BrokerListener {
 public:
  // A new session: what was subscribed to is asked for again, and so comes again; what had been
  // sent and was not delivered is forgotten.
  virtual void on_connected(Instant now) = 0;
  // Once for each on_connected(). The reason is a line for a person, and valid during the call.
  // No token that was given before comes back after this.
  virtual void on_disconnected(std::string_view reason, Instant now) = 0;

  // A topic's messages come in the order in which the broker has them; the same one may come twice.
  // Valid during the call.
  virtual void on_message(const BrokerMessage& message, Instant now) = 0;

  // The broker has it; one that is sent at most once has left. Tokens come back in any order.
  virtual void on_delivered(std::uint32_t token, Instant now) = 0;
  // The broker does not want it, and would not if it were sent again. The reason is as above; the
  // adapter has written it to the log.
  virtual void on_refused(std::uint32_t token, std::string_view reason, Instant now) = 0;

 protected:
  ~BrokerListener() = default;
};

// These only ever grow.
struct BrokerCounters {
  std::uint64_t connections = 0;  // that the broker took
  std::uint64_t failures = 0;     // attempts in vain, and connections that were lost
  std::uint64_t received = 0;     // messages
  std::uint64_t delivered = 0;
  std::uint64_t refused = 0;
  std::uint64_t held_bytes_most = 0;  // that were sent and not yet delivered at a time
};

class MessageBroker {
 public:
  virtual bool is_connected() const = 0;
  // Why not: where, what, and the cure. Empty while it is connected, and before it is known. Valid
  // until the next step().
  virtual std::string_view why_down() const = 0;
  virtual const BrokerCounters& counters() const = 0;

  // Who hears of it all; it must outlive the broker or be replaced. May call everything here but
  // step(). Null: nobody.
  virtual void set_listener(BrokerListener* listener) = 0;

  // What the broker tells others in our name when the connection has ended, however it ended: lost,
  // or because the gateway stopped. Kept, for each connection that begins from now on. REQUIRES: no
  // more than broker_message_bytes_max and 65535 bytes of payload.
  virtual void set_last_will(const BrokerMessage& message) = 0;

  // Asks for messages whose topic matches one of the filters ('+' for one level, '#' for all that
  // follow) beside those asked for before. Kept, and asked for again in each session. What the
  // broker has kept comes first, some or all of it before news of the same topics.
  virtual void subscribe(std::span<const std::string> filters) = 0;

  // Sends a message that is to be delivered at least once (QoS 1), unless it says at most once; it
  // is copied. `token` comes back with on_delivered() or on_refused(), in a later step, or never
  // where the connection ends.
  // False: nothing is sent, because there is no connection or too much is under way already; a
  // later step makes room. REQUIRES: topic and payload within broker_message_bytes_max, a topic
  // without '+', '#' and zero bytes.
  virtual bool publish(const BrokerMessage& message, std::uint32_t token) = 0;

  // Takes in what has come, sends what is due, connects where there is no connection.
  virtual void step(Instant now) = 0;
  // When step() has something to do at the latest; `never` when only bytes can change anything.
  virtual Instant next_deadline() const = 0;

 protected:
  ~MessageBroker() = default;
};

}  // namespace etcm::port

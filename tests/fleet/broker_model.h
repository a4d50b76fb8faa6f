// A broker of messages in simulated time, made from the rules of MQTT and not from what the fleet
// expects of one:
// - A connection takes messages in the order in which they were sent; where it ends, the last of
//   them are lost, or were taken and nobody was told (QoS 1: at least once).
// - A subscriber has the messages of one topic in the order in which the broker took them; those of
//   different topics in any order. What was not acknowledged may come again, in the same order,
//   after what has come since.
// - A subscription brings what is retained, in any order; an empty payload takes it away.
// - A connection that ends without a farewell has its will published: at once, or when the broker
//   has noticed, or when one of the same name connects. A session ends with its connection.
// - What a connection with a name sends at most once (QoS 0) comes in the order in which it was
//   sent, and never again: brokers do so, and Sparkplug counts on it.
// - A broker that starts again has no connections and no wills, and of what was retained what it
//   had written to its disk: all, some, none, or an older state.
// Two brokers may be joined by a bridge, which hands on what each takes; when it comes back, each
// side gives the other what it has retained.
#pragma once

#include <array>
#include <cstdint>
#include <deque>
#include <functional>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "etcm/port/message_broker.h"
#include "inputs/random.h"
#include "member_clock.h"

namespace etcm::test {

using inputs::Random;
using port::Instant;

struct ModelMessage {
  std::string topic;
  std::string payload;
  bool is_retained = false;
  bool is_in_order = false;
};

enum class Memory : std::uint8_t { all, some, none, older };

class BrokerModel {
 public:
  struct Habits {
    port::Duration delay_max = std::chrono::milliseconds(600);
    port::Duration notice_max = std::chrono::seconds(12);  // until a dead connection is noticed
    bool reorders = true;
  };
  static constexpr std::size_t sides = 2;

  BrokerModel(Random& random, const Habits& habits) : random_(random), habits_(habits) {}

  void step(Instant now);
  // When there is something to do.
  Instant next() const;

  // --- faults
  void restart(std::size_t side, Memory memory, Instant now);
  void set_bridge(bool is_up, Instant now);
  bool is_bridged() const { return is_bridged_; }
  // Some connection has ended, and nobody knows.
  bool has_will() const { return !wills_.empty(); }
  // Sends again what some session has had, in the same order by topic.
  void redeliver(Instant now);
  void remember();  // the older state
  // From who is no member.
  void inject(std::size_t side, ModelMessage message, Instant now);

  const std::map<std::string, std::string>& retained(std::size_t side) const {
    return retained_[side];
  }

  // --- for ModelClient
  struct Session;
  std::shared_ptr<Session> connect(std::size_t side, const std::string& name,
                                   const std::vector<std::string>& filters,
                                   const ModelMessage& will, Instant now);
  void send(Session& session, ModelMessage message, std::uint32_t token, Instant now);
  void end(Session& session, bool is_noticed_at_once, Instant now);

 private:
  struct Due {
    Instant at;
    std::size_t side;
    ModelMessage message;
    std::string name{};  // of the connection whose will it is
  };
  Instant later(Instant now) {
    const auto most = static_cast<std::uint64_t>(habits_.delay_max.count());
    return now + port::Duration(static_cast<std::int64_t>(random_.below(most + 1)));
  }
  void take_over(const std::string& name, Instant now);
  void take(std::size_t side, const ModelMessage& message, bool is_from_bridge, Instant now);
  void deliver(Session& session, const ModelMessage& message, bool is_retained, Instant now);

  Random& random_;
  Habits habits_;
  bool is_bridged_ = true;
  std::array<std::map<std::string, std::string>, sides> retained_;
  std::array<std::map<std::string, std::string>, sides> older_;
  std::vector<std::shared_ptr<Session>> sessions_;
  std::vector<Due> wills_;
  std::array<std::deque<Due>, sides> bridge_;  // towards that side
};

struct BrokerModel::Session {
  struct Sent {
    ModelMessage message;
    std::uint32_t token;
    Instant at;  // when the broker takes it
  };
  struct Incoming {
    ModelMessage message;
    bool was_retained;
    Instant at;
    std::uint64_t number;  // of those that come in order, from 1; 0: it is none
  };
  std::size_t side = 0;
  std::string name;
  std::vector<std::string> filters;
  ModelMessage will;
  bool is_open = true;
  std::deque<Sent> sent;
  std::multimap<Instant, std::uint32_t> acknowledged;
  std::map<std::string, std::deque<Incoming>> incoming;  // by topic
  std::map<std::string, std::deque<ModelMessage>> history;
  Instant last_sent{};
  Instant last_incoming{};
  std::uint64_t last_number = 0;   // of those that come in order
  std::uint64_t heard_number = 0;  // of the last that was heard
};

// One connection that is brought back for ever. Its time is that of the broker; its listener hears
// the times of the clock. Without a name it has another one each time.
class ModelClient final : public port::MessageBroker {
 public:
  ModelClient(BrokerModel& broker, Random& random, std::size_t side, const MemberClock& clock,
              std::string name = {})
      : broker_(broker), random_(random), side_(side), clock_(clock), name_(std::move(name)) {}
  ~ModelClient() { close(false, Instant{}); }
  ModelClient(const ModelClient&) = delete;
  ModelClient& operator=(const ModelClient&) = delete;

  void set_network(bool is_up) { has_network_ = is_up; }
  // The program dies when it has sent so many more messages: what it sends then is lost.
  void die_after(std::uint32_t messages) { life_ = messages; }
  bool is_dead() const { return life_ == 0; }
  void close(bool is_noticed_at_once, Instant now);

  bool is_connected() const override { return session_ != nullptr && session_->is_open; }
  std::string_view why_down() const override { return ""; }
  const port::BrokerCounters& counters() const override { return counters_; }
  void set_listener(port::BrokerListener* listener) override { listener_ = listener; }
  void set_last_will(const port::BrokerMessage& message) override;
  void subscribe(std::span<const std::string> filters) override;
  bool publish(const port::BrokerMessage& message, std::uint32_t token) override;
  void step(Instant now) override;
  // But for what the broker does.
  Instant next_deadline() const override {
    return is_connected() || !has_network_ ? port::never : retry_at_;
  }

 private:
  void connect_if_due(Instant now);
  void take_incoming(Instant now);

  BrokerModel& broker_;
  Random& random_;
  std::size_t side_;
  const MemberClock& clock_;
  const std::string name_;
  port::BrokerListener* listener_ = nullptr;
  port::BrokerCounters counters_;
  ModelMessage will_;
  std::vector<std::string> filters_;
  std::shared_ptr<BrokerModel::Session> session_;
  bool is_told_ = false;  // the listener knows of the connection
  bool has_network_ = true;
  Instant retry_at_{};
  Instant now_{};
  std::uint32_t life_ = 0xffffffff;
};

// "etcm/+/x", "etcm/#".
bool matches(std::string_view filter, std::string_view topic);

}  // namespace etcm::test

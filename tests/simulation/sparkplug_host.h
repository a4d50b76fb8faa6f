// A host of Sparkplug 3.0, made from its specification: it believes births, counts what comes,
// follows aliases, and asks for all anew when it does not know.
#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <string_view>

#include "firmware/protobuf_reader.h"
#include "fleet/broker_model.h"
#include "gateway_run.h"
#include "site_world.h"

namespace etcm::simulation {

class SparkplugHost final : public port::BrokerListener {
 public:
  SparkplugHost(test::BrokerModel& broker, inputs::Random& random, const test::MemberClock& clock);

  void step(Instant now) { client_.step(now); }
  Instant next() const { return client_.next_deadline(); }
  void set_network(bool is_up) { client_.set_network(is_up); }
  // Asks for all births, or for nothing that anybody understands.
  void ask_for_births();
  void talk_rubbish(inputs::Random& random);

  // The gateway begins, or stood still until now.
  void look_anew() { differs_since_.clear(); }
  // What is wrong with what it was sent, or with what it believes while both are connected; empty:
  // nothing.
  std::string look(GatewayRun& run, bool is_gateway_connected, Instant now);
  std::string look_at_rest(const SiteWorld& site, GatewayRun& run) const;
  std::uint64_t births() const { return births_; }

  void on_connected(Instant now) override;
  void on_disconnected(std::string_view reason, Instant now) override;
  void on_message(const port::BrokerMessage& message, Instant now) override;
  void on_delivered(std::uint32_t, Instant) override {}
  void on_refused(std::uint32_t, std::string_view, Instant) override {}

 private:
  struct Told {
    std::map<std::uint64_t, std::string> names;    // by alias
    std::map<std::string, std::string> values;     // by name
    std::map<std::string, std::string> qualities;  // of those that are not good
  };
  void send(std::string_view payload);
  void take(std::string_view type, const std::string& device, const test::SparkplugPayload& told);
  static void note(Told& of, const std::string& name, const test::SparkplugMetric& metric);
  std::string born(Told& of, const test::SparkplugPayload& told);
  static std::string changed(Told& of, const test::SparkplugPayload& told);
  void forget();

  test::ModelClient client_;
  bool is_born_ = false;  // the edge node; else nothing of it is believed
  std::string birth_sequence_;
  std::uint8_t sequence_ = 0;  // of the next message
  Told edge_node_;
  std::map<std::string, Told> devices_;  // those that live
  std::map<std::string, Instant> differs_since_;
  Instant looked_at_{};
  std::string wrong_;
  std::uint64_t births_ = 0;
};

}  // namespace etcm::simulation

#include "bench/fleet/crowd.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>

namespace etcm::bench {

namespace {

using namespace std::chrono_literals;
using firmware::Serial;

constexpr int lines_told = 20;
constexpr std::uint32_t first_serial = 1;

// A number that looks like chance and is the same in each run.
std::uint32_t scatter(std::uint32_t number) {
  for (int round = 0; round < 3; ++round) number = (number ^ (number >> 13)) * 2654435761U;
  return number ^ (number >> 16);
}

std::string gateway_name(std::uint32_t number) { return "g" + std::to_string(number); }

}  // namespace

void ErrorLog::write(port::Level level, std::string_view line) {
  if (level == port::Level::info || ++told_ > lines_told) return;
  std::fprintf(stderr, "%.*s\n", static_cast<int>(line.size()), line.data());
}

// The connection of a member that reads what it has said itself, and nothing of others: what
// a million nodes would be to each of those that only tell them.
class Participant::OwnTopics final : public port::MessageBroker {
 public:
  OwnTopics(port::MessageBroker& whole, std::string filter)
      : whole_(whole), filter_(std::move(filter)) {}

  bool is_connected() const override { return whole_.is_connected(); }
  std::string_view why_down() const override { return whole_.why_down(); }
  const port::BrokerCounters& counters() const override { return whole_.counters(); }
  void set_listener(port::BrokerListener* listener) override { whole_.set_listener(listener); }
  void set_last_will(const port::BrokerMessage& message) override { whole_.set_last_will(message); }
  void subscribe(std::span<const std::string>) override {
    whole_.subscribe(std::span<const std::string>(&filter_, 1));
  }
  bool publish(const port::BrokerMessage& message, std::uint32_t token) override {
    return whole_.publish(message, token);
  }
  void step(port::Instant now) override { whole_.step(now); }
  port::Instant next_deadline() const override { return whole_.next_deadline(); }

 private:
  port::MessageBroker& whole_;
  std::string filter_;
};

Participant::Participant(port::EventLoop& loop, port::Log& log, const port::Endpoint& broker,
                         const firmware::FleetSettings& settings, bool reads_all, port::Instant now)
    : connection_(loop, log,
                  {.end = broker,
                   .client_id = settings.site + ":" + settings.gateway,
                   .user = {},
                   .password = {},
                   .keep_alive = 60s,
                   .tls = {}}) {
  port::MessageBroker* wanted = &connection_;
  if (!reads_all) {
    own_topics_ = std::make_unique<OwnTopics>(
        connection_, "etcm/v1/" + settings.site + "/" + settings.gateway + "/#");
    wanted = own_topics_.get();
  }
  member_ = std::make_unique<firmware::FleetMember>(settings, *wanted, *this, log, now);
}

Participant::~Participant() = default;

void Participant::step(port::Instant now) {
  connection_.step(now);
  member_->step(now);
}

port::Instant Participant::next_deadline() const {
  return std::min(connection_.next_deadline(), member_->next_deadline());
}

firmware::FleetSettings settings_of(const CrowdOptions& options, const std::string& gateway) {
  firmware::FleetSettings settings;
  settings.site = options.site;
  settings.gateway = gateway;
  settings.instance = std::hash<std::string>{}(gateway);
  settings.report_min = 500ms;
  settings.nodes_max = (options.reads_all ? options.gateways * options.nodes : options.nodes) + 100;
  settings.members_max = std::max<std::uint32_t>(options.gateways + 10, 32);
  return settings;
}

Crowd::Crowd(port::EventLoop& loop, port::Log& log, const CrowdOptions& options, port::Instant now)
    : options_(options) {
  for (std::uint32_t number = 0; number < options.gateways; ++number) {
    members_.push_back(std::make_unique<Participant>(loop, log, options.broker,
                                                     settings_of(options, gateway_name(number)),
                                                     options.reads_all, now));
  }
}

void Crowd::hear_all(port::Instant now) {
  for (std::uint32_t index = 0; index < node_count(); ++index) hear(index, place_of(index, 0), now);
}

Crowd::Move Crowd::move_next(port::Instant now) {
  const std::uint32_t turn = moves_ / node_count() + 1;
  const std::uint32_t number = moves_++ % node_count();
  const std::uint32_t index =
      number % options_.gateways * options_.nodes + number / options_.gateways;
  const Position position = place_of(index, turn);
  hear(index, position, now);
  return {.serial = Serial{first_serial + index}, .position = position};
}

void Crowd::step(port::Instant now) {
  for (const auto& member : members_) member->step(now);
}

port::Instant Crowd::next_deadline() const {
  port::Instant next = port::never;
  for (const auto& member : members_) next = std::min(next, member->next_deadline());
  return next;
}

bool Crowd::has_told_all() const {
  return std::all_of(members_.begin(), members_.end(), [&](const auto& participant) {
    const firmware::FleetStatus status = participant->member().status();
    return status.is_settled && status.waiting_count == 0 && status.own_count == options_.nodes;
  });
}

// The grid is as square as can be, and a gateway has some of its rows.
Position Crowd::place_of(std::uint32_t index, std::uint32_t turn) const {
  const auto side = static_cast<std::uint32_t>(std::ceil(std::sqrt(node_count())));
  const auto off = [](std::uint32_t seed) {
    return static_cast<std::int32_t>(scatter(seed) % (2 * spacing / 3)) - spacing / 3;
  };
  const std::uint32_t seed = 2 * (index + turn * node_count());
  return {static_cast<std::int32_t>(index % side) * spacing + off(seed),
          static_cast<std::int32_t>(index / side) * spacing + off(seed + 1)};
}

void Crowd::hear(std::uint32_t index, Position position, port::Instant now) {
  firmware::FleetNode node{.serial = Serial{first_serial + index}, .position = position};
  node.status = 1;
  static_cast<void>(members_[index / options_.nodes]->member().hear(node, now));
}

}  // namespace etcm::bench

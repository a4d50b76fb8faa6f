#include "neighbour.h"

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <iterator>
#include <utility>

namespace etcm::simulation {

using namespace std::chrono_literals;

namespace {

constexpr std::size_t nodes_max = 6;
constexpr Duration hearing = 20s;

firmware::FleetSettings settings_of(std::uint64_t run) {
  firmware::FleetSettings settings;
  settings.site = "yard";
  settings.gateway = "east";
  settings.instance = run;
  settings.is_alone = true;
  settings.report_min = 500ms;
  return settings;
}

}  // namespace

Neighbour::Neighbour(test::BrokerModel& broker, inputs::Random& random, Instant now)
    : broker_(broker), random_(random) {
  start(now);
}

void Neighbour::start(Instant now) {
  if (member_ != nullptr) return;
  learned_.clear();
  client_.emplace(broker_, random_, std::size_t{0}, clock_);
  client_->set_network(has_network_);
  member_ = std::make_unique<firmware::FleetMember>(settings_of(7000 + ++runs_), *client_, *this,
                                                    *this, now);
  if (saved_) static_cast<void>(member_->restore(*saved_, now));
  hear_at_ = now;
}

void Neighbour::die(Instant now) {
  if (member_ == nullptr) return;
  client_->close(false, now);
  // It speaks to its client until it ends.
  member_.reset();
  client_.reset();
}

void Neighbour::step(Instant now) {
  now_ = now;
  if (member_ == nullptr) return;
  client_->set_network(has_network_);
  client_->step(now);
  if (hear_at_ <= now) hear_all(now);
  member_->step(now);
  if (member_->take_news_to_save()) saved_ = member_->save();
}

Instant Neighbour::next() const {
  if (member_ == nullptr) return port::never;
  return std::min({client_->next_deadline(), hear_at_, member_->next_deadline()});
}

void Neighbour::hear_all(Instant now) {
  hear_at_ = now + hearing;
  for (const auto& [serial, place] : nodes_) {
    told_.insert({serial, {place.x, place.y}});
    static_cast<void>(
        member_->hear({.serial = firmware::Serial{serial}, .position = place, .status = 1}, now));
  }
  // What left before it died, and nobody was told.
  std::vector<firmware::Serial> left;
  member_->for_each_node([&](const firmware::FleetRecord& record, bool) {
    if (member_->is_own(record) && !nodes_.contains(record.node.serial.value)) {
      left.push_back(record.node.serial);
    }
  });
  for (const firmware::Serial serial : left) {
    member_->remove(serial, firmware::LeftReason::asked, now);
  }
}

// Where no node of the other gateway ever is.
Position Neighbour::free_place() const {
  for (;;) {
    const Position place{random_.between(3100, 6000), random_.between(-3000, 3000)};
    const bool is_taken =
        std::ranges::any_of(nodes_, [&](const auto& node) { return node.second == place; });
    if (!is_taken) return place;
  }
}

void Neighbour::change(Instant now) {
  hear_at_ = now;
  const std::uint64_t what = random_.below(4);
  if (nodes_.empty() || (what == 0 && nodes_.size() < nodes_max)) {
    nodes_[next_serial_++] = free_place();
    return;
  }
  auto node = nodes_.begin();
  std::advance(node, static_cast<std::ptrdiff_t>(random_.index(nodes_.size())));
  if (what != 1) {
    node->second = free_place();
    return;
  }
  // It leaves while somebody is there to hear it.
  if (member_ == nullptr) return;
  member_->remove(firmware::Serial{node->first}, firmware::LeftReason::asked, now);
  nodes_.erase(node);
}

std::optional<firmware::FleetAgreement> Neighbour::agreement() const {
  if (member_ == nullptr) return std::nullopt;
  return member_->agreement();
}

void Neighbour::on_node(const firmware::FleetRecord& record, bool is_stale, Instant) {
  learned_[record.node.serial.value] = {.position = record.node.position, .is_stale = is_stale};
}

void Neighbour::on_node_gone(firmware::Serial serial, firmware::LeftReason, Instant) {
  learned_.erase(serial.value);
}

void Neighbour::write(port::Level, std::string_view line) {
  if (std::getenv("ETCM_SIMULATION_VERBOSE") == nullptr) return;
  std::printf("[%10.3f] east: %.*s\n",
              std::chrono::duration<double>(now_.time_since_epoch() - 1h).count(),
              static_cast<int>(line.size()), line.data());
}

}  // namespace etcm::simulation

// Another gateway of the same site, as far as its fleet is concerned: it hears nodes of its own and
// tells of them, learns of those of the gateway that is judged, dies and comes back.
#pragma once

#include <map>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "device.h"
#include "etcm/port/log.h"
#include "firmware/fleet/fleet_member.h"
#include "fleet/broker_model.h"

namespace etcm::simulation {

class Neighbour final : public firmware::FleetListener, public port::Log {
 public:
  struct Learned {
    std::optional<Position> position;
    bool is_stale = false;
  };

  Neighbour(test::BrokerModel& broker, inputs::Random& random, Instant now);

  void step(Instant now);
  Instant next() const;

  // Its program ends, and nothing but what was saved is left; it may be gone too.
  void die(Instant now);
  void start(Instant now);
  bool is_dead() const { return member_ == nullptr; }
  void lose_disk() { saved_.reset(); }
  void set_network(bool is_up) { has_network_ = is_up; }

  // A node of its own comes, moves or leaves.
  void change(Instant now);

  const std::map<std::uint32_t, Position>& nodes() const { return nodes_; }
  // Whether it has ever told that.
  bool has_told(std::uint32_t serial, Position place) const {
    return told_.contains({serial, {place.x, place.y}});
  }
  const std::map<std::uint32_t, Learned>& learned() const { return learned_; }
  // Who is there, and who has the same nodes. None while it is dead.
  std::optional<firmware::FleetAgreement> agreement() const;

  void on_node(const firmware::FleetRecord& record, bool is_stale, Instant now) override;
  void on_node_gone(firmware::Serial serial, firmware::LeftReason reason, Instant now) override;
  void on_peer(const firmware::PeerReport&, Instant) override {}
  void on_name_conflict(bool, bool, Instant) override {}
  std::string on_site(const firmware::SiteDocument&, Instant) override { return {}; }
  void write(port::Level level, std::string_view line) override;

 private:
  void hear_all(Instant now);
  Position free_place() const;

  test::BrokerModel& broker_;
  inputs::Random& random_;
  const test::MemberClock clock_;
  std::optional<test::ModelClient> client_;
  std::unique_ptr<firmware::FleetMember> member_;
  std::optional<std::vector<std::byte>> saved_;
  std::map<std::uint32_t, Position> nodes_;
  std::set<std::pair<std::uint32_t, std::pair<std::int32_t, std::int32_t>>> told_;
  std::map<std::uint32_t, Learned> learned_;
  std::uint64_t runs_ = 0;
  std::uint32_t next_serial_ = 900'001;
  bool has_network_ = true;
  Instant hear_at_{};
  Instant now_{};
};

}  // namespace etcm::simulation

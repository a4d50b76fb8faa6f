// A gateway as far as a fleet is concerned: it hears the nodes within its reach, gives up those
// that fall silent, keeps a mesh of the set that its member knows, and has clocks and a disk.
#pragma once

#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "broker_model.h"
#include "etcm/port/log.h"
#include "firmware/fleet/fleet_member.h"
#include "inputs/owned_mesh.h"

namespace etcm::test {

using firmware::FleetMember;
using firmware::FleetRecord;
using firmware::FleetSettings;
using firmware::LeftReason;
using firmware::Serial;

// Where nodes really are, and who can hear them.
struct WorldNode {
  Position position;
  std::uint32_t hearers = 0;  // bits, by number of the gateway
  bool is_leaving = false;
  friend bool operator==(const WorldNode&, const WorldNode&) = default;
};
using World = std::map<Serial, WorldNode>;

// What a gateway keeps over a restart.
struct Disk {
  std::optional<std::vector<std::byte>> saved;
  std::vector<Serial> table;
  std::uint32_t site_file = 0;  // what is drawn in it; 0: there is none
};

class GatewayModel final : public firmware::FleetListener, public port::Log {
 public:
  static constexpr port::Duration lose_after = std::chrono::seconds(3);
  static constexpr port::Duration remove_after = std::chrono::seconds(40);

  // `number` is its bit in WorldNode::hearers. All times that it is given are those of the
  // simulation; its member knows those of `clock` alone.
  GatewayModel(const FleetSettings& settings, std::uint32_t number, BrokerModel& broker,
               Random& random, std::size_t side, const MemberClock& clock, Disk& disk,
               Instant time);

  void step(const World& world, Instant time);
  // Its site file is another one, and is read again.
  void read_site_file(bool is_changed, Instant time);

  ModelClient& client() { return client_; }
  FleetMember& member() { return *member_; }
  const FleetSettings& settings() const { return settings_; }
  std::uint32_t number() const { return number_; }
  bool is_read_only() const { return is_read_only_; }
  bool has_conflict() const { return has_conflict_; }

  // All that is known, a node a line, and the site.
  std::string set_text() const;
  // What the events of the listener come to, and what for_each_node() says of the same.
  std::string events_text() const;
  std::string visited_text() const;
  // Of the mesh that has followed the set change by change, made canonical.
  std::uint64_t mesh_hash();

  void on_node(const FleetRecord& record, bool is_stale, Instant now) override;
  void on_node_gone(Serial serial, LeftReason reason, Instant now) override;
  void on_peer(const firmware::PeerReport&, Instant) override {}
  void on_name_conflict(bool is_conflict, bool is_read_only, Instant now) override;
  std::string on_site(const firmware::SiteDocument& document, Instant now) override;
  void write(port::Level level, std::string_view line) override;

 private:
  struct Heard {
    Instant at;
    bool is_lost = false;
  };
  void poll(const World& world, const std::string& time_of_day, Instant now);
  void save(Instant now);
  void follow_set();

  FleetSettings settings_;
  std::uint32_t number_;
  Random& random_;
  const MemberClock& clock_;
  Disk& disk_;
  ModelClient client_;
  std::unique_ptr<FleetMember> member_;
  std::map<Serial, Heard> table_;
  std::map<Serial, std::string> foreign_;
  Instant next_poll_{};
  Instant next_save_{};
  Instant next_mesh_{};
  bool is_read_only_ = false;
  bool has_conflict_ = false;
  inputs::OwnedMesh mesh_;
  struct Placed {
    VertexId vertex;
    Position position;
  };
  std::map<Serial, Placed> placed_;
};

inline constexpr std::uint32_t model_nodes_max = 64;
FleetSettings model_settings(const std::string& name, std::uint64_t instance);
// Between these, in every mesh of the models, run the features.
std::vector<Position> model_anchors();
std::vector<FeatureEnds> model_features();
MeshConfig model_mesh();

}  // namespace etcm::test

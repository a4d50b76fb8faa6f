// The gateway: nodes are polled, the mesh follows them, and each state of it is published.
//
// Everything that changed between two publications is one generation: a node that joins on its own
// has a generation of its own, and a burst of them shares one, publish_pause apart from the next.
// What nodes measure is published beside it, as seldom, and makes no generation.
// No input or output of its own, no waiting: its caller calls step() when bytes have arrived
// or next_deadline() is reached.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "etcm/port/clock.h"
#include "etcm/port/log.h"
#include "etcm/port/mesh_files.h"
#include "etcm/port/mesh_server.h"
#include "etcm/port/message_broker.h"
#include "etcm/port/store.h"
#include "etcm/port/wall_clock.h"
#include "firmware/config/settings.h"
#include "firmware/gateway/far_node_watch.h"
#include "firmware/gateway/fleet_link.h"
#include "firmware/gateway/fleet_report.h"
#include "firmware/gateway/serial_clashes.h"
#include "firmware/gateway/unheard_ends.h"
#include "firmware/mesh/kept_mesh.h"
#include "firmware/mesh/node_placement.h"
#include "firmware/mesh/site_keeper.h"
#include "firmware/nodes/absent_units.h"
#include "firmware/nodes/address_assigner.h"
#include "firmware/nodes/admission.h"
#include "firmware/nodes/presence.h"
#include "firmware/persist/file_publisher.h"
#include "firmware/persist/state_saver.h"
#include "firmware/persist/state_transfer.h"
#include "firmware/polling/device.h"
#include "firmware/polling/poller.h"
#include "firmware/publish/image_pool.h"
#include "firmware/publish/neighbour_distributor.h"
#include "firmware/publish/quarantine.h"
#include "firmware/publish/reading_taker.h"
#include "firmware/publish/snapshot_taker.h"
#include "firmware/readings/sensor_watch.h"
#include "firmware/records/foreign_readings.h"
#include "firmware/records/node_table.h"
#include "firmware/records/reading_table.h"

namespace etcm::firmware {

// Least time between two publications; and at most this share of all time is spent on them.
inline constexpr port::Duration publish_pause = std::chrono::milliseconds(100);
// Other gateways' names of nodes are taken over no more often.
inline constexpr port::Duration told_names_pause = std::chrono::seconds(1);
inline constexpr int publish_share = 20;
// A change of the mesh that waits longer than that is stuck.
inline constexpr port::Duration publish_patience = std::chrono::seconds(10);

struct GatewayPorts {
  std::span<const PolledBus> buses;
  port::MeshServer& server;
  port::MeshFiles* files = nullptr;  // null: no files are wanted
  port::Store* store = nullptr;      // null: nothing outlives a restart
  const port::Clock& clock;
  const port::WallClock* wall_clock = nullptr;  // null: no restart tells how long it took
  port::Log& log;
  port::MessageBroker* broker = nullptr;          // null: it is in no fleet
  port::ProjectionSource* projections = nullptr;  // null: of no site that comes by the broker
  std::uint64_t run = 0;       // another for each run of a program, on any machine
  std::string_view version{};  // of the program, as the fleet is told
};

class Gateway final : private ReadingListener, private RequestSource {
 public:
  // The mesh is open and empty. It and the ports must outlive the gateway.
  Gateway(std::shared_ptr<const Settings> settings, Mesh& mesh, const GatewayPorts& ports);

  // Publishes the mesh that the store has of an earlier run, all nodes stale. Before the first
  // step.
  void restore(port::Instant now);

  void step(port::Instant now);
  port::Instant next_deadline() const;

  // Publishes what is still unpublished, and says how things stand. Also starts the last save and
  // the last files, unless such are under way.
  void finish(port::Instant now);
  // Hears how these went.
  void finish_saving(port::Instant now);

  // Asks the units with this address next: a node is said to be there.
  void ask_at_once(ModbusAddress address, port::Instant now) { poller_.ask_at_once(address, now); }

  // Other settings, in what can change while the gateway runs (reload.h). `added`: for each bus
  // that the settings have beyond those before, in this order. Where units are asked more often
  // than before, silence counts once all of them have had time to answer.
  void update_settings(std::shared_ptr<const Settings> settings, std::span<const PolledBus> added,
                       port::Instant now);

  // The node is waited for no longer. False: none with this serial is missing, or the mesh cannot
  // do without it.
  bool dismiss(Serial serial);
  // The same of all nodes that are missing, and of all gateways that are gone and have none left.
  // Returns how many.
  std::uint32_t dismiss_all(port::Instant now);
  // The gateway is left out of the list, and its nodes that are missing are waited for no longer.
  // False: none of this name is gone.
  bool dismiss_gateway(std::string_view name, port::Instant now);
  // Where its nodes are still waited for: in so much time at the soonest they leave.
  std::optional<port::Duration> nodes_leave_in(std::string_view name, port::Instant now) const {
    return fleet_ ? fleet_->nodes_leave_in(name, now) : std::nullopt;
  }

  // Those who read along over the broker are given this message, where there is one
  // (alarm_teller.h).
  void tell_alarms(std::string message) {
    if (fleet_) fleet_->tell_alarms(std::move(message));
  }

  // With the site that holds, which may be that of another gateway.
  const Settings& settings() const { return *settings_; }

  std::uint32_t generation() const { return generation_; }
  std::uint32_t node_count() const { return kept_.node_count(); }
  // A change of the mesh has waited for so long beyond the pause between two generations.
  bool is_late(port::Instant now, port::Duration patience) const {
    return changed_ && publish_due_ + patience < now;
  }
  // As published last (snapshot.h).
  std::uint16_t state() const { return state_; }
  const Snapshot& snapshot() const { return snapshots_.latest(); }
  // What the nodes measure; published more often than the mesh.
  const ReadingSnapshot& readings() const { return reading_taker_.latest(); }

  // Null where the gateway is in none.
  const FleetReport* fleet() const { return fleet_ ? &fleet_->report() : nullptr; }

  // Null where nothing is to be written there.
  const DiskWriter* disk_of_files() const {
    return file_publisher_ ? &file_publisher_->disk() : nullptr;
  }
  const DiskWriter* disk_of_state() const { return state_saver_ ? &state_saver_->disk() : nullptr; }
  const Poller& poller() const { return poller_; }
  // As they are now; published are readings().
  const ReadingTable& reading_table() const { return reading_table_; }
  const NodeTable& nodes() const { return nodes_; }
  std::span<const FeatureRecord> features() const { return kept_.features().records(); }
  const UnheardEnds& unheard_ends() const { return unheard_ends_; }
  const FarNodeWatch& far_nodes() const { return far_nodes_; }
  const Presence& presence() const { return presence_; }
  const AbsentUnits& absent_units() const { return absent_units_; }
  const MeshTimes& mesh_times() const { return placement_.times(); }
  // As published last.
  std::span<const QuarantineEntry> quarantine() const { return quarantine_; }

 private:
  bool on_reading(UnitIndex unit, const NodeReading& reading, std::span<const Measurement> measured,
                  port::Instant now) override;
  port::Instant request_due(BusIndex bus) const override;
  bool next_request(BusIndex bus, port::Instant now, BusRequest& request) override;
  void on_request_done(BusIndex bus, const port::BusAnswer& answer, port::Instant now) override;
  // The last node that the assigner gave a unit.
  void move_from_default_unit(BusIndex bus, UnitIndex unit);
  // The node is another gateway's, and stays so.
  bool is_left_to_others(NodeRecord& node, const NodeReading& reading, port::Instant now);
  void follow_position(NodeRecord& node);
  // The same settings with another site.
  void take_site(std::shared_ptr<const Settings> settings, port::Instant now);
  void sweep(port::Instant now);
  void reserve_quarantine();
  void take_names();
  void take_told_names(port::Instant now);
  void publish(port::Instant now);
  void publish_readings(port::Instant now);
  bool has_reading_news() const {
    return reading_table_.has_news() || foreign_readings_.has_news();
  }
  // Of the mesh: what is published is a function of its nodes and features.
  void forget_history();
  void save_state(port::Instant now);
  void keep_at_once();
  void keep_silences(port::Instant now);
  void keep_learned(port::Instant now);
  std::int64_t time_of_day_s() const;
  port::Duration time_since(const SavedState& saved) const;
  void log_restored(const SavedState& saved, bool is_same);

  std::shared_ptr<const Settings> settings_;
  const GatewayPorts ports_;
  DeviceTable devices_;
  Poller poller_;
  NodeTable nodes_;
  ReadingTable reading_table_;
  ForeignReadings foreign_readings_;
  KeptMesh kept_;
  SiteKeeper site_;
  NodePlacement placement_;
  Presence presence_;
  AbsentUnits absent_units_;
  Admission admission_;
  SerialClashes clashes_;
  AddressAssigner assigner_;
  std::vector<bool> is_assigning_;  // by bus: whose request is under way
  std::vector<QuarantineEntry> quarantine_;
  UnheardEnds unheard_ends_;
  FarNodeWatch far_nodes_;
  SnapshotTaker snapshots_;
  ReadingTaker reading_taker_;
  SensorWatch sensors_;
  NeighbourDistributor distributor_;
  ImagePool images_;
  StateTransfer state_transfer_;
  std::optional<StateSaver> state_saver_;
  std::optional<FilePublisher> file_publisher_;
  std::optional<FleetLink> fleet_;
  port::Instant told_names_due_{};  // not before
  port::Instant publish_due_{};     // not before
  port::Instant readings_due_{};    // as well
  std::uint32_t generation_ = 0;    // published last
  std::uint16_t state_ = 0;
  bool changed_ = false;        // since then
  bool keeps_history_ = false;  // there is no room to forget it
  port::Instant missing_saved_at_{};
  port::Instant learned_saved_at_{};
  std::uint32_t learned_edition_ = 0;
};

// The image a server has before the first generation.
std::shared_ptr<const port::RegisterImage> empty_image(const Settings& settings);

}  // namespace etcm::firmware

#include "firmware/gateway/gateway.h"

#include <algorithm>
#include <string>
#include <utility>
#include <vector>

#include "etcm/audit.h"
#include "firmware/config/fleet_settings.h"
#include "firmware/config/shared_site.h"
#include "firmware/gateway/plane_change.h"
#include "firmware/logging/counted.h"
#include "firmware/publish/mesh_registers.h"
#include "firmware/site/site_plane.h"

namespace etcm::firmware {

namespace {

using namespace std::chrono_literals;

// Between two saves of what was learned of the sensors.
constexpr port::Duration learned_pause = 10min;
// Beyond it nothing that was saved counts; and it fits a duration.
constexpr std::int64_t forever_s = std::chrono::seconds(24h * 366 * 100).count();

// The published one, the next, and what a client that reads slowly is pinned to.
constexpr std::size_t images_ready = 3;

}  // namespace

Gateway::Gateway(std::shared_ptr<const Settings> settings, Mesh& mesh, const GatewayPorts& ports)
    : settings_(std::move(settings)),
      ports_(ports),
      devices_(*settings_),
      poller_(settings_->poll, ports.buses, *this, ports.log, this, &devices_),
      nodes_(poller_.unit_count(), settings_->room.units, foreign_room(*settings_)),
      reading_table_(poller_),
      foreign_readings_(quantities_listed_max),
      kept_(mesh, *settings_),
      site_(kept_, nodes_, ports.clock, ports.log),
      placement_(kept_, site_, nodes_, *settings_, ports.clock, ports.log),
      presence_(settings_->poll, poller_, nodes_, reading_table_, placement_, ports.log),
      admission_(settings_->poll, kept_.features(), nodes_, poller_, ports.log),
      clashes_(nodes_, poller_, ports.log),
      assigner_(settings_->poll, poller_, nodes_, ports.log),
      is_assigning_(poller_.bus_count()),
      unheard_ends_(kept_.features(), ports.log),
      far_nodes_(nodes_, poller_, ports.log),
      snapshots_(*settings_,
                 node_record_capacity(std::max(poller_.unit_count(), settings_->room.units)) +
                     foreign_room(*settings_)),
      reading_taker_(*settings_),
      sensors_(*settings_),
      distributor_(*settings_, poller_, nodes_, snapshots_.latest(), ports.log),
      images_(register_capacity(*settings_), images_ready, settings_->server.clients_max + 2),
      state_transfer_(kept_, site_, placement_, nodes_, poller_) {
  reserve_quarantine();
  take_names();
  unheard_ends_.take_site(ports.clock.now());
  if (ports.store != nullptr && settings_->state) {
    state_saver_.emplace(*settings_, publish_pause, *ports.store, ports.log);
  }
  if (ports.files != nullptr) {
    file_publisher_.emplace(*settings_, publish_share, *ports.files, ports.clock, ports.log);
  }
  if (ports.broker != nullptr && settings_->mqtt) {
    fleet_.emplace(settings_,
                   FleetPorts{.broker = *ports.broker,
                              .wall_clock = ports.wall_clock,
                              .log = ports.log,
                              .projections = ports.projections,
                              .run = ports.run,
                              .version = ports.version},
                   kept_, nodes_, foreign_readings_, placement_, ports.clock.now());
  }
}

void Gateway::restore(port::Instant now) {
  if (!state_saver_) return;
  std::optional<SavedState> saved = state_saver_->load();
  if (!saved) return;
  generation_ = saved->next_generation - 1;
  // Before the nodes: the mesh was one of that site.
  auto settings = fleet_ ? fleet_->restore_site(saved->fleet) : nullptr;
  if (settings != nullptr) take_site(std::move(settings), now);
  const bool is_moved = follow_plane(settings_->site, ports_.projections,
                                     {.devices = devices_, .poller = poller_}, *saved, ports_.log);
  const bool is_shared = fleet_ && settings_->mqtt->share == FleetShare::site;
  const bool is_same =
      state_transfer_.restore(*saved, time_since(*saved), is_shared, generation_ + 1, now);
  // Before the first mesh only a promise about generations is saved.
  if (saved->generation > 0) log_restored(*saved, is_same);
  sensors_.restore(saved->sensors, saved->quantities, time_since(*saved), now);
  if (fleet_) fleet_->restore(saved->fleet, is_moved, now);
  presence_.tell_missing(now);
  static_cast<void>(kept_.take_changed());
  // Units where a node was are asked at once, before their turn.
  for (const NodeRecord& node : nodes_.records()) {
    if (!node.unit_index.is_none()) poller_.ask_unit_at_once(node.unit_index, now);
  }
  publish(now);
}

void Gateway::log_restored(const SavedState& saved, bool is_same) {
  const Mesh& mesh = kept_.mesh();
  ports_.log.write(
      port::Level::info,
      std::string(is_same ? "restored the mesh" : "restored the nodes, not their mesh,") +
          " of generation " + std::to_string(saved.generation) + ": " +
          std::to_string(kept_.node_count()) + " of " +
          to_string(Counted{saved.nodes.size(), "node", "nodes"}) + ", " +
          to_string(Counted{kept_.features().active_count(), "feature", "features"}) + ", " +
          to_string(Counted{mesh.steiner_count(), "proposed relay", "proposed relays"}) +
          "; all are stale until they answer");
}

void Gateway::step(port::Instant now) {
  presence_.turn(now);
  poller_.step(now);
  if (fleet_) {
    fleet_->step(now, generation_ + 1);
    if (auto settings = fleet_->take_settings()) take_site(std::move(settings), now);
    take_told_names(now);
    if (fleet_->take_clash_news()) {
      clashes_.take(fleet_->clashes());
      changed_ = true;
    }
  }
  if (presence_.is_due(now)) sweep(now);
  placement_.retry_rejected(generation_ + 1);
  changed_ = kept_.take_changed() || changed_;
  changed_ = admission_.take_changed() || changed_;
  changed_ = presence_.take_changed() || changed_;
  if (changed_ && publish_due_ <= now) publish(now);
  if (sensors_.next_deadline() <= now) {
    sensors_.observe(snapshot(), readings(), nodes_, now, ports_.log);
    publish_readings(now);
  } else if (has_reading_news() && readings_due_ <= now) {
    publish_readings(now);
  }
  if (file_publisher_) {
    file_publisher_->step(now);
    if (file_publisher_->is_due(now))
      file_publisher_->write(snapshot(), readings(), settings_->site.plane(), now);
  }
  if (state_saver_) {
    keep_silences(now);
    keep_learned(now);
    if (fleet_ && fleet_->take_news_to_save()) state_saver_->mark_dirty();
    state_saver_->step(now);
    // What is saved is a generation that was published.
    if (!changed_ && state_saver_->is_due(now)) save_state(now);
  }
}

void Gateway::sweep(port::Instant now) {
  admission_.sweep(now);
  presence_.sweep(now, generation_ + 1);
  if (fleet_) fleet_->sweep(now);
  changed_ = changed_ || presence_.waiting_count() != snapshot().waiting_count;
  changed_ =
      absent_units_.look(*settings_, poller_, presence_, nodes_, ports_.log, now) || changed_;
  unheard_ends_.look(nodes_, poller_, fleet(), settings_->poll.leave_after, now);
  far_nodes_.look(snapshot(), *settings_, now);
}

void Gateway::update_settings(std::shared_ptr<const Settings> settings,
                              std::span<const PolledBus> added, port::Instant now) {
  const bool is_faster = settings->poll.interval < settings_->poll.interval;
  const auto before = std::exchange(settings_, std::move(settings));
  if (fleet_) {
    fleet_->update_settings(settings_, now);
    if (auto shared = fleet_->take_settings()) settings_ = std::move(shared);
  }
  devices_.update_settings(*settings_);
  const PollSettings& poll = settings_->poll;
  const port::Instant heard_by = poller_.update_settings(poll, settings_->buses, now);
  for (const PolledBus& bus : added) poller_.add_bus(poll, bus);
  nodes_.add_units(poller_.unit_count());
  take_names();
  reading_table_.add_units(poller_);
  reading_taker_.update_settings(*settings_);
  images_.set_capacity(register_capacity(*settings_), snapshot());
  sensors_.update_settings(*settings_);
  is_assigning_.resize(poller_.bus_count());
  presence_.update_settings(poll, is_faster ? heard_by : now, now);
  admission_.update_settings(poll);
  assigner_.update_settings(poll);
  distributor_.update_settings(poll);
  placement_.update_site(*settings_, generation_ + 1);
  follow_plane(settings_->site, before->site, {.devices = devices_, .poller = poller_}, nodes_,
               placement_, generation_ + 1, ports_.log);
  unheard_ends_.take_site(now);
  snapshots_.update_site(*settings_);
  if (file_publisher_) file_publisher_->update_settings(*settings_->files);
  if (state_saver_) state_saver_->update_settings(*settings_);
  reserve_quarantine();
}

bool Gateway::dismiss(Serial serial) {
  NodeRecord* const node = nodes_.find(serial);
  if (node == nullptr || !presence_.dismiss(*node)) return false;
  keep_at_once();
  return true;
}

std::uint32_t Gateway::dismiss_all(port::Instant now) {
  std::uint32_t count = 0;
  for (NodeRecord& node : nodes_.records()) {
    if (node.is_known() && presence_.dismiss(node)) ++count;
  }
  keep_at_once();
  return count + (fleet_ ? fleet_->dismiss_gone(now) : 0);
}

bool Gateway::dismiss_gateway(std::string_view name, port::Instant now) {
  if (!fleet_ || !fleet_->is_gone(name)) return false;
  const std::span<const std::string> names = fleet_->gateways();
  for (NodeRecord& node : nodes_.records()) {
    if (!node.is_known() || !node.is_foreign() || names[node.owner.value] != name) continue;
    static_cast<void>(presence_.dismiss(node));
  }
  keep_at_once();
  return fleet_->dismiss_gone(name, now);
}

void Gateway::take_names() {
  nodes_.set_names(std::make_shared<const NameBook>(
      *settings_, poller_, fleet_ ? fleet_->told_names() : std::vector<ToldName>()));
}

// One that has just come to a large fleet hears new names all the time.
void Gateway::take_told_names(port::Instant now) {
  if (now < told_names_due_ || !fleet_->take_name_news()) return;
  told_names_due_ = now + told_names_pause;
  take_names();
  changed_ = true;
}

void Gateway::reserve_quarantine() {
  quarantine_.reserve(quarantine_max(nodes_, kept_.features(), kept_.anchors(), admission_) +
                      2 * clashes_max);
}

void Gateway::take_site(std::shared_ptr<const Settings> settings, port::Instant now) {
  const auto before = std::exchange(settings_, std::move(settings));
  devices_.update_settings(*settings_);
  take_names();
  placement_.update_site(*settings_, generation_ + 1);
  follow_plane(settings_->site, before->site, {.devices = devices_, .poller = poller_}, nodes_,
               placement_, generation_ + 1, ports_.log);
  unheard_ends_.take_site(now);
  snapshots_.update_site(*settings_);
  reserve_quarantine();
}

port::Instant Gateway::next_deadline() const {
  port::Instant deadline =
      std::min({poller_.next_deadline(), presence_.next_deadline(), placement_.next_deadline()});
  if (file_publisher_) deadline = std::min(deadline, file_publisher_->next_deadline());
  if (fleet_) deadline = std::min(deadline, fleet_->next_deadline());
  if (has_reading_news()) deadline = std::min(deadline, readings_due_);
  deadline = std::min(deadline, sensors_.next_deadline());
  if (changed_) return std::min(deadline, publish_due_);
  if (state_saver_) deadline = std::min(deadline, state_saver_->next_deadline());
  return deadline;
}

void Gateway::finish(port::Instant now) {
  if (changed_) publish(now);
  if (has_reading_news()) publish_readings(now);
  if (file_publisher_) {
    file_publisher_->step(now);
    file_publisher_->write(snapshot(), readings(), settings_->site.plane(), now);
  }
  if (state_saver_ && !ports_.store->is_saving()) {
    state_saver_->step(now);
    state_saver_->finish();
    if (sensors_.take_learned()) ++learned_edition_;
    save_state(now);
  }
  const Mesh& mesh = kept_.mesh();
  const Audit audited = audit(mesh);
  ports_.log.write(
      audited ? port::Level::info : port::Level::error,
      "ends at generation " + std::to_string(generation_) + ": " +
          to_string(Counted{kept_.node_count(), "node", "nodes"}) + ", " +
          std::to_string(kept_.features().active_count()) + " of " +
          to_string(Counted{kept_.features().records().size(), "feature", "features"}) + ", " +
          to_string(Counted{mesh.steiner_count(), "proposed relay", "proposed relays"}) + ", " +
          to_string(Counted{mesh.finite_triangle_count(), "triangle", "triangles"}) + ", " +
          (audited ? std::string("audit passed: conforming")
                   : std::string("audit failed: ") + to_string(audited.broken)));
}

void Gateway::finish_saving(port::Instant now) {
  if (state_saver_) state_saver_->step(now);
  if (file_publisher_) file_publisher_->step(now);
}

void Gateway::keep_at_once() {
  if (state_saver_) state_saver_->mark_urgent();
}

// Since when a node is missing is on the disk too, within the hour.
void Gateway::keep_silences(port::Instant now) {
  if (snapshot().missing_count == 0 || now - missing_saved_at_ < 1h) return;
  missing_saved_at_ = now;
  state_saver_->mark_dirty();
}

// What was learned of the sensors changes with each sample.
void Gateway::keep_learned(port::Instant now) {
  if (learned_saved_at_ == port::Instant{}) learned_saved_at_ = now;
  if (now - learned_saved_at_ < learned_pause || !sensors_.take_learned()) return;
  learned_saved_at_ = now;
  ++learned_edition_;
  state_saver_->mark_dirty();
}

void Gateway::save_state(port::Instant now) {
  StateWriter& writer = state_saver_->begin(generation_, kept_.mesh().hash(), time_of_day_s());
  state_transfer_.write(writer, now);
  for (std::size_t i = 0; i < readings().own_quantity_count; ++i) {
    writer.add(readings().quantities[i]);
  }
  sensors_.for_each_learned(now, [&](const LearnedSensor& sensor) { writer.add(sensor); });
  writer.add(plane_of(settings_->site));
  if (fleet_) writer.add_fleet(fleet_->save());
  writer.set_edition(learned_edition_);
  state_saver_->save(now);
}

std::int64_t Gateway::time_of_day_s() const {
  return ports_.wall_clock != nullptr ? ports_.wall_clock->seconds() : 0;
}

// None where a clock was not set, then or now.
port::Duration Gateway::time_since(const SavedState& saved) const {
  const std::int64_t now_s = time_of_day_s();
  if (saved.saved_at_s <= 0 || now_s <= saved.saved_at_s) return {};
  return std::chrono::seconds(std::min<std::int64_t>(now_s - saved.saved_at_s, forever_s));
}

bool Gateway::on_reading(UnitIndex unit, const NodeReading& reading,
                         std::span<const Measurement> measured, port::Instant now) {
  presence_.hear_unit(unit, now);
  const NodeRecord* const before = nodes_.at(unit);
  const Serial serial_before = before == nullptr ? Serial::none() : before->serial;
  NodeRecord* const node = admission_.admit(unit, reading.serial, now);
  if (node == nullptr) return false;
  const bool is_renamed = !serial_before.is_none() && serial_before != node->serial;
  if (fleet_ && is_renamed) fleet_->end_clash(serial_before, now);
  if (is_left_to_others(*node, reading, now)) {
    presence_.hear_foreign(*node);
    return true;
  }
  presence_.hear_node(*node, reading, now);
  reading_table_.take(unit, node->serial, measured, now);
  if (node->boot_count != reading.boot_count) {
    node->boot_count = reading.boot_count;
    distributor_.invalidate();
  }
  if (poller_.address_of(unit) == default_unit) {
    assigner_.on_newcomer(poller_.bus_of(unit), reading.serial, now);
  }
  if (node->has_asked_to_leave()) {
    if (node->is_placed()) {
      placement_.leave(*node, "on its own request", generation_ + 1);
    } else {
      placement_.clear_rejection(*node);
    }
    return true;
  }
  placement_.on_still_present(*node);
  // Without a fix the node stays where it was last known to be.
  if ((reading.status & node_status::fix_valid) != 0) follow_position(*node);
  if (fleet_) fleet_->hear(*node, reading_taker_.latest(), now);
  return true;
}

bool Gateway::is_left_to_others(NodeRecord& node, const NodeReading& reading, port::Instant now) {
  return fleet_ && node.is_foreign() && !fleet_->claim(node, reading, now);
}

port::Instant Gateway::request_due(BusIndex bus) const {
  return std::min(assigner_.due(bus), distributor_.due(bus));
}

bool Gateway::next_request(BusIndex bus, port::Instant now, BusRequest& request) {
  is_assigning_[bus.value] = assigner_.due(bus) <= now;
  if (is_assigning_[bus.value]) {
    assigner_.next(bus, request);
    return true;
  }
  return distributor_.next(bus, now, request);
}

void Gateway::on_request_done(BusIndex bus, const port::BusAnswer& answer, port::Instant now) {
  if (!is_assigning_[bus.value]) return distributor_.done(bus, answer, now);
  const AddressAssigner::Answerer answerer = assigner_.done(bus, answer, now);
  if (answerer.unit.is_none()) return;
  if (answerer.is_assigned) move_from_default_unit(bus, answerer.unit);
  poller_.ask_unit_at_once(answerer.unit, now);
}

void Gateway::move_from_default_unit(BusIndex bus, UnitIndex unit) {
  const UnitIndex newcomers = poller_.unit_at(bus, default_unit);
  NodeRecord* const node = nodes_.find(assigner_.last_serial(bus));
  if (node == nullptr || node->unit_index != newcomers) return;
  nodes_.assign_unit(*node, unit);
  poller_.expect_silence(newcomers);
  distributor_.invalidate();
}

void Gateway::follow_position(NodeRecord& node) {
  if (!node.is_placed()) {
    placement_.join(node, generation_ + 1);
    return;
  }
  const std::int64_t band = settings_->poll.dead_band;
  if (squared_distance(node.position, node.placed) > band * band) {
    placement_.move(node, generation_ + 1);
  } else {
    placement_.clear_rejection(node);
  }
}

void Gateway::publish(port::Instant now) {
  const port::Instant started = ports_.clock.now();
  placement_.settle(generation_ + 1);
  static_cast<void>(kept_.take_changed());
  ++generation_;
  changed_ = false;
  if (state_saver_) state_saver_->mark_dirty();
  forget_history();
  list_quarantine(nodes_, kept_.features(), kept_.anchors(), admission_, quarantine_);
  clashes_.list(quarantine_);
  if (fleet_) snapshots_.set_gateways(fleet_->gateways());
  const Snapshot& snapshot = snapshots_.take(generation_, kept_, nodes_, poller_, presence_,
                                             absent_units_.list(), quarantine_, now);
  far_nodes_.look(snapshot, *settings_, now);
  if (file_publisher_) file_publisher_->mark_dirty(snapshot);
  distributor_.take_snapshot();
  if (fleet_) fleet_->take(snapshot, quarantine_);
  state_ = snapshot.state;
  ReadingSnapshot& readings =
      reading_taker_.take(reading_table_, foreign_readings_, nodes_, snapshot, now);
  sensors_.take(snapshot, readings);
  sensors_.mark(readings);
  ports_.server.publish(images_.encode(snapshot, readings));
  // A large mesh takes its time; polling must not wait for it often.
  publish_due_ = now + std::max(publish_pause, publish_share * (ports_.clock.now() - started));
}

void Gateway::forget_history() {
  const Status status = kept_.canonicalize();
  if (status != Status::ok && !keeps_history_) {
    ports_.log.write(port::Level::warning,
                     std::string("the mesh has Steiner vertices that the nodes of today do not "
                                 "need: without them it would not fit (") +
                         explain(status) + "); raise [mesh] steiner_max or vertices_max");
  }
  keeps_history_ = status != Status::ok;
}

void Gateway::publish_readings(port::Instant now) {
  const port::Instant started = ports_.clock.now();
  ReadingSnapshot& readings =
      reading_taker_.take(reading_table_, foreign_readings_, nodes_, snapshot(), now);
  sensors_.mark(readings);
  ports_.server.publish(images_.encode(readings));
  if (file_publisher_ && readings.value_sequence == readings.sequence) {
    file_publisher_->mark_readings_dirty();
  }
  readings_due_ = now + std::max(publish_pause, publish_share * (ports_.clock.now() - started));
}

std::shared_ptr<const port::RegisterImage> empty_image(const Settings& settings) {
  auto image = std::make_shared<port::RegisterImage>();
  ReadingSnapshot readings;
  readings.quantities = quantities_of(settings);
  encode_mesh(Snapshot{}, register_capacity(settings), *image);
  encode_readings(readings, register_capacity(settings), *image);
  return image;
}

}  // namespace etcm::firmware

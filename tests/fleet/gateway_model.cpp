#include "gateway_model.h"

#include <cstdio>
#include <cstdlib>

namespace etcm::test {

namespace {

std::string node_text(const FleetRecord& record) {
  std::string text = std::to_string(record.node.serial.value) + " at ";
  if (record.node.position) {
    text += std::to_string(record.node.position->x) + "," + std::to_string(record.node.position->y);
  }
  text += " of " + record.owner + " " + std::to_string(record.incarnation) + "." +
          std::to_string(record.sequence) + (record.is_heard ? " heard" : " not heard");
  return text;
}

const bool is_verbose = std::getenv("ETCM_FLEET_VERBOSE") != nullptr;

}  // namespace

FleetSettings model_settings(const std::string& name, std::uint64_t instance) {
  FleetSettings settings;
  settings.site = "yard";
  settings.gateway = name;
  settings.instance = instance;
  settings.period = std::chrono::seconds(8);
  settings.silent_after = std::chrono::seconds(25);
  settings.leave_after = std::chrono::seconds(60);
  settings.report_min = std::chrono::seconds(2);
  settings.report_max = std::chrono::seconds(40);
  settings.settle = std::chrono::milliseconds(1500);
  settings.nodes_max = model_nodes_max;
  settings.members_max = 16;
  return settings;
}

std::vector<Position> model_anchors() {
  return {{-2000, -2000}, {2100, 1900}, {-2000, 1800}, {1900, -2100}, {0, 2500}, {2600, 300}};
}

std::vector<FeatureEnds> model_features() {
  return {{VertexId{1}, VertexId{4}}, {VertexId{3}, VertexId{5}}, {VertexId{2}, VertexId{6}}};
}

MeshConfig model_mesh() { return {.vertices_max = 1000, .features_max = 100}; }

GatewayModel::GatewayModel(const FleetSettings& settings, std::uint32_t number, BrokerModel& broker,
                           Random& random, std::size_t side, const MemberClock& clock, Disk& disk,
                           Instant time)
    : settings_(settings),
      number_(number),
      random_(random),
      clock_(clock),
      disk_(disk),
      client_(broker, random, side, clock),
      member_(std::make_unique<FleetMember>(settings_, client_, *this, *this, clock.at(time))),
      mesh_(model_mesh()) {
  for (const Position anchor : model_anchors()) {
    VertexId id;
    if (mesh_->join(anchor, id) != Status::ok) std::abort();
  }
  for (const FeatureEnds& ends : model_features()) {
    FeatureId id;
    if (mesh_->add_feature(ends, id) != Status::ok) std::abort();
  }
  const Instant now = clock_.at(time);
  if (disk_.saved) {
    const std::string wrong = member_->restore(*disk_.saved, now);
    if (!wrong.empty()) write(port::Level::error, "restore: " + wrong);
  }
  for (const Serial serial : disk_.table) table_[serial] = {.at = now, .is_lost = true};
  read_site_file(false, time);
}

void GatewayModel::read_site_file(bool is_changed, Instant time) {
  if (disk_.site_file == 0) return member_->clear_site(clock_.at(time));
  firmware::SiteDocument site{.plane = {.unit = 1}};
  site.anchors = {{.x = static_cast<std::int32_t>(disk_.site_file), .y = 0}};
  member_->set_site(std::move(site), is_changed, clock_.at(time));
}

void GatewayModel::step(const World& world, Instant time) {
  client_.step(time);
  const Instant now = clock_.at(time);
  if (now >= next_poll_) {
    poll(world, clock_.time_of_day(time), now);
    next_poll_ = now + std::chrono::milliseconds(700 + random_.below(500));
  }
  member_->step(now);
  if (client_.is_dead()) return;
  if (now >= next_save_) save(now);
  if (now >= next_mesh_) {
    follow_set();
    next_mesh_ = now + std::chrono::seconds(1 + random_.below(20));
  }
}

void GatewayModel::poll(const World& world, const std::string& time_of_day, Instant now) {
  for (const auto& [serial, node] : world) {
    if ((node.hearers >> number_ & 1) == 0) continue;
    if (node.is_leaving) {
      if (table_.erase(serial) > 0) member_->remove(serial, LeftReason::asked, now);
      continue;
    }
    const bool is_taken = member_->hear(
        {.serial = serial, .position = node.position, .status = 1, .heard_at = time_of_day}, now);
    if (is_taken) table_[serial] = {.at = now};
  }
  for (auto at = table_.begin(); at != table_.end();) {
    const port::Duration silence = now - at->second.at;
    if (silence >= lose_after && !at->second.is_lost) {
      at->second.is_lost = true;
      member_->lose(at->first, now);
    }
    if (silence < remove_after) {
      ++at;
      continue;
    }
    member_->remove(at->first, LeftReason::silent, now);
    at = table_.erase(at);
  }
}

void GatewayModel::save(Instant now) {
  next_save_ = now + std::chrono::milliseconds(500 + random_.below(2000));
  if (!member_->take_news_to_save()) return;
  disk_.saved = member_->save();
  disk_.table.clear();
  for (const auto& [serial, heard] : table_) disk_.table.push_back(serial);
}

// Brings the mesh to the set, by single changes.
void GatewayModel::follow_set() {
  for (auto at = placed_.begin(); at != placed_.end();) {
    const FleetRecord* const record = member_->find(at->first);
    if (record != nullptr && record->node.position) {
      ++at;
      continue;
    }
    if (mesh_->leave(at->second.vertex) != Status::ok) std::abort();
    at = placed_.erase(at);
  }
  // A place may be free only when another node has gone from it.
  for (int round = 0; round < 3; ++round) {
    member_->for_each_node([&](const FleetRecord& record, bool) {
      if (!record.node.position) return;
      const auto at = placed_.find(record.node.serial);
      if (at == placed_.end()) {
        VertexId id;
        if (mesh_->join(*record.node.position, id) == Status::ok) {
          placed_[record.node.serial] = {.vertex = id, .position = *record.node.position};
        }
      } else if (at->second.position != *record.node.position &&
                 mesh_->move(at->second.vertex, *record.node.position) == Status::ok) {
        at->second.position = *record.node.position;
      }
    });
  }
}

std::uint64_t GatewayModel::mesh_hash() {
  follow_set();
  if (mesh_->canonicalize() != Status::ok) return 0;
  return mesh_->hash();
}

std::string GatewayModel::set_text() const {
  std::string text;
  member_->for_each_node(
      [&](const FleetRecord& record, bool) { text += node_text(record) + "\n"; });
  const firmware::SiteDocument* const site = member_->site();
  if (site == nullptr) return text;
  return text + "site " + std::to_string(site->number) + " drawing " +
         std::to_string(site->anchors.front().x) + "\n";
}

std::string GatewayModel::events_text() const {
  std::string text;
  for (const auto& [serial, line] : foreign_) text += line + "\n";
  return text;
}

std::string GatewayModel::visited_text() const {
  std::string text;
  member_->for_each_node([&](const FleetRecord& record, bool is_stale) {
    if (!member_->is_own(record)) text += node_text(record) + (is_stale ? " stale\n" : "\n");
  });
  return text;
}

void GatewayModel::on_node(const FleetRecord& record, bool is_stale, Instant) {
  foreign_[record.node.serial] = node_text(record) + (is_stale ? " stale" : "");
}

void GatewayModel::on_node_gone(Serial serial, LeftReason, Instant) { foreign_.erase(serial); }

void GatewayModel::on_name_conflict(bool is_conflict, bool is_read_only, Instant) {
  has_conflict_ = is_conflict;
  is_read_only_ = is_read_only;
}

std::string GatewayModel::on_site(const firmware::SiteDocument&, Instant) { return ""; }

void GatewayModel::write(port::Level, std::string_view line) {
  if (is_verbose) {
    std::printf("%s#%u: %.*s\n", settings_.gateway.c_str(), number_, static_cast<int>(line.size()),
                line.data());
  }
}

}  // namespace etcm::test

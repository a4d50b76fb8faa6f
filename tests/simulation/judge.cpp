#include "judge.h"

#include <algorithm>
#include <array>
#include <utility>
#include <vector>

#include "etcm/audit.h"
#include "etcm/config.h"
#include "etcm/traverse.h"

namespace etcm::simulation {

using namespace std::chrono_literals;

namespace {

// So often a unit answers that had another serial before it is believed.
constexpr std::uint32_t sightings = 3;
// The blocks of one sweep follow each other.
constexpr Duration sweep_max = 15s;
// Where some of its answers are spoilt in between.
constexpr std::uint32_t sightings_max = 12;
// What is to be told, from when on it is so.
constexpr Duration told_within = 10s;
// So many places are remembered of a node.
constexpr std::size_t said_max = 2000;

std::string name_of(const firmware::NodeRecord& node) {
  return "node " + std::to_string(node.serial.value);
}

std::string text_of(Position place) {
  return "(" + std::to_string(place.x) + ", " + std::to_string(place.y) + ")";
}

double seconds_of(Duration time) { return std::chrono::duration<double>(time).count(); }

}  // namespace

void Judge::begin(GatewayRun& run, Instant now) {
  began_ = now;
  is_to_look_at_places_ = true;
  // What no disk took is not known any more.
  if (site_.disk.is_behind()) generation_ = 0;
  for (auto& [serial, seen] : seen_) {
    seen.positioned_at = {};
    seen.missing_from.reset();
    seen.missing_at = port::never;
  }
  for (const firmware::NodeRecord& node : run.gateway().nodes().records()) {
    if (node.is_known()) seen_[node.serial.value].positioned_at = node.positioned_at;
  }
}

void Judge::finish(const GatewayRun& run) {
  alarms_.clear();
  if (others_ != nullptr || !site_.disk_of_alarms.has_all()) return;
  const firmware::AlarmBook& book = run.alarms();
  for (std::uint32_t i = 0; i < book.open_count(); ++i) {
    if (book.open(i).is_on) alarms_.push_back(book.open(i));
  }
}

std::string Judge::look_at_kept_alarms(const GatewayRun& run) {
  for (const firmware::Alarm& kept : std::exchange(alarms_, {})) {
    const firmware::Alarm* const alarm = run.alarms().find_on(kept.key);
    if (alarm == nullptr || alarm->number != kept.number) {
      return "an alarm has not outlived the restart: " + std::string(kept.text());
    }
  }
  return {};
}

std::string Judge::look(GatewayRun& run, Instant now) {
  std::string wrong = look_at_nodes(run, now);
  if (wrong.empty() && std::exchange(is_to_look_at_places_, false)) wrong = look_at_places(run);
  if (!wrong.empty()) return wrong;
  looked_at_ = now;
  const std::uint32_t generation = run.gateway().generation();
  if (generation < generation_) {
    return "generation " + std::to_string(generation) + " comes after " +
           std::to_string(generation_);
  }
  if (generation != generation_) {
    generation_ = generation;
    ++generations;
    is_to_look_at_ = true;
    published_at_ = now;
  }
  if (!is_to_look_at_) return {};
  // A change may have come in the same step, and is in the next generation; of two nodes at one
  // place the other one may be in the mesh by then, which stays as it is.
  const bool has_news = run.gateway().is_late(now, -24h);
  if (has_news || run.gateway().snapshot().mesh_hash != run.mesh().hash()) {
    return now - published_at_ > 10s ? "the snapshot is of another mesh for " +
                                           std::to_string(seconds_of(now - published_at_)) + " s"
                                     : std::string();
  }
  is_to_look_at_ = false;
  return look_at_mesh(run);
}

std::string Judge::look_at_nodes(GatewayRun& run, Instant now) {
  std::string unknown = look_for_unknown(run, now);
  if (!unknown.empty()) return unknown;
  for (const firmware::NodeRecord& node : run.gateway().nodes().records()) {
    if (!node.is_known()) continue;
    std::string wrong = node.is_foreign() ? look_at_foreign(node) : look_at_node(node, run, now);
    if (wrong.empty() && !node.is_foreign()) wrong = look_at_alarm(node, run, now);
    if (!wrong.empty()) return name_of(node) + ": " + wrong;
  }
  return {};
}

std::string Judge::look_at_alarm(const firmware::NodeRecord& node, GatewayRun& run, Instant now) {
  Instant& missing_at = seen_[node.serial.value].missing_at;
  if (!node.is_missing) {
    missing_at = port::never;
    return {};
  }
  missing_at = std::min(missing_at, now);
  const bool is_told =
      run.alarms().is_on({.kind = firmware::AlarmKind::missing_node, .subject = node.serial.value});
  return is_told || now - missing_at <= told_within ? std::string()
                                                    : "is missing, and no alarm tells it";
}

// What is wrong then is what somebody has drawn, where there is no room, or of another gateway.
std::string Judge::look_at_alarms_at_rest(GatewayRun& run) {
  using enum firmware::AlarmKind;
  constexpr std::array may_be_on{unheard_end, refused_feature, refused_node,    far_node,
                                 other_mesh,  refused_anchor,  rejected_gateway};
  const firmware::AlarmBook& book = run.alarms();
  for (std::uint32_t i = 0; i < book.open_count(); ++i) {
    const firmware::Alarm& alarm = book.open(i);
    if (!alarm.is_on || std::ranges::find(may_be_on, alarm.key.kind) != may_be_on.end()) continue;
    return "at rest, an alarm is on: " + std::string(alarm.text());
  }
  return {};
}

std::string Judge::look_at_places(GatewayRun& run) {
  for (const firmware::NodeRecord& node : run.gateway().nodes().records()) {
    if (!node.is_known() || node.is_foreign() || !node.has_position()) continue;
    const Device* const device = site_.find(node.serial.value);
    Seen& seen = seen_[node.serial.value];
    if (device == nullptr || seen.is_mixture) continue;
    // Who does not know its unit does not know that it counts in what the plane counts in; and whom
    // the mesh cannot move stays where it was, and is saved so.
    const bool can_move =
        site_.is_asked(*device) && !node.last_unit.is_none() && !node.is_quarantined();
    seen.was_left_behind = seen.was_left_behind || (device->make != Make::ours && !can_move);
    if (seen.was_left_behind) continue;
    const std::optional<Position> said = site_.said_for(*device, node.position);
    if (!said || std::ranges::find(seen.said, *said) == seen.said.end()) {
      return name_of(node) + ": is believed at " + text_of(node.position) + ", which it never said";
    }
  }
  return {};
}

std::string Judge::look_at_foreign(const firmware::NodeRecord& node) const {
  if (others_ != nullptr && others_->neighbour().has_told(node.serial.value, node.position)) {
    return {};
  }
  return "another gateway has it at " + text_of(node.position) + ", which none has said";
}

std::string Judge::look_for_unknown(GatewayRun& run, Instant now) {
  const auto records = run.gateway().nodes().records();
  const auto known = std::count_if(
      records.begin(), records.end(),
      [](const firmware::NodeRecord& node) { return node.is_known() && !node.is_foreign(); });
  // There is room for so many that have gone from their units, and no more.
  if (static_cast<std::size_t>(known) > run.gateway().poller().unit_count()) return {};
  for (const auto& device : site_.devices) {
    const bool has_told = device->answers > sightings_max && settled_at(*device, run) <= now &&
                          device->answered_at > began_ && !device->is_leaving;
    if (!has_told || device->is_replaced) continue;
    const bool is_known = run.gateway().nodes().find(firmware::Serial{device->serial}) != nullptr;
    if (!is_known && !site_.is_doubled(*device)) {
      return "node " + std::to_string(device->serial) + " answers, and is not known";
    }
  }
  return {};
}

// The silence of who was there instead begins anew with each trouble of the bus, and when the first
// of all that were unplugged is heard again.
Instant Judge::settled_at(const Device& device, GatewayRun& run) const {
  if (!device.had_twin) return device.undisturbed_since;
  const auto& poll = run.gateway().settings().poll;
  const Duration silence = poll.leave_after + 10s + (sightings + 1) * poll.interval;
  return silence + std::max(device.undisturbed_since, site_.buses[device.bus].undisturbed_since);
}

bool Judge::may_be_two(const Device& device, Instant now) const {
  return site_.is_doubled(device) || (device.had_twin && device.undisturbed_since > now);
}

std::string Judge::look_at_node(const firmware::NodeRecord& node, GatewayRun& run, Instant now) {
  const Device* const device = site_.find(node.serial.value);
  Seen& seen = seen_[node.serial.value];
  if (device == nullptr) {
    // Of two of another make at one address, one block may be taken for the other.
    for (const auto& each : site_.devices) {
      if (each->make != Make::ours && may_be_two(*each, now)) seen.is_mixture = true;
    }
    return seen.is_mixture ? std::string() : "there is none";
  }
  const BusWorld& bus = site_.buses[device->bus];
  if (seen.positioned_at != node.positioned_at) {
    seen.positioned_at = node.positioned_at;
    if (!node.has_position()) return {};
    ++positions;
    positions_of_others += device->make != Make::ours;
    seen.accepted_at = now;
    const bool are_two = may_be_two(*device, now);
    // What comes late of one of two, to a question that the other has answered, nobody can tell
    // from an answer to the next one.
    const Instant last = bus.asked_at(device->unit, now);
    const Instant asked = are_two ? std::min(last, device->second_to) : last;
    // On a line without numbers an answer counts in its time alone; behind a converter the gateway
    // learns to wait for longer, and knows to which question it belongs. Where another one answered
    // at the same unit, what came late of this one may have been taken for the next answer.
    const bool is_clear = bus.line && device->undisturbed_since <= now && !bus.line->has_noise &&
                          bus.undisturbed_since + 1s < now && device->ailment != Ailment::torn &&
                          !site_.is_doubled(*device);
    if (is_clear && device->answered_at <= looked_at_) {
      return "a position is accepted, and no answer to the last question came in its time";
    }
    const bool is_in_blocks = device->make != Make::ours;
    if (is_in_blocks && asked >= began_ && now - asked > sweep_max) {
      return "a position is accepted, and its first block was asked for " +
             std::to_string(seconds_of(now - asked)) + " s ago";
    }
    // Of who moves between two blocks, and has not said how fast, each coordinate counts for
    // itself; of two at one address either may say one block.
    const std::optional<Position> said = site_.said_for(*device, node.position);
    const bool was_there =
        said && (device->make == Make::in_blocks ? device->held_apart(*said, asked)
                                                 : device->held(*said, asked));
    if (!said) {
      seen.is_mixture = true;
    } else if (seen.said.empty() || seen.said.back() != *said) {
      if (seen.said.size() == said_max) seen.said.erase(seen.said.begin());
      seen.said.push_back(*said);
    }
    if (!was_there && !(is_in_blocks && are_two)) {
      return "position " + text_of(node.position) + " is accepted, and it was at " +
             text_of(site_.in_mesh(*device, device->place())) + " when it was asked " +
             std::to_string(seconds_of(now - asked)) + " s ago";
    }
  }
  const auto& poll = run.gateway().settings().poll;
  const Instant accepted_at = seen.accepted_at;
  if (node.is_placed() && !node.stale &&
      now - std::max(accepted_at, fresh_from_) > poll.stale_after + 10s) {
    return "is not stale, and told its position " + std::to_string(seconds_of(now - accepted_at)) +
           " s ago";
  }
  const bool is_judged = node.is_missing && !bus.is_out_of_order() &&
                         device->answered_at > began_ && !device->is_leaving &&
                         !site_.is_doubled(*device) && settled_at(*device, run) <= now;
  const bool is_news = node.is_missing && !seen.missing_from;
  if (!node.is_missing) seen.missing_from.reset();
  // Those answers count that come once it is alone, however seldom it answers.
  if (is_news || (node.is_missing && !is_judged)) seen.missing_from = device->answers;
  const bool has_answered = is_news ? now - device->answered_at + 100ms < poll.leave_after
                                    : is_judged && device->answers > *seen.missing_from + sightings;
  if (is_judged && device->answers > sightings && has_answered) {
    return "is missing, and answered " + std::to_string(seconds_of(now - device->answered_at)) +
           " s ago";
  }
  const Instant since = std::max({device->undisturbed_since, began_, bus.undisturbed_since});
  const bool is_old = node.has_position() && now - accepted_at > site_.age_max(*device);
  if (!is_old && !node.stale) return {};
  const bool is_well =
      site_.is_asked(*device) && !bus.is_out_of_order() && !site_.is_doubled(*device) &&
      !device->is_replaced && device->is_plugged_in && !device->is_leaving &&
      device->ailment == Ailment::none && now - since > site_.found_again_within(device->bus);
  if (is_well && is_old) {
    return "is well, and told its position " + std::to_string(seconds_of(now - accepted_at)) +
           " s ago";
  }
  if (is_well && node.stale && site_.spoilt_by_others(*device) == 0) {
    return "is stale, and nothing has been wrong with it for " +
           std::to_string(seconds_of(now - since)) + " s";
  }
  return {};
}

std::string Judge::look_at_mesh(GatewayRun& run) {
  const Mesh& mesh = run.mesh();
  if (!audit(mesh)) return "the mesh is none";
  const firmware::Snapshot& snapshot = run.gateway().snapshot();
  // What is published is what is known, in both directions.
  std::size_t shown = 0;
  for (const firmware::SnapshotVertex& vertex : snapshot.vertices) {
    if (vertex.kind != VertexKind::node || vertex.is_anchor) continue;
    ++shown;
    const firmware::NodeRecord* const node = run.gateway().nodes().find(vertex.serial);
    if (node == nullptr || !node->is_placed()) {
      return "node " + std::to_string(vertex.serial.value) + " is shown and not known";
    }
    if (vertex.point != to_point(node->placed)) return name_of(*node) + " is shown elsewhere";
    if (!node->is_quarantined() && !node->lacks_fix && node->placed != node->position &&
        !node->leave_rejected) {
      return name_of(*node) + " is placed at " + text_of(node->placed) + " and stands at " +
             text_of(node->position);
    }
  }
  std::size_t placed = 0;
  for (const firmware::NodeRecord& node : run.gateway().nodes().records()) {
    placed += node.is_known() && node.is_placed();
  }
  if (placed != shown || snapshot.node_count != shown) {
    return std::to_string(placed) + " nodes are in the mesh, " + std::to_string(shown) + " shown";
  }
  return compare_with_build(run);
}

std::string Judge::compare_with_build(GatewayRun& run) {
  const Mesh& mesh = run.mesh();
  if (!mesh.is_canonical() || mesh.unresolved()) return {};
  ++rebuilt;
  std::vector<Position> places;
  std::vector<VertexId> id_of(mesh.vertex_id_end());
  for (const VertexId node : nodes_of(mesh)) {
    places.push_back(mesh.position(node));
    id_of[node.value] = VertexId{static_cast<IdValue>(places.size())};
  }
  std::vector<FeatureEnds> segments;
  for (const FeatureId feature : features_of(mesh)) {
    const FeatureEnds ends = mesh.ends(feature);
    segments.push_back({id_of[ends.from.value], id_of[ends.to.value]});
  }
  MeshConfig config = mesh.config();
  config.vertices_max = std::max<std::uint32_t>(4 * config.vertices_max, 200);
  std::vector<std::byte> memory(storage_bytes(config));
  Mesh other;
  if (other.open(memory, config) != Status::ok) return "no room for another mesh";
  const Status status = other.build(places, segments);
  if (status != Status::ok) return std::string("build() of it answers ") + to_string(status);
  return other.hash() == mesh.hash() ? std::string() : "build() makes another mesh of its nodes";
}

std::string Judge::look_at_rest(GatewayRun& run) {
  firmware::Gateway& gateway = run.gateway();
  std::size_t known = 0;
  for (const auto& device : site_.devices) {
    if (device->is_replaced) continue;
    const firmware::NodeRecord* const node = gateway.nodes().find(firmware::Serial{device->serial});
    const std::string name = "at rest, node " + std::to_string(device->serial);
    if (node == nullptr) return name + " is not known";
    ++known;
    if (node->is_missing) return name + " is missing";
    if (node->stale) return name + " is stale";
    const Position place = site_.in_mesh(*device, device->place());
    if (node->position != place) return name + " is believed elsewhere";
    const bool has_room =
        !site_.is_small && gateway.settings().mesh.vertices_max > site_.devices.size();
    if (node->is_quarantined() && (!has_room || gateway.settings().work_max > 0)) continue;
    if (!node->is_placed()) return name + " is not in the mesh";
    if (node->placed != place) return name + " is placed elsewhere";
  }
  for (const firmware::NodeRecord& node : gateway.nodes().records()) {
    if (node.is_known() && !node.is_foreign() && --known + 1 == 0)
      return "at rest, " + name_of(node) + " is still known";
  }
  // All have moved since.
  if (site_.disk.is_behind() || site_.disk.saved_at() <= site_.faults_ended_at) {
    return "at rest, the disk has another state";
  }
  std::string wrong = look_at_alarms_at_rest(run);
  return wrong.empty() ? look_at_mesh(run) : wrong;
}

}  // namespace etcm::simulation

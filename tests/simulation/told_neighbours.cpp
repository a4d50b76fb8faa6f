#include "told_neighbours.h"

#include <utility>

#include "etcm/traverse.h"

namespace etcm::simulation {

namespace {

std::string text_of(const std::set<std::uint32_t>& serials) {
  std::string text;
  for (const std::uint32_t serial : serials) text += " " + std::to_string(serial);
  return text.empty() ? " nobody" : text;
}

}  // namespace

ToldNeighbours::Lists ToldNeighbours::lists_of(GatewayRun& run) {
  const Mesh& mesh = run.mesh();
  std::map<std::uint32_t, std::uint32_t> serial_of;  // by id of its vertex
  Lists lists;
  for (const firmware::NodeRecord& node : run.gateway().nodes().records()) {
    if (!node.is_known() || !node.is_placed()) continue;
    serial_of[node.vertex.value] = node.serial.value;
    lists[node.serial.value];
  }
  const auto join = [&](VertexId one, VertexId other) {
    const auto from = serial_of.find(one.value), to = serial_of.find(other.value);
    if (from == serial_of.end() || to == serial_of.end()) return;
    lists[from->second].insert(to->second);
    lists[to->second].insert(from->second);
  };
  for (const MeshEdge edge : edges_of(mesh)) join(edge.from, edge.to);
  // Vertices on the way have no serial.
  for (const FeatureId feature : features_of(mesh)) {
    join(mesh.ends(feature).from, mesh.ends(feature).to);
  }
  return lists;
}

std::string ToldNeighbours::look(GatewayRun& run, Instant now) {
  for (const auto& device : site_.devices) {
    if (!device->told || !std::exchange(device->told->is_news, false)) continue;
    const firmware::NodeRecord* const node =
        run.gateway().nodes().find(firmware::Serial{device->serial});
    // Who stands where another one stood is told that one's until it is heard.
    const bool is_heard_there = node != nullptr && !node->unit_index.is_none();
    if (!is_heard_there || !node->is_placed() || site_.is_doubled(*device)) continue;
    // Changes that are not published yet are in the next generation.
    const bool is_of_now = !run.gateway().is_late(now, std::chrono::hours(-24)) &&
                           device->told->generation == run.gateway().generation() &&
                           run.gateway().snapshot().mesh_hash == run.mesh().hash();
    if (!is_of_now) continue;
    const auto expected = lists_of(run)[device->serial];
    if (device->told->serials != expected) {
      return "node " + std::to_string(device->serial) + " is told that its neighbours are" +
             text_of(device->told->serials) + ", and they are" + text_of(expected);
    }
    ++lists_;
  }
  return {};
}

std::string ToldNeighbours::look_at_rest(GatewayRun& run) {
  Lists lists = lists_of(run);
  for (const auto& device : site_.devices) {
    if (device->is_replaced || !lists.contains(device->serial)) continue;
    // Others may wait there too, who would take it for theirs.
    if (device->unit == newcomers_unit) continue;
    const std::string name = "at rest, node " + std::to_string(device->serial);
    const auto& expected = lists[device->serial];
    if (!device->told) return name + " has been told of no neighbours";
    if (device->told->serials != expected) {
      return name + " believes that its neighbours are" + text_of(device->told->serials) +
             ", and they are" + text_of(expected);
    }
  }
  return {};
}

}  // namespace etcm::simulation

#include "bench/work_table.h"

#include <algorithm>
#include <chrono>
#include <cstdint>
#include <functional>
#include <iomanip>
#include <map>
#include <ostream>
#include <string>
#include <vector>

#include "inputs/owned_mesh.h"
#include "inputs/patterns.h"
#include "inputs/random.h"
#include "inputs/random_graph.h"

namespace etcm::bench {
namespace {

using inputs::Graph;
using inputs::OwnedMesh;

struct UnitTimes {
  std::vector<double> nanoseconds;  // a unit, one for each call
  std::uint64_t most = 0;           // units of a call
  double worst = 0;                 // nanoseconds a unit, of calls that are not small
};

class WorkTable {
 public:
  template <class Call>
  Status measure(const std::string& kind, Mesh& mesh, const Call& call) {
    const auto start = std::chrono::steady_clock::now();
    const Status status = call();
    const double nanoseconds =
        std::chrono::duration<double, std::nano>(std::chrono::steady_clock::now() - start).count();
    const std::uint64_t units = mesh.work_needed().units;
    if (units == 0) return status;
    UnitTimes& times = kinds_[kind];
    const double each = nanoseconds / static_cast<double>(units);
    times.nanoseconds.push_back(each);
    times.most = std::max(times.most, units);
    if (units >= 1000) times.worst = std::max(times.worst, each);
    return status;
  }

  void print(std::ostream& out) {
    out << "| call | calls | most units | ns a unit, median | at worst, of 1000 units and more |\n"
           "|---|---:|---:|---:|---:|\n";
    for (auto& [kind, times] : kinds_) {
      std::sort(times.nanoseconds.begin(), times.nanoseconds.end());
      out << "| " << kind << " | " << times.nanoseconds.size() << " | " << times.most << " | "
          << std::fixed << std::setprecision(1) << times.nanoseconds[times.nanoseconds.size() / 2]
          << " | ";
      if (times.worst > 0) out << times.worst;
      out << " |\n";
    }
  }

 private:
  std::map<std::string, UnitTimes> kinds_;
};

void change(WorkTable& table, Mesh& mesh, const Graph& graph, inputs::Random& random) {
  constexpr int calls = 200;
  for (int i = 0; i < calls; ++i) {
    const Position& near = graph.nodes[random.index(graph.nodes.size())];
    const auto beside = [&] {
      return Position{near.x + random.between(-50, 50), near.y + random.between(-50, 50)};
    };
    VertexId id;
    const Position place = beside(), next = beside();
    if (table.measure("join", mesh, [&] { return mesh.join(place, id); }) != Status::ok) continue;
    static_cast<void>(table.measure("move", mesh, [&] { return mesh.move(id, next); }));
    static_cast<void>(
        table.measure("refused join", mesh, [&] { return mesh.join(place, id, Work{200}); }));
    const VertexId node = inputs::vertex_of(random.index(graph.nodes.size()));
    FeatureId feature;
    const Status added = table.measure("add_feature", mesh, [&] {
      return mesh.add_feature({id, node}, feature);
    });
    if (added == Status::ok) {
      static_cast<void>(
          table.measure("remove_feature", mesh, [&] { return mesh.remove_feature(feature); }));
    }
    static_cast<void>(table.measure("leave", mesh, [&] { return mesh.leave(id); }));
    static_cast<void>(table.measure("canonicalize", mesh, [&] { return mesh.canonicalize(); }));
  }
}

}  // namespace

bool print_work_table(std::ostream& out) {
  WorkTable table;
  inputs::Random random(1);
  for (const Graph& graph :
       {inputs::random_graph(1000, inputs::FeatureLength::in_reach, 1),
        inputs::random_graph(1000, inputs::FeatureLength::any, 1),
        inputs::parallels(60, 100, 100'000, 100, 3), inputs::fan({200, 1800, 10'000, 90'000}),
        inputs::grid(30, 100, inputs::GridFeatures::knight_moves, 5)}) {
    MeshConfig config = inputs::config_for(graph, 40'000);
    config.features_max += 1000;
    OwnedMesh mesh(config);
    const Status built =
        table.measure("build", *mesh, [&] { return mesh->build(graph.nodes, graph.features); });
    if (built != Status::ok) return false;
    change(table, *mesh, graph, random);
    static_cast<void>(table.measure("rebuild", *mesh, [&] { return mesh->rebuild(); }));
  }
  table.print(out);
  return true;
}

}  // namespace etcm::bench

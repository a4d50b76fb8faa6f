#include "bench/fewer_table.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdint>
#include <iomanip>
#include <map>
#include <optional>
#include <ostream>
#include <sstream>
#include <string>
#include <vector>

#include "bench/cgal_peer.h"
#include "bench/limited.h"
#include "etcm/audit.h"
#include "etcm/bound.h"
#include "inputs/owned_mesh.h"
#include "inputs/patterns.h"
#include "inputs/random_graph.h"

namespace etcm::bench {
namespace {

using Clock = std::chrono::steady_clock;

constexpr std::chrono::seconds peer_limit{20};
constexpr std::chrono::seconds our_limit{200};
constexpr std::size_t steiner_room = 200'000;
// What `etcm mesh --effort 9` makes for each Steiner vertex, and three times as many for what is
// taken for the best there is.
constexpr std::uint32_t trials_each = 700;
constexpr std::uint32_t trials_each_for_best = 2100;
constexpr int warm_runs = 5;
// Between two looks at the clock.
constexpr std::uint32_t trials_at_once = 40;

struct Entry {
  std::string family;
  inputs::Graph graph;
};

// Seeds that appear nowhere else.
std::vector<Entry> held_out() {
  std::vector<Entry> entries;
  for (std::uint64_t seed = 901; seed <= 906; ++seed) {
    entries.push_back(
        {"random long", inputs::random_graph(1000, inputs::FeatureLength::any, seed)});
  }
  for (std::uint64_t seed = 911; seed <= 914; ++seed) {
    entries.push_back({"random long", inputs::random_graph(200, inputs::FeatureLength::any, seed)});
  }
  for (std::uint64_t seed = 921; seed <= 924; ++seed) {
    entries.push_back(
        {"random short", inputs::random_graph(1000, inputs::FeatureLength::in_reach, seed)});
  }
  for (std::uint64_t seed = 931; seed <= 932; ++seed) {
    entries.push_back({"clusters", inputs::random_clusters(12, 50, seed)});
  }
  for (std::uint64_t seed = 941; seed <= 944; ++seed) {
    const auto turn = static_cast<std::size_t>(seed - 941);
    entries.push_back(
        {"parallels", inputs::parallels(2 + 3 * turn, 7, 100'000, 60 * (turn + 1), seed)});
  }
  entries.push_back({"polygon", inputs::random_polygon(250, 951)});
  return entries;
}

double milliseconds_since(Clock::time_point start) {
  return std::chrono::duration<double, std::milli>(Clock::now() - start).count();
}

struct Peer {
  std::size_t added;
  double milliseconds;
};

std::optional<Peer> measure_peer([[maybe_unused]] const inputs::Graph& graph) {
#ifdef ETCM_WITH_CGAL
  return run_limited(peer_limit, [&] {
    // The fastest of some, for caches and the heap are cold at first.
    Peer fastest{0, 1e9};
    for (int i = 0; i < warm_runs; ++i) {
      const auto start = Clock::now();
      fastest.added = cgal_conforming(graph) - graph.nodes.size();
      fastest.milliseconds = std::min(fastest.milliseconds, milliseconds_since(start));
    }
    return fastest;
  });
#else
  return std::nullopt;
#endif
}

struct Ours {
  std::uint32_t least;    // no mesh has fewer
  std::uint32_t built;    // as build() makes it
  std::uint32_t in_time;  // with the search for as long as the peer takes
  std::uint32_t effort;   // with trials_each
  double effort_ms;
  std::uint32_t best;
  bool is_good;
};

std::uint32_t least_of(const inputs::Graph& graph) {
  inputs::OwnedMesh nodes(inputs::config_for(graph, 0));
  if (nodes->build(graph.nodes, {}) != Status::ok) return 0;
  std::uint32_t sum = 0;
  for (const FeatureEnds& feature : graph.features) sum += least_steiner(*nodes, feature);
  return sum;
}

Ours measure_ours(const inputs::Graph& graph, double peer_ms) {
  Ours ours{};
  ours.least = least_of(graph);
  inputs::OwnedMesh mesh(inputs::config_for(graph, steiner_room));
  for (int i = 1; i < warm_runs; ++i) {
    static_cast<void>(mesh->build(graph.nodes, graph.features));
    mesh->clear();
  }
  const auto start = Clock::now();
  ours.is_good = mesh->build(graph.nodes, graph.features) == Status::ok;
  ours.built = mesh->steiner_count();
  for (std::uint32_t first = 0; milliseconds_since(start) < peer_ms; first += trials_at_once) {
    if (mesh->optimise(trials_at_once, first) != Status::ok) break;
  }
  ours.in_time = mesh->steiner_count();
  ours.is_good = ours.is_good && audit(*mesh) && mesh->canonicalize() == Status::ok;

  const auto effort_start = Clock::now();
  const std::uint32_t trials = ours.built * trials_each;
  ours.is_good = ours.is_good && mesh->optimise(trials) == Status::ok;
  ours.effort_ms = milliseconds_since(effort_start);
  ours.effort = mesh->steiner_count();
  ours.is_good = ours.is_good && audit(*mesh) &&
                 mesh->optimise(ours.built * trials_each_for_best - trials, trials) == Status::ok;
  ours.best = mesh->steiner_count();
  ours.is_good = ours.is_good && audit(*mesh);
  return ours;
}

std::string decimal(double value, int digits) {
  std::ostringstream text;
  text << std::fixed << std::setprecision(digits) << value;
  return text.str();
}

// As in the other table, with one added to both.
double ratio(std::size_t ours, std::size_t peer) {
  return (static_cast<double>(ours) + 1) / (static_cast<double>(peer) + 1);
}

struct Means {
  double built = 0;
  double in_time = 0;
  double effort = 0;
  int rows = 0;
};

}  // namespace

bool print_fewer_table(std::ostream& out) {
  out << "| family | input | no fewer than | CGAL | build() | / CGAL | in CGAL's time | / CGAL | "
         "effort 9 | / CGAL | s | best known |\n"
         "|---|---|---:|---:|---:|---:|---:|---:|---:|---:|---:|---:|\n";
  std::map<std::string, Means> means;
  bool all_good = true;
  for (const auto& [family, graph] : held_out()) {
    const auto peer = measure_peer(graph);
    const auto ours =
        run_limited(our_limit, [&] { return measure_ours(graph, peer ? peer->milliseconds : 0); });
    if (!ours || !ours->is_good) {
      out << "| " << family << " | " << graph.name << " | failed |" << std::endl;
      all_good = false;
      continue;
    }
    const auto against_peer = [&](std::uint32_t count) {
      return peer ? decimal(ratio(count, peer->added), 3) : "-";
    };
    out << "| " << family << " | " << graph.name << " | " << ours->least << " | "
        << (peer ? std::to_string(peer->added) : "fails") << " | " << ours->built << " | "
        << against_peer(ours->built) << " | " << ours->in_time << " | "
        << against_peer(ours->in_time) << " | " << ours->effort << " | "
        << against_peer(ours->effort) << " | " << decimal(ours->effort_ms / 1000, 1) << " | "
        << ours->best << " |" << std::endl;
    if (!peer) continue;
    Means& mean = means[family];
    mean.built += std::log(ratio(ours->built, peer->added));
    mean.in_time += std::log(ratio(ours->in_time, peer->added));
    mean.effort += std::log(ratio(ours->effort, peer->added));
    ++mean.rows;
  }
  out << "\n| family | build() / CGAL | in CGAL's time | effort 9 |\n|---|---:|---:|---:|\n";
  for (const auto& [family, mean] : means) {
    out << "| " << family << " | " << decimal(std::exp(mean.built / mean.rows), 3) << " | "
        << decimal(std::exp(mean.in_time / mean.rows), 3) << " | "
        << decimal(std::exp(mean.effort / mean.rows), 3) << " |\n";
  }
  return all_good;
}

}  // namespace etcm::bench

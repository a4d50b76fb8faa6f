// How many instructions each public call takes, with 200 nodes and 20 features between any two of
// them: the median and the most on random input, and the most on inputs that a search found. One
// line a call; cost.py makes the tables of lib/docs/cost.md of them. Leaves with 1 where a call
// takes more than its work allows, or where the hook comes too late.
//
// With ETCM_COST_SEARCH, a count of inputs, it is the search: it tries as many and tells which are
// the worst of each call.
#include <array>
#include <cstdint>
#include <span>
#include <type_traits>

#include "board/instructions.h"
#include "console.h"
#include "cost_inputs.h"
#include "cost_memory.h"
#include "cost_row.h"
#include "etcm/analysis.h"
#include "etcm/audit.h"
#include "etcm/bound.h"
#include "etcm/domain.h"
#include "etcm/dry_run.h"
#include "etcm/handles.h"
#include "etcm/incidence.h"
#include "etcm/locate.h"
#include "etcm/nearest.h"
#include "etcm/predicates.h"
#include "etcm/storage.h"
#include "etcm/traverse.h"

namespace {

using namespace etcm;
using inputs::Random;
using test::Kind;
using test::put;
using test::Row;

constexpr std::uint32_t rounds = 12;
constexpr std::uint32_t many = 800;
constexpr std::uint32_t random_inputs = 4;
// Inputs that the search found to be the worst of a call.
constexpr std::uint32_t kept[] = {ETCM_COST_KEPT};

MeshStorage<900, 120> storage;
Mesh mesh;
test::CostInput input;
std::array<FeatureEnds, test::cost_feature_count> features;
test::InstructionClock timer;
std::uint32_t seed = 0;
bool is_random = true;
bool is_right = true;
volatile std::uint64_t seen;
std::array<Region, 2 * 900> region;
// What a call is given to read or write; one at a time.
alignas(8) std::array<std::byte, 700 * sizeof(SteinerPlace)> memory;
template <class T>
std::span<T> as() {
  return {reinterpret_cast<T*>(memory.data()), memory.size() / sizeof(T)};
}

template <class Call>
auto measure(Row& row, const Call& call) {
  timer.start();
  const auto answer = call();
  timer.stop();
  bool is_done = true;
  if constexpr (std::is_same_v<decltype(answer), const Status>) is_done = answer == Status::ok;
  row.take({timer.instructions(), timer.longest(),
            row.kind == Kind::change ? mesh.work_needed().units : 0, seed, is_random && is_done});
  return answer;
}

Row opening{"open", Kind::question}, clearing{"clear", Kind::question}, build{"build"},
    restore{"restore"}, rebuild{"rebuild"}, canonicalize{"canonicalize"},
    optimise{"optimise, 10 trials"}, join{"join"}, leave{"leave"}, move{"move"},
    add_feature{"add_feature"}, remove_feature{"remove_feature"},
    dry_join{"DryRun::join", Kind::read}, dry_leave{"DryRun::leave", Kind::read},
    dry_move{"DryRun::move", Kind::read}, dry_add{"DryRun::add_feature", Kind::read},
    dry_remove{"DryRun::remove_feature", Kind::read}, find{"locate", Kind::question},
    nearest{"nearest_node", Kind::read}, nearer{"nearest_nodes, ten", Kind::read},
    within{"nodes_within, ten", Kind::read}, around{"neighbours", Kind::question},
    along{"chain", Kind::question}, at_node{"features_at", Kind::question},
    of_edge{"feature_between", Kind::question}, ways{"edges_of, all", Kind::question},
    hull{"finite_triangle_count", Kind::question}, at_vertex{"links_at", Kind::question},
    hash{"hash", Kind::read}, proof{"audit", Kind::read}, sealing{"seal", Kind::read},
    attaching{"attach", Kind::read}, copied{"attach_copy", Kind::question},
    reading{"MeshReader::attach", Kind::question}, saving{"save", Kind::read}, loading{"load"},
    least{"least_steiner", Kind::question}, labels{"label_domain", Kind::read},
    edges{"links", Kind::read}, network{"connectivity", Kind::read}, relay{"relays", Kind::read},
    gaps{"barrier_gaps", Kind::read}, holes{"coverage_holes", Kind::read},
    between{"interpolate", Kind::question}, circles{"incircle, a hundred", Kind::question},
    build_alone{"build, nodes alone"}, join_alone{"join, nodes alone"},
    leave_alone{"leave, nodes alone"}, join_many{"join, 800 nodes alone"},
    handle_join{"Handles::join, 800 nodes alone"};
Row* const rows[] = {
    &opening,    &clearing, &build,      &restore,     &rebuild,        &canonicalize, &optimise,
    &join,       &leave,    &move,       &add_feature, &remove_feature, &dry_join,     &dry_leave,
    &dry_move,   &dry_add,  &dry_remove, &find,        &nearest,        &nearer,       &within,
    &around,     &along,    &at_node,    &of_edge,     &ways,           &hull,         &at_vertex,
    &hash,       &proof,    &sealing,    &attaching,   &copied,         &reading,      &saving,
    &loading,    &least,    &labels,     &edges,       &network,        &relay,        &gaps,
    &holes,      &between,  &circles,    &build_alone, &join_alone,     &leave_alone,  &join_many,
    &handle_join};

Position anywhere(Random& random) {
  const std::int32_t x = random.between(0, input.side);
  return {x, random.between(0, input.side)};
}

VertexId any_node(Random& random) {
  return VertexId{static_cast<IdValue>(1 + random.below(test::cost_node_count))};
}

// Those that do not cross another one.
std::uint32_t choose_features(Random& random) {
  std::uint32_t count = 0;
  for (std::uint32_t tries = 0; tries < 400 && count < features.size(); ++tries) {
    const FeatureEnds ends{any_node(random), any_node(random)};
    FeatureId id;
    if (mesh.add_feature(ends, id) == Status::ok) features[count++] = ends;
  }
  return count;
}

void ask(Random& random, VertexId node) {
  const Point place = to_point(anywhere(random));
  seen = measure(find, [&] { return locate(mesh, place).vertex.value; });
  seen = measure(nearest, [&] { return nearest_node(mesh, place).value; });
  std::array<NearNode, 10> ten;
  const auto reach = static_cast<std::uint32_t>(input.side / 8);
  seen = measure(within, [&] { return nodes_within(mesh, place, reach, ten); });
  seen = measure(nearer, [&] { return nearest_nodes(mesh, place, ten); });
  std::array<Neighbour, 16> some;
  seen = measure(around, [&] { return mesh.neighbours(node, some); });
}

void ask_features(VertexId node, FeatureId feature) {
  std::array<VertexId, 32> vertices;
  seen = measure(along, [&] { return mesh.chain(feature, vertices); });
  std::array<FeatureAt, 8> there;
  seen = measure(at_node, [&] { return features_at(mesh, node, there); });
  seen = measure(of_edge, [&] { return feature_between(mesh, vertices[0], vertices[1]).value; });
}

void change(Random& random) {
  const Position first = anywhere(random), second = anywhere(random);
  VertexId id;
  DryRun dry(mesh);
  static_cast<void>(measure(dry_join, [&] { return dry.join(first).status; }));
  if (measure(join, [&] { return mesh.join(first, id); }) != Status::ok) return;
  ask(random, id);
  static_cast<void>(measure(dry_move, [&] { return dry.move(id, second).status; }));
  static_cast<void>(measure(move, [&] { return mesh.move(id, second); }));
  const VertexId other = any_node(random);
  FeatureId feature;
  static_cast<void>(measure(dry_add, [&] { return dry.add_feature({id, other}).status; }));
  const Status added = measure(add_feature, [&] { return mesh.add_feature({id, other}, feature); });
  if (added == Status::ok) {
    ask_features(id, feature);
    static_cast<void>(measure(canonicalize, [&] { return mesh.canonicalize(); }));
    static_cast<void>(measure(dry_remove, [&] { return dry.remove_feature(feature).status; }));
    static_cast<void>(measure(remove_feature, [&] { return mesh.remove_feature(feature); }));
  }
  static_cast<void>(measure(dry_leave, [&] { return dry.leave(id).status; }));
  static_cast<void>(measure(leave, [&] { return mesh.leave(id); }));
  static_cast<void>(measure(canonicalize, [&] { return mesh.canonicalize(); }));
  // A node with its features.
  const VertexId node = any_node(random);
  const Position home = mesh.position(node);
  if (measure(move, [&] { return mesh.move(node, first); }) != Status::ok) return;
  static_cast<void>(measure(move, [&] { return mesh.move(node, home); }));
}

void lay_again(std::uint32_t feature_count) {
  FeatureId added;
  if (mesh.add_feature({VertexId{1}, VertexId{2}}, added) == Status::ok) {
    static_cast<void>(mesh.remove_feature(added));
  }
  static_cast<void>(measure(rebuild, [] { return mesh.rebuild(); }));
  std::uint32_t count = 0;
  const std::span<SteinerPlace> steiner = as<SteinerPlace>();
  for (IdValue i = 1; i < mesh.vertex_id_end(); ++i) {
    const VertexId v{i};
    if (mesh.kind(v) != VertexKind::steiner || count == steiner.size()) continue;
    steiner[count++] = {mesh.feature_of(v).value, mesh.point(v)};
  }
  static_cast<void>(measure(optimise, [] { return mesh.optimise(10); }));
  mesh.clear();
  static_cast<void>(measure(restore, [&] {
    return mesh.restore(input.nodes, std::span(features).first(feature_count),
                        steiner.first(count));
  }));
}

// What the network is like; ranges are such that a few are beyond them.
void analyse(Random& random) {
  seen = measure(ways, [] {
    std::uint32_t count = 0;
    for (const MeshEdge edge : edges_of(mesh)) count += edge.constrained ? 1 : 0;
    return count;
  });
  seen = measure(hull, [] { return mesh.finite_triangle_count(); });
  seen = measure(at_vertex, [] { return links_at(mesh, VertexId{1}, as<Link>()); });
  const auto range = static_cast<std::uint32_t>(input.side / 12);
  static_cast<void>(measure(labels, [] {
    return label_domain(mesh, Exterior::automatic, {}, region, as<TriangleId>());
  }));
  seen = measure(edges, [&] { return links(mesh, range, as<Link>()); });
  Connectivity answer;
  static_cast<void>(measure(
      network, [&] { return connectivity(mesh, range, as<ConnectivityScratch>(), answer); }));
  seen = measure(relay, [&] { return relays(mesh, mesh, range, as<Relay>()); });
  seen = measure(gaps, [&] { return barrier_gaps(mesh, mesh, range, as<Gap>()); });
  seen = measure(holes, [&] { return coverage_holes(mesh, {&mesh, region}, range, as<Hole>()); });
  const Point place = to_point(anywhere(random));
  Interpolated value;
  static_cast<void>(
      measure(between, [&] { return interpolate(mesh, place, as<std::int32_t>(), value); }));
}

// Where it goes on after a reset, or on another machine.
void go_on() {
  seen = measure(sealing, [] {
    seal(mesh);
    return 0u;
  });
  MeshReader reader;
  if (measure(attaching, [] { return attach(mesh, storage.bytes()); }) != Status::ok ||
      measure(copied, [] { return attach_copy(mesh, storage.bytes()); }) != Status::ok ||
      measure(reading, [&] { return reader.attach(storage.bytes()); }) != Status::ok ||
      measure(saving, [] { return mesh.save(as<std::byte>()); }) != Status::ok) {
    is_right = false;
  }
  seen = measure(clearing, [] {
    mesh.clear();
    return 0u;
  });
  if (measure(loading, [] { return mesh.load(as<std::byte>()); }) != Status::ok) is_right = false;
}

// What a call takes where there is no feature.
void live_alone() {
  Random random(~seed);
  for (std::uint32_t i = 0; i < rounds; ++i) {
    VertexId id;
    if (measure(join_alone, [&] { return mesh.join(anywhere(random), id); }) != Status::ok)
      continue;
    static_cast<void>(measure(leave_alone, [&] { return mesh.leave(id); }));
  }
  std::array<Point, 103> points;
  for (std::uint32_t i = 0; i < points.size(); ++i) points[i] = to_point(input.nodes[i]);
  seen = measure(circles, [&] {
    int sum = 0;
    for (std::uint32_t i = 0; i < 100; ++i) {
      sum += incircle(points[i], points[i + 1], points[i + 2], points[i + 3]);
    }
    return static_cast<std::uint32_t>(sum);
  });
}

// A mesh that grows by joins, the hints that are spread anew meanwhile included.
template <class Join>
void grow(Row& row, const Join& join_one) {
  seed = 0;
  Random random(seed);
  Row others{row.name};
  for (std::uint32_t i = 0; i < many; ++i) {
    const std::int32_t side = position_max / 16;
    const std::int32_t x = random.between(0, side);
    const Position place{x, random.between(0, side)};
    // Samples from all sizes.
    if (measure(i % 11 == 0 ? row : others, [&] { return join_one(place); }) != Status::ok) {
      is_right = false;
    }
  }
  row.take_worst_of(others);
}

void grow_by_joins() {
  VertexId id;
  if (mesh.open(storage.bytes(), storage.config()) != Status::ok) is_right = false;
  grow(join_many, [&](Position place) { return mesh.join(place, id); });
  Handles handles;
  NodeHandle node;
  mesh.clear();
  if (handles.open(mesh, as<std::uint32_t>()) != Status::ok) is_right = false;
  grow(handle_join, [&](Position place) { return handles.join(place, node); });
}

void live(std::uint32_t with) {
  seed = with;
  Random random(seed);
  test::make_cost_input(seed, random, input);
  if (measure(opening, [] { return mesh.open(storage.bytes(), storage.config()); }) != Status::ok ||
      measure(build_alone, [] { return mesh.build(input.nodes, {}); }) != Status::ok) {
    is_right = false;
    return;
  }
  live_alone();
  for (std::uint32_t i = 0; i < rounds; ++i) {
    const FeatureEnds ends{VertexId{1}, VertexId{static_cast<IdValue>(2 + i)}};
    seen = measure(least, [&] { return least_steiner(mesh, ends); });
  }
  const std::uint32_t count = choose_features(random);
  mesh.clear();
  static_cast<void>(
      measure(build, [&] { return mesh.build(input.nodes, std::span(features).first(count)); }));
  if (mesh.unresolved() != 0) return;
  for (std::uint32_t i = 0; i < rounds; ++i) change(random);
  seen = measure(hash, [] { return mesh.hash(); });
  analyse(random);
  seen = measure(proof, [] { return static_cast<std::uint64_t>(audit(mesh).broken); });
  lay_again(count);
  if (mesh.unresolved() == 0 && mesh.node_count() != 0) go_on();
}

// A hundred features from one node to others in a circle around it. No input of the search.
[[maybe_unused]] void ask_star() {
  constexpr std::uint32_t circle = 16, spokes = 100;
  seed = circle;
  Random random(seed);
  test::make_cost_input(seed, random, input);
  input.nodes[0] = {};
  const std::span<FeatureEnds> star = as<FeatureEnds>().first(spokes);
  for (std::uint32_t i = 0; i < spokes; ++i) {
    star[i] = {VertexId{1}, VertexId{static_cast<IdValue>(2 + i)}};
  }
  mesh.clear();
  if (mesh.build(input.nodes, star) != Status::ok) is_right = false;
  ask(random, VertexId{1});
  ask_features(VertexId{1}, FeatureId{spokes / 2});
}

}  // namespace

int main() {
  mesh.keep_alive({[](void*) noexcept { timer.look(); }, nullptr});
  grow_by_joins();
#ifdef ETCM_COST_SEARCH
  is_random = false;
  for (std::uint32_t i = 0; i < ETCM_COST_SEARCH; ++i) live(i);
#else
  for (std::uint32_t i = 0; i < random_inputs; ++i) live(i * test::cost_kinds);
  is_random = false;
  for (const std::uint32_t with : kept) live(with);
  ask_star();
#endif
  for (Row* row : rows) is_right &= put_row(*row);
  for (const std::uint32_t nodes : {50u, 200u, 1000u}) test::put_memory(nodes);
  put(is_right ? "within the limits\n" : "beyond a limit\n");
  return is_right ? 0 : 1;
}

// How many instructions a unit of work takes (etcm/work.h), as a table. For a machine whose system
// timer counts instructions: QEMU with -icount shift=0 takes a nanosecond for each, and a tick is
// one of the board's clock. Leaves with 1 where a unit takes more than it may, or where longer goes
// by than may between two calls of the hook that keeps a watchdog quiet.
#include <array>
#include <cstdint>
#include <span>

#include "board/instructions.h"
#include "console.h"
#include "etcm/mesh.h"
#include "etcm/storage.h"
#include "inputs/random.h"

namespace {

using namespace etcm;
using test::InstructionClock;
using test::put;
using test::put_number;

constexpr std::uint32_t node_count = 250;
constexpr std::uint32_t feature_count = 60;
constexpr std::uint32_t change_count = 30;
constexpr std::int32_t side = 20'000;
// Of smaller calls the fixed costs are measured, not the units.
constexpr std::uint64_t least_units = 1000;
constexpr std::uint64_t instructions_max = ETCM_INSTRUCTIONS_MAX;  // that lib/docs/work.md states
// The one walk that may be between two calls of the hook is of tens of units as a rule (work.h).
constexpr std::uint64_t usual_walk = 64;

MeshStorage<900, 250> storage;
Mesh mesh;
std::array<Position, node_count> nodes;
std::array<FeatureEnds, feature_count> features;
std::array<SteinerPlace, 700> steiner;

struct Row {
  const char* name;
  std::uint32_t calls = 0;
  std::uint32_t large_calls = 0;
  std::uint64_t units = 0;
  std::uint64_t instructions = 0;
  std::uint64_t most_units = 0;
  std::uint64_t worst = 0;    // instructions a unit, of large calls
  std::uint64_t longest = 0;  // instructions between two calls of the hook
};
std::array<Row, 10> rows{{{"build"},
                          {"join"},
                          {"move"},
                          {"add_feature"},
                          {"remove_feature"},
                          {"leave"},
                          {"canonicalize"},
                          {"rebuild"},
                          {"restore"},
                          {"optimise"}}};
enum : std::size_t {
  build,
  join,
  move,
  add_feature,
  remove_feature,
  leave,
  canonicalize,
  rebuild,
  restore,
  optimise
};

bool is_right = true;

InstructionClock clock;  // of the call that goes on

template <class Call>
Status measure(std::size_t row, const Call& call) {
  clock.start();
  const Status status = call();
  clock.stop();
  Row& of = rows[row];
  const std::uint64_t instructions = clock.instructions();
  const std::uint64_t units = mesh.work_needed().units;
  ++of.calls;
  of.units += units;
  if (clock.longest() > of.longest) of.longest = clock.longest();
  of.instructions += instructions;
  if (units > of.most_units) of.most_units = units;
  if (units < least_units) return status;
  ++of.large_calls;
  const std::uint64_t each = (instructions + units - 1) / units;
  if (each > of.worst) of.worst = each;
  return status;
}

void change(inputs::Random& random) {
  for (std::uint32_t i = 0; i < change_count; ++i) {
    const auto place = [&] {
      const std::int32_t x = random.between(0, side);
      return Position{x, random.between(0, side)};
    };
    VertexId id;
    const Position first = place(), second = place();
    if (measure(join, [&] { return mesh.join(first, id); }) != Status::ok) continue;
    static_cast<void>(measure(move, [&] { return mesh.move(id, second); }));
    const VertexId other{static_cast<IdValue>(1 + random.below(node_count))};
    FeatureId feature;
    const Status added = measure(add_feature, [&] {
      return mesh.add_feature({id, other}, feature);
    });
    static_cast<void>(measure(canonicalize, [&] { return mesh.canonicalize(); }));
    if (added == Status::ok) {
      static_cast<void>(measure(remove_feature, [&] { return mesh.remove_feature(feature); }));
    }
    static_cast<void>(measure(leave, [&] { return mesh.leave(id); }));
    static_cast<void>(measure(canonicalize, [&] { return mesh.canonicalize(); }));
  }
}

// What lays all of it anew.
void lay_again() {
  const FeatureEnds ends{VertexId{1}, VertexId{2}};
  FeatureId added;
  if (mesh.add_feature(ends, added) == Status::ok) static_cast<void>(mesh.remove_feature(added));
  static_cast<void>(measure(rebuild, [] { return mesh.rebuild(); }));
  static_cast<void>(measure(optimise, [] { return mesh.optimise(20); }));
  std::uint32_t steiner_count = 0;
  for (IdValue i = 1; i < mesh.vertex_id_end(); ++i) {
    const VertexId v{i};
    if (mesh.kind(v) != VertexKind::steiner) continue;
    steiner[steiner_count++] = {mesh.feature_of(v).value, mesh.point(v)};
  }
  std::uint32_t count = 0;
  for (; count < feature_count && mesh.is_feature(FeatureId{static_cast<IdValue>(count)}); ++count)
    features[count] = mesh.ends(FeatureId{static_cast<IdValue>(count)});
  mesh.clear();
  if (measure(restore, [&] {
        return mesh.restore(nodes, std::span(features).first(count),
                            std::span(steiner).first(steiner_count));
      }) != Status::ok) {
    is_right = false;
  }
}

// `reach`: how far apart the ends of a feature are at the most, in numbers of nodes of a row.
void live(std::uint64_t seed, std::int32_t reach) {
  inputs::Random random(seed);
  for (Position& node : nodes) {
    const std::int32_t x = random.between(0, side);
    node = {x, random.between(0, side)};
  }
  std::uint32_t count = 0;
  for (std::uint32_t tries = 0; tries < 20 * feature_count && count < feature_count; ++tries) {
    const auto a = static_cast<std::uint32_t>(random.below(node_count));
    const auto b = static_cast<std::uint32_t>(random.below(node_count));
    const std::int64_t dx = nodes[a].x - nodes[b].x, dy = nodes[a].y - nodes[b].y;
    if (a == b || dx * dx + dy * dy > std::int64_t{reach} * reach) continue;
    features[count++] = {VertexId{static_cast<IdValue>(a + 1)},
                         VertexId{static_cast<IdValue>(b + 1)}};
  }
  if (mesh.open(storage.bytes(), storage.config()) != Status::ok) is_right = false;
  mesh.keep_alive({[](void*) noexcept { clock.look(); }, nullptr});
  // Features that cross are refused: each alone.
  static_cast<void>(measure(build, [&] { return mesh.build(nodes, {}); }));
  for (std::uint32_t i = 0; i < count; ++i) {
    FeatureId id;
    static_cast<void>(measure(add_feature, [&] { return mesh.add_feature(features[i], id); }));
  }
  change(random);
  lay_again();
}

void print() {
  put("| call | calls | most units | instructions a unit | at worst, of 1000 units and more | "
      "longest "
      "between two calls of the hook |\n|---|---:|---:|---:|---:|---:|\n");
  for (const Row& row : rows) {
    put("| ");
    put(row.name);
    for (const std::uint64_t value : {std::uint64_t{row.calls}, row.most_units}) {
      put(" | ");
      put_number(value);
    }
    put(" | ");
    put_number(row.units == 0 ? 0 : row.instructions / row.units);
    put(" | ");
    if (row.large_calls != 0) put_number(row.worst);
    put(" | ");
    put_number(row.longest);
    put(" |\n");
    if (row.longest > instructions_max * (KeepAlive::units_between + usual_walk)) is_right = false;
    if (row.worst > instructions_max) is_right = false;
  }
}

}  // namespace

int main() {
  live(1, side / 12);
  live(2, side);
  print();
  put(is_right ? "within the limit\n" : "a unit took more than its limit, or the hook was late\n");
  return is_right ? 0 : 1;
}

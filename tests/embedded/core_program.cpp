// One life of a mesh, the same on every machine: what it prints must not depend on where it runs,
// on the width of ids or on the arithmetic behind the predicates. Lines that begin with '#' may.
// Leaves with 1 if the mesh is ever not what mesh.h promises.
#include <array>
#include <cstdint>
#include <limits>
#include <span>

#include "console.h"
#include "etcm/audit.h"
#include "etcm/bound.h"
#include "etcm/domain.h"
#include "etcm/locate.h"
#include "etcm/mesh.h"
#include "etcm/predicates.h"
#include "etcm/storage.h"
#include "inputs/random.h"

namespace {

using namespace etcm;
using test::put;
using test::put_hex;
using test::put_number;

constexpr std::uint32_t vertices_max = 900;
constexpr std::uint32_t features_max = 250;
constexpr std::uint32_t crowd = 120;  // nodes that stand at a time
constexpr std::uint32_t event_count = 300;
constexpr std::int32_t side = 600;  // small, so that nodes meet features

// All memory there is.
MeshStorage<vertices_max, features_max> storage;
Mesh mesh;
std::array<Position, 2 * crowd> nodes;
std::array<FeatureEnds, features_max> features;
std::array<VertexId, vertices_max + 1> vertices;
std::array<Region, 2 * vertices_max> regions;
std::array<TriangleId, 2 * vertices_max> scratch;
std::array<std::byte, 6000> saved;

bool is_sound = true;

void demand(bool fact, const char* what) {
  if (fact) return;
  is_sound = false;
  put("broken: ");
  put(what);
  put("\n");
}

void audit_mesh() {
  const Audit result = audit(mesh);
  demand(bool(result), to_string(result.broken));
}

// A running hash (FNV-1a, a word at a time) of everything a caller can see.
class Digest {
 public:
  void add(std::uint64_t value) noexcept { value_ = (value_ ^ value) * 0x100000001b3u; }
  void add(const Point& p) noexcept {
    add(static_cast<std::uint64_t>(p.x));
    add(static_cast<std::uint64_t>(p.y));
  }
  // `none` is another number in each width of ids.
  template <class Tag>
  void add(Id<Tag> id) noexcept {
    add(id.is_none() ? std::numeric_limits<std::uint64_t>::max() : std::uint64_t{id.value});
  }
  void add(const char* text) noexcept {
    for (; *text != 0; ++text) add(std::uint64_t{static_cast<unsigned char>(*text)});
  }
  std::uint64_t value() const noexcept { return value_; }

 private:
  std::uint64_t value_ = 0xcbf29ce484222325u;
};

Digest digest;

void put_field(const char* name, std::uint64_t value) {
  put(" ");
  put(name);
  put(" ");
  put_number(value);
}

void put_line(const char* title) {
  put(title);
  put_field("nodes", mesh.node_count());
  put_field("features", mesh.feature_count());
  put_field("steiner", mesh.steiner_count());
  put_field("triangles", mesh.finite_triangle_count());
  put(" mesh ");
  put_hex(mesh.hash());
  put(" seen ");
  put_hex(digest.value());
  put("\n");
}

VertexId random_vertex(inputs::Random& random) {
  return VertexId{static_cast<IdValue>(random.below(mesh.vertex_id_end() + 1) + 1)};
}
Position random_position(inputs::Random& random) {
  const std::int32_t x = random.between(0, side);
  return {x, random.between(0, side)};
}

// Any answer is right as long as it is the same everywhere.
void live(inputs::Random& random) {
  const std::uint64_t chance = random.below(100);
  Status status;
  if (chance < 8 || mesh.node_count() < crowd / 4) {
    VertexId id;
    status = mesh.join(random_position(random), id);
    digest.add(id);
  } else if (chance < 14 && mesh.node_count() < crowd) {
    VertexId id;
    status = mesh.join(random_position(random), id);
    digest.add(id);
  } else if (chance < 22) {
    status = mesh.leave(random_vertex(random));
  } else if (chance < 38) {
    const VertexId vertex = random_vertex(random);
    status = mesh.move(vertex, random_position(random));
  } else if (chance < 88) {
    const VertexId from = random_vertex(random);
    FeatureId id;
    status = mesh.add_feature({from, random_vertex(random)}, id);
    digest.add(id);
  } else if (chance < 99) {
    const auto id = static_cast<IdValue>(random.below(mesh.feature_id_end() + 1));
    status = mesh.remove_feature(FeatureId{id});
  } else {
    status = mesh.rebuild();
  }
  digest.add(to_string(status));
  digest.add(explain(status));
  if (status != Status::ok) {
    const ErrorDetail& error_detail = mesh.error_detail();
    digest.add(error_detail.vertex);
    digest.add(error_detail.feature);
    digest.add(error_detail.other);
    digest.add(error_detail.from);
    digest.add(error_detail.to);
  }
  digest.add(mesh.hash());
}

// Looks at the mesh through every question there is.
void look() {
  for (std::uint32_t i = 1; i < mesh.vertex_id_end(); ++i) {
    const VertexId v{static_cast<IdValue>(i)};
    digest.add(std::uint64_t{static_cast<std::uint8_t>(mesh.kind(v))});
    if (mesh.kind(v) == VertexKind::none) continue;
    digest.add(mesh.point(v));
    if (mesh.kind(v) == VertexKind::node) digest.add(to_point(mesh.position(v)));
    if (mesh.kind(v) == VertexKind::steiner) digest.add(mesh.feature_of(v));
    std::array<Neighbour, 16> around;
    const std::uint32_t degree = mesh.neighbours(v, around);
    digest.add(std::uint64_t{degree});
    for (std::uint32_t n = 0; n < degree && n < around.size(); ++n) digest.add(around[n].vertex);
  }
  for (std::uint32_t i = 0; i < mesh.feature_id_end(); ++i) {
    const FeatureId feature{static_cast<IdValue>(i)};
    if (!mesh.is_feature(feature)) continue;
    const std::uint32_t length = mesh.chain(feature, vertices);
    for (std::uint32_t n = 0; n < length; ++n) digest.add(vertices[n]);
  }
  const Point seed = to_point({side / 2, side / 2});
  const Status labelled =
      label_domain(mesh, Exterior::automatic, {&seed, 1}, std::span(regions), std::span(scratch));
  demand(labelled == Status::ok, "label_domain");
  for (std::uint32_t t = 0; t < mesh.triangle_count(); ++t) {
    digest.add(std::uint64_t{static_cast<std::uint8_t>(regions[t])});
    const Triangle triangle = mesh.triangle(TriangleId{static_cast<IdValue>(t)});
    if (triangle.is_ghost()) continue;
    const auto& [a, b, c] = triangle.corner;
    demand(orient2d(mesh.point(a), mesh.point(b), mesh.point(c)) > 0, "orientation");
    demand(incircle(mesh.point(a), mesh.point(b), mesh.point(c), seed) ==
               incircle(mesh.point(b), mesh.point(c), mesh.point(a), seed),
           "incircle is the same from each corner");
  }
  const Location location = locate(mesh, seed);
  digest.add(std::uint64_t{static_cast<std::uint8_t>(location.type)});
  digest.add(location.vertex);
}

// What stands, as input for build().
void rebuild_from_list() {
  std::uint32_t node_count = 0, feature_count = 0;
  for (std::uint32_t i = 1; i < mesh.vertex_id_end(); ++i) {
    const VertexId v{static_cast<IdValue>(i)};
    vertices[i] = VertexId::none();
    if (mesh.kind(v) != VertexKind::node) continue;
    nodes[node_count++] = mesh.position(v);
    vertices[i] = VertexId{static_cast<IdValue>(node_count)};
  }
  for (std::uint32_t i = 0; i < mesh.feature_id_end(); ++i) {
    const FeatureId feature{static_cast<IdValue>(i)};
    if (!mesh.is_feature(feature)) continue;
    const FeatureEnds ends = mesh.ends(feature);
    features[feature_count++] = {vertices[ends.from.value], vertices[ends.to.value]};
  }
  demand(mesh.rebuild() == Status::ok, "rebuild");
  const std::uint64_t rebuilt = mesh.hash();
  mesh.clear();
  demand(mesh.build(std::span(nodes).first(node_count), {}) == Status::ok, "build of nodes");
  std::uint32_t least = 0;
  for (std::uint32_t i = 0; i < feature_count; ++i) least += least_steiner(mesh, features[i]);
  mesh.clear();
  demand(mesh.build(std::span(nodes).first(node_count), std::span(features).first(feature_count)) ==
             Status::ok,
         "build");
  demand(mesh.hash() == rebuilt, "rebuild() makes the mesh that build() makes");
  audit_mesh();
  put_line("built afresh:");
  demand(least <= mesh.steiner_count(), "no mesh has fewer");
  digest.add(std::uint64_t{least});
  demand(mesh.optimise(100) == Status::ok, "optimise");
  audit_mesh();
  put_line("looked for fewer:");
  demand(mesh.canonicalize() == Status::ok && mesh.hash() == rebuilt, "canonicalize");
}

// The life goes on with what was saved here, and with bytes that were found again.
void save_and_load(SplitPolicy policy) {
  const std::uint64_t hash = mesh.hash();
  const std::size_t size = mesh.saved_bytes();
  demand(mesh.save(saved) == Status::ok, "save");
  for (const std::byte byte : std::span(saved).first(size)) {
    digest.add(static_cast<std::uint64_t>(byte));
  }
  mesh.clear();
  demand(mesh.load(std::span(saved).first(size)) == Status::ok && mesh.hash() == hash, "load");
  audit_mesh();
  seal(mesh);
  demand(attach(mesh, storage.bytes(), policy) == Status::ok && mesh.hash() == hash, "attach");
}

void live_a_life(const char* name, SplitPolicy policy) {
  MeshConfig config = storage.config();
  config.policy = policy;
  demand(mesh.open(storage.bytes(), config) == Status::ok, "open");
  put(name);
  put("\n");
  inputs::Random random(20);
  for (std::uint32_t event = 1; event <= event_count; ++event) {
    live(random);
    if (event % 50 != 0) continue;
    audit_mesh();
    look();
    save_and_load(policy);
    put_line("a stretch of life:");
  }
  rebuild_from_list();
}

// Many ties, and features that win some of them.
void build_grid(SplitPolicy policy) {
  constexpr std::uint32_t width = 10;
  MeshConfig config = storage.config();
  config.policy = policy;
  demand(mesh.open(storage.bytes(), config) == Status::ok, "open");
  for (std::uint32_t i = 0; i < width * width; ++i) {
    nodes[i] = {static_cast<std::int32_t>(i % width) * 7, static_cast<std::int32_t>(i / width) * 7};
  }
  std::uint32_t count = 0;
  for (std::uint32_t i = 0; i + 2 * width + 1 < width * width; i += 3) {
    if (i % width >= width - 1 || (i / width) % 3 != 0) continue;
    features[count++] = {VertexId{static_cast<IdValue>(i + 1)},
                         VertexId{static_cast<IdValue>(i + 2 * width + 2)}};
  }
  const Status status =
      mesh.build(std::span(nodes).first(width * width), std::span(features).first(count));
  demand(status == Status::ok, to_string(status));
  audit_mesh();
  put_line("grid:");
}

// Unequal features in a narrow angle from one node.
void build_fan(SplitPolicy policy) {
  constexpr std::uint32_t count = 20;
  MeshConfig config = storage.config();
  config.policy = policy;
  demand(mesh.open(storage.bytes(), config) == Status::ok, "open");
  nodes[0] = {0, 0};
  for (std::uint32_t i = 1; i <= count; ++i) {
    const auto reach = static_cast<std::int32_t>(10'000 + (i * 7919u) % 30'000u);
    nodes[i] = {reach, reach / 200 * static_cast<std::int32_t>(i)};
    features[i - 1] = {VertexId{1}, VertexId{static_cast<IdValue>(i + 1)}};
  }
  const Status status =
      mesh.build(std::span(nodes).first(count + 1), std::span(features).first(count));
  demand(status == Status::ok, to_string(status));
  audit_mesh();
  put_line("fan:");
}

}  // namespace

int main() {
  live_a_life("the default policy", split_default);
  build_grid(split_default);
  build_fan(split_default);
  live_a_life("the policy paper", split_paper);
  build_grid(split_paper);
  put(is_sound ? "sound\n" : "not sound\n");
  return is_sound ? 0 : 1;
}

// Calls a part of the library, so that the linker shows what that part takes. Never run.
// ETCM_PARTS: 0 build() and its mesh, 1 changes, 2 canonicalize(), 3 optimise() and the bound,
// 4 dry runs and handles, 5 what is asked of a place or a node, 6 the analysis, 7 proof and texts,
// 8 bytes.
#include <array>
#include <cstdint>
#include <span>

#include "etcm/analysis.h"
#include "etcm/audit.h"
#include "etcm/bound.h"
#include "etcm/domain.h"
#include "etcm/dry_run.h"
#include "etcm/handles.h"
#include "etcm/incidence.h"
#include "etcm/locate.h"
#include "etcm/mesh.h"
#include "etcm/nearest.h"
#include "etcm/storage.h"

namespace {

using namespace etcm;

MeshStorage<900, 250> storage;
Mesh mesh;
std::array<Position, 120> nodes;
std::array<FeatureEnds, 60> features;
// What comes of the calls, so that none is left out.
volatile std::uint64_t seen;

void keep(std::uint64_t value) { seen = seen + value; }
void keep(Status status) { keep(static_cast<std::uint64_t>(status)); }

}  // namespace

int main() {
  keep(mesh.open(storage.bytes(), storage.config()));
  keep(mesh.build(nodes, features));
  const VertexId v{static_cast<IdValue>(seen)};
  keep(mesh.triangle(TriangleId{static_cast<IdValue>(seen)}).corner[0].value);
  keep(static_cast<std::uint64_t>(mesh.point(v).x));
  keep(mesh.hash());
#if ETCM_PARTS >= 1
  VertexId joined;
  FeatureId added;
  keep(mesh.join(nodes[0], joined));
  keep(mesh.move(joined, nodes[1]));
  keep(mesh.add_feature({v, joined}, added));
  keep(mesh.remove_feature(added));
  keep(mesh.leave(joined));
  keep(mesh.neighbours(v, {}));
  keep(mesh.chain(added, {}));
#endif
#if ETCM_PARTS >= 2
  keep(mesh.canonicalize());
  keep(mesh.is_canonical());
#endif
#if ETCM_PARTS >= 3
  keep(mesh.optimise(100));
  keep(least_steiner(mesh, {v, joined}));
#endif
#if ETCM_PARTS >= 4
  keep(DryRun(mesh).join(nodes[2]).status);
  keep(DryRun(mesh).leave(joined).status);
  keep(DryRun(mesh).move(joined, nodes[3]).status);
  keep(DryRun(mesh).add_feature({v, joined}).status);
  keep(DryRun(mesh).remove_feature(added).status);
  static std::array<std::uint32_t, Handles::words(storage.config())> numbers;
  static Handles handles;
  NodeHandle node;
  FeatureHandle feature;
  keep(handles.open(mesh, numbers));
  keep(handles.join(nodes[4], node));
  keep(handles.handle_of(v, node));
  keep(handles.handle_of(added, feature));
  keep(handles.move(node, nodes[5]));
  keep(handles.add_feature(node, node, feature));
  keep(handles.remove_feature(feature));
  keep(handles.leave(node));
#endif
#if ETCM_PARTS >= 5
  const Point place = mesh.point(v);
  keep(locate(mesh, place).vertex.value);
  keep(nearest_node(mesh, place).value);
  keep(nodes_within(mesh, place, 9, {}));
  keep(features_at(mesh, v, {}));
  keep(feature_between(mesh, v, joined).value);
  static std::array<Region, 1800> regions;
  static std::array<TriangleId, 1800> scratch;
  keep(label_domain(mesh, Exterior::automatic, {}, regions, scratch));
#endif
#if ETCM_PARTS >= 6
  Connectivity network;
  keep(links(mesh, 9, {}));
  keep(links_at(mesh, v, {}));
  keep(connectivity(mesh, 9, {}, network));
  keep(relays(mesh, mesh, 9, {}));
  keep(barrier_gaps(mesh, mesh, 9, {}));
  keep(coverage_holes(mesh, {}, 9, {}));
#endif
#if ETCM_PARTS >= 7
  const Audit result = audit(mesh);
  keep(static_cast<std::uint64_t>(to_string(result.broken)[0]));
  const Status status = mesh.rebuild();
  keep(static_cast<std::uint64_t>(to_string(status)[0]));
  keep(static_cast<std::uint64_t>(explain(status)[0]));
  keep(mesh.restore(nodes, features, {}));
#endif
#if ETCM_PARTS >= 8
  static std::array<std::byte, 10000> saved;
  seal(mesh);
  keep(attach(mesh, storage.bytes()));
  keep(mesh.save(saved));
  keep(mesh.load(saved));
#endif
}

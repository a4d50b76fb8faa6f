// The interface for C answers as that of C++ does: one mesh lived through both.
#include <gtest/gtest.h>

#include <array>
#include <cstring>
#include <memory>
#include <utility>
#include <vector>

#include "etcm/analysis.h"
#include "etcm/audit.h"
#include "etcm/bound.h"
#include "etcm/c/analysis.h"
#include "etcm/domain.h"
#include "etcm/dry_run.h"
#include "etcm/etcm.h"
#include "etcm/handles.h"
#include "etcm/illegal_argument.h"
#include "etcm/incidence.h"
#include "etcm/locate.h"
#include "etcm/nearest.h"
#include "etcm/predicates.h"
#include "etcm/split_site.h"
#include "etcm/storage.h"
#include "etcm/surroundings.h"
#include "etcm/traverse.h"
#include "inputs/random.h"
#include "inputs/random_graph.h"

namespace etcm::test {
namespace {

constexpr std::uint32_t vertices_max = 900, features_max = 200;

// A mesh by each interface.
class CInterface : public testing::Test {
 protected:
  CInterface() : c_storage_(storage_bytes(vertices_max, features_max) / 8 + 1) {
    open(nullptr);
    EXPECT_EQ(mesh_.open(storage_->bytes(), storage_->config()), Status::ok);
  }

  void open(const etcm_split_policy_t* policy) {
    const etcm_config_t config{vertices_max, features_max, 0, policy};
    ASSERT_EQ(etcm_open(&c_, c_storage_.data(), c_storage_.size() * 8, &config), ETCM_OK);
  }

  // The same for both.
  void build(const inputs::Graph& graph) {
    ASSERT_EQ(mesh_.build(graph.nodes, graph.features), Status::ok);
    const auto* nodes = reinterpret_cast<const etcm_position_t*>(graph.nodes.data());
    const auto* features = reinterpret_cast<const etcm_feature_ends_t*>(graph.features.data());
    ASSERT_EQ(
        etcm_build(&c_, nodes, graph.nodes.size(), features, graph.features.size(), ETCM_UNLIMITED),
        ETCM_OK);
  }

  void expect_same() {
    EXPECT_EQ(etcm_hash(&c_), mesh_.hash());
    EXPECT_EQ(etcm_node_count(&c_), mesh_.node_count());
    EXPECT_EQ(etcm_steiner_count(&c_), mesh_.steiner_count());
    EXPECT_EQ(etcm_feature_count(&c_), mesh_.feature_count());
    EXPECT_EQ(etcm_triangle_count(&c_), mesh_.triangle_count());
    EXPECT_EQ(etcm_finite_triangle_count(&c_), mesh_.finite_triangle_count());
    EXPECT_EQ(etcm_unresolved(&c_), mesh_.unresolved());
    EXPECT_EQ(etcm_vertex_id_end(&c_), mesh_.vertex_id_end());
    EXPECT_EQ(etcm_feature_id_end(&c_), mesh_.feature_id_end());
    EXPECT_EQ(etcm_work_used(&c_), mesh_.work_used().units);
    EXPECT_EQ(etcm_work_needed(&c_), mesh_.work_needed().units);
    EXPECT_EQ(etcm_is_canonical(&c_), mesh_.is_canonical());
  }

  void expect_same(etcm_status_t c_status, Status status) {
    ASSERT_EQ(c_status, static_cast<int>(status));
    expect_same();
    if (status == Status::ok) return;
    etcm_error_detail_t detail;
    etcm_error_detail(&c_, &detail);
    const ErrorDetail& own = mesh_.error_detail();
    EXPECT_EQ(detail.status, static_cast<int>(own.status));
    EXPECT_EQ(detail.vertex, own.vertex.value);
    EXPECT_EQ(detail.rejected, own.rejected.value);
    EXPECT_EQ(detail.feature, own.feature.value);
    EXPECT_EQ(detail.other, own.other.value);
    EXPECT_EQ(detail.from.x, own.from.x);
    EXPECT_EQ(detail.to.y, own.to.y);
  }

  std::unique_ptr<MeshStorage<vertices_max, features_max>> storage_ =
      std::make_unique<MeshStorage<vertices_max, features_max>>();
  Mesh mesh_;
  std::vector<std::uint64_t> c_storage_;
  etcm_mesh_t c_{};
};

etcm_position_t c_position(Position p) { return {p.x, p.y}; }
etcm_point_t c_point(Point p) { return {p.x, p.y}; }

TEST_F(CInterface, MakesTheSameChanges) {
  inputs::Random random(3);
  const auto vertex = [&] {
    return VertexId{static_cast<IdValue>(1 + random.below(mesh_.vertex_id_end() + 1))};
  };
  const auto place = [&] {
    const std::int32_t x = random.between(0, 300);
    return Position{x, random.between(0, 300)};
  };
  for (int i = 0; i < 60; ++i) {
    const Position position = place();
    VertexId own;
    etcm_vertex_t c = ETCM_NONE;
    const Status status = mesh_.join(position, own);
    expect_same(etcm_join(&c_, c_position(position), ETCM_UNLIMITED, &c), status);
    EXPECT_EQ(c, own.value);
  }
  unsigned refused = 0;
  for (int i = 0; i < 200; ++i) {
    const VertexId a = vertex(), b = vertex();
    const Position position = place();
    const std::uint64_t limit = random.below(4) == 0 ? random.below(400) : ETCM_UNLIMITED;
    Status status = Status::ok;
    if (i % 4 == 0) {
      status = mesh_.move(a, position, Work{limit});
      expect_same(etcm_move(&c_, a.value, c_position(position), limit), status);
    } else if (i % 7 == 0) {
      status = mesh_.leave(a, Work{limit});
      expect_same(etcm_leave(&c_, a.value, limit), status);
    } else if (i % 5 == 0) {
      const FeatureId feature{static_cast<IdValue>(random.below(mesh_.feature_id_end() + 1))};
      status = mesh_.remove_feature(feature, Work{limit});
      expect_same(etcm_remove_feature(&c_, feature.value, limit), status);
    } else {
      FeatureId own;
      etcm_feature_t c = ETCM_NONE;
      status = mesh_.add_feature({a, b}, own, Work{limit});
      expect_same(etcm_add_feature(&c_, a.value, b.value, limit, &c), status);
      EXPECT_EQ(c, own.value);
    }
    refused += status != Status::ok;
  }
  EXPECT_GT(refused, 20u);
  const Status optimised = mesh_.optimise(40, 3);
  expect_same(etcm_optimise(&c_, 40, 3, ETCM_UNLIMITED), optimised);
  const Status canonical = mesh_.canonicalize();
  expect_same(etcm_canonicalize(&c_, ETCM_UNLIMITED), canonical);
  const Status rebuilt = mesh_.rebuild();
  expect_same(etcm_rebuild(&c_, ETCM_UNLIMITED), rebuilt);
  etcm_clear(&c_);
  mesh_.clear();
  expect_same();
}

TEST_F(CInterface, ReadsTheSame) {
  build(inputs::random_graph(150, inputs::FeatureLength::any, 5));
  expect_same();
  for (std::uint32_t i = 1; i < mesh_.vertex_id_end(); ++i) {
    const VertexId v{static_cast<IdValue>(i)};
    EXPECT_EQ(etcm_kind(&c_, v.value), static_cast<int>(mesh_.kind(v)));
    if (mesh_.kind(v) == VertexKind::none) continue;
    EXPECT_EQ(etcm_point(&c_, v.value).x, mesh_.point(v).x);
    EXPECT_EQ(etcm_position(&c_, v.value).y, mesh_.position(v).y);
    if (mesh_.kind(v) == VertexKind::steiner) {
      EXPECT_EQ(etcm_feature_of(&c_, v.value), mesh_.feature_of(v).value);
    }
    std::array<etcm_neighbour_t, 5> c;
    std::array<Neighbour, 5> own;
    const std::uint32_t count = mesh_.neighbours(v, own);
    ASSERT_EQ(etcm_neighbours(&c_, v.value, c.data(), c.size()), count);
    for (std::uint32_t n = 0; n < count && n < c.size(); ++n) {
      EXPECT_EQ(c[n].vertex, own[n].vertex.value);
      EXPECT_EQ(c[n].constrained, own[n].constrained);
    }
  }
  for (std::uint32_t i = 0; i < mesh_.triangle_count(); ++i) {
    const TriangleId id{static_cast<IdValue>(i)};
    etcm_triangle_t c;
    etcm_triangle(&c_, id.value, &c);
    const Triangle own = mesh_.triangle(id);
    for (unsigned k = 0; k < 3; ++k) {
      EXPECT_EQ(c.corner[k], own.corner[k].value);
      EXPECT_EQ(c.neighbour[k], own.neighbour[k].value);
      EXPECT_EQ(c.constrained[k], own.constrained[k]);
    }
  }
  for (std::uint32_t i = 0; i < mesh_.feature_id_end(); ++i) {
    const FeatureId feature{static_cast<IdValue>(i)};
    ASSERT_EQ(etcm_is_feature(&c_, feature.value), mesh_.is_feature(feature));
    if (!mesh_.is_feature(feature)) continue;
    EXPECT_EQ(etcm_ends(&c_, feature.value).to, mesh_.ends(feature).to.value);
    std::array<etcm_vertex_t, 9> c;
    std::array<VertexId, 9> own;
    const std::uint32_t count = mesh_.chain(feature, own);
    ASSERT_EQ(etcm_chain(&c_, feature.value, c.data(), c.size()), count);
    for (std::uint32_t n = 0; n < count && n < c.size(); ++n) EXPECT_EQ(c[n], own[n].value);
  }
  EXPECT_EQ(etcm_neighbours(&c_, 1, nullptr, 0), mesh_.neighbours(VertexId{1}, {}));
}

struct Seen {
  std::vector<std::uint32_t> ids;
  std::size_t most = 100'000;
};

TEST_F(CInterface, GoesOverAllOfThem) {
  build(inputs::random_graph(100, inputs::FeatureLength::any, 6));
  const auto note = [](void* context, etcm_id_t id) {
    auto& seen = *static_cast<Seen*>(context);
    seen.ids.push_back(id);
    return seen.ids.size() < seen.most;
  };
  Seen nodes, features, edges;
  EXPECT_TRUE(etcm_nodes_of(&c_, note, &nodes));
  EXPECT_TRUE(etcm_features_of(&c_, note, &features));
  EXPECT_TRUE(etcm_edges_of(
      &c_,
      [](void* context, const etcm_edge_t* edge) {
        auto& ids = static_cast<Seen*>(context)->ids;
        ids.insert(ids.end(), {edge->from, edge->to, edge->constrained ? 1u : 0u});
        return true;
      },
      &edges));
  std::vector<std::uint32_t> own;
  for (const VertexId node : nodes_of(mesh_)) own.push_back(node.value);
  EXPECT_EQ(nodes.ids, own);
  own.clear();
  for (const FeatureId feature : features_of(mesh_)) own.push_back(feature.value);
  EXPECT_EQ(features.ids, own);
  own.clear();
  for (const MeshEdge edge : edges_of(mesh_)) {
    own.insert(own.end(), {edge.from.value, edge.to.value, edge.constrained ? 1u : 0u});
  }
  EXPECT_EQ(edges.ids, own);
  Seen few{{}, 3};
  EXPECT_FALSE(etcm_nodes_of(&c_, note, &few));
  EXPECT_EQ(few.ids.size(), 3u);
}

TEST_F(CInterface, RestoresWhatItHasRead) {
  const inputs::Graph graph = inputs::random_graph(120, inputs::FeatureLength::any, 8);
  build(graph);
  std::vector<etcm_steiner_place_t> steiner;
  for (std::uint32_t i = 1; i < etcm_vertex_id_end(&c_); ++i) {
    const auto v = static_cast<etcm_vertex_t>(i);
    if (etcm_kind(&c_, v) != ETCM_KIND_STEINER) continue;
    steiner.push_back({etcm_feature_of(&c_, v), etcm_point(&c_, v)});
  }
  const std::uint64_t hash = etcm_hash(&c_);
  const auto* nodes = reinterpret_cast<const etcm_position_t*>(graph.nodes.data());
  const auto* features = reinterpret_cast<const etcm_feature_ends_t*>(graph.features.data());
  const auto restore = [&] {
    return etcm_restore(&c_, nodes, graph.nodes.size(), features, graph.features.size(),
                        steiner.data(), steiner.size(), ETCM_UNLIMITED);
  };
  EXPECT_EQ(restore(), ETCM_MESH_NOT_EMPTY);
  etcm_clear(&c_);
  ASSERT_EQ(restore(), ETCM_OK);
  EXPECT_EQ(etcm_hash(&c_), hash);
  etcm_clear(&c_);
  unsigned calls = 0;
  ASSERT_EQ(etcm_build_measured(
                &c_, nodes, graph.nodes.size(), features, graph.features.size(), ETCM_UNLIMITED,
                [](void* context) { ++*static_cast<unsigned*>(context); }, &calls),
            ETCM_OK);
  EXPECT_EQ(calls, 1u);
  EXPECT_EQ(etcm_hash(&c_), hash);
}

TEST_F(CInterface, AnswersTheSameQuestions) {
  build(inputs::random_graph(150, inputs::FeatureLength::any, 9));
  inputs::Random random(1);
  for (int i = 0; i < 50; ++i) {
    const Point place = to_point({random.between(-200, 1200), random.between(-200, 1200)});
    etcm_location_t c;
    etcm_locate(&c_, c_point(place), ETCM_NONE, &c);
    const Location own = locate(mesh_, place);
    EXPECT_EQ(c.type, static_cast<int>(own.type));
    EXPECT_EQ(c.triangle, own.triangle.value);
    EXPECT_EQ(c.side, own.side);
    EXPECT_EQ(c.vertex, own.vertex.value);
    EXPECT_EQ(etcm_nearest_node(&c_, c_point(place)), nearest_node(mesh_, place).value);
    std::array<etcm_near_node_t, 4> c_near;
    std::array<NearNode, 4> near;
    ASSERT_EQ(etcm_nearest_nodes(&c_, c_point(place), c_near.data(), 4),
              nearest_nodes(mesh_, place, near));
    for (unsigned n = 0; n < 4; ++n) {
      EXPECT_EQ(c_near[n].node, near[n].node.value);
      EXPECT_EQ(c_near[n].distance.low, near[n].distance.low);
      EXPECT_EQ(etcm_range_for(c_near[n].distance), range_for(near[n].distance));
    }
    EXPECT_EQ(etcm_nodes_within(&c_, c_point(place), 99, nullptr, 0),
              nodes_within(mesh_, place, 99, {}));
    const Point a = mesh_.point(VertexId{1});
    Point b = mesh_.point(VertexId{2}), d = mesh_.point(VertexId{3});
    if (orient2d(a, b, d) < 0) std::swap(b, d);  // incircle_perturbed() takes no clockwise triangle
    EXPECT_EQ(etcm_orient2d(c_point(a), c_point(b), c_point(place)), orient2d(a, b, place));
    EXPECT_EQ(etcm_incircle(c_point(a), c_point(b), c_point(d), c_point(place)),
              incircle(a, b, d, place));
    EXPECT_EQ(etcm_incircle_perturbed(c_point(a), c_point(b), c_point(d), c_point(place)),
              incircle_perturbed(a, b, d, place));
    const SquaredLength length = squared_distance(a, place);
    EXPECT_EQ(etcm_squared_distance(c_point(a), c_point(place)).low, length.low);
  }
  const FeatureEnds ends = mesh_.ends(*features_of(mesh_).begin());
  std::array<etcm_feature_at_t, 8> at;
  std::array<FeatureAt, 8> own_at;
  ASSERT_EQ(etcm_features_at(&c_, ends.from.value, at.data(), at.size()),
            features_at(mesh_, ends.from, own_at));
  EXPECT_EQ(at[0].feature, own_at[0].feature.value);
  EXPECT_EQ(at[0].is_end, own_at[0].is_end);
  for (const MeshEdge edge : edges_of(mesh_)) {
    EXPECT_EQ(etcm_feature_between(&c_, edge.from.value, edge.to.value),
              feature_between(mesh_, edge.from, edge.to).value);
  }
  std::vector<etcm_region_t> region(mesh_.triangle_count());
  std::vector<Region> own_region(region.size());
  std::vector<etcm_triangle_id_t> scratch(region.size());
  std::vector<TriangleId> own_scratch(region.size());
  const etcm_point_t seed = c_point(to_point({500, 500}));
  const Point own_seed = to_point({500, 500});
  ASSERT_EQ(etcm_label_domain(&c_, ETCM_EXTERIOR_HULL, &seed, 1, region.data(), region.size(),
                              scratch.data(), scratch.size()),
            ETCM_OK);
  ASSERT_EQ(label_domain(mesh_, Exterior::hull, {&own_seed, 1}, own_region, own_scratch),
            Status::ok);
  EXPECT_EQ(std::memcmp(region.data(), own_region.data(), region.size()), 0);
  EXPECT_EQ(
      etcm_label_domain(&c_, ETCM_EXTERIOR_HULL, nullptr, 0, region.data(), 1, scratch.data(), 1),
      ETCM_BUFFER_TOO_SMALL);
  etcm_audit_t audit;
  etcm_audit(&c_, &audit);
  EXPECT_EQ(audit.broken, ETCM_RULE_NONE);
  EXPECT_EQ(audit.vertex, ETCM_NONE);
  EXPECT_STREQ(etcm_rule_name(ETCM_RULE_DELAUNAY), "delaunay");
}

TEST_F(CInterface, TellsTheSameBound) {
  inputs::Graph graph = inputs::random_graph(100, inputs::FeatureLength::any, 13);
  const std::vector<FeatureEnds> features = std::exchange(graph.features, {});
  build(graph);
  std::uint32_t sum = 0;
  for (const FeatureEnds& ends : features) {
    const std::uint32_t least = least_steiner(mesh_, ends);
    EXPECT_EQ(etcm_least_steiner(&c_, ends.from.value, ends.to.value), least);
    sum += least;
  }
  EXPECT_GT(sum, 0u);
}

TEST_F(CInterface, AnalysesTheSame) {
  build(inputs::random_graph(150, inputs::FeatureLength::any, 10));
  std::vector<etcm_link_t> links_(2000);
  std::vector<Link> own_links(2000);
  const std::uint32_t count = links(mesh_, 20, own_links);
  ASSERT_EQ(etcm_links(&c_, 20, links_.data(), links_.size()), count);
  for (std::uint32_t i = 0; i < count; ++i) {
    EXPECT_EQ(links_[i].to, own_links[i].to.value);
    EXPECT_EQ(links_[i].gabriel, own_links[i].gabriel);
    EXPECT_EQ(links_[i].urquhart, own_links[i].urquhart);
  }
  EXPECT_EQ(etcm_links_at(&c_, 1, nullptr, 0), links_at(mesh_, VertexId{1}, {}));
  std::vector<etcm_connectivity_scratch_t> scratch(mesh_.vertex_id_end());
  std::vector<ConnectivityScratch> own_scratch(mesh_.vertex_id_end());
  etcm_connectivity_t network;
  Connectivity own;
  ASSERT_EQ(etcm_connectivity(&c_, 30, scratch.data(), scratch.size(), &network), ETCM_OK);
  ASSERT_EQ(connectivity(mesh_, 30, own_scratch, own), Status::ok);
  EXPECT_EQ(network.parts, own.parts);
  EXPECT_EQ(network.least.low, own.least.low);
  EXPECT_EQ(etcm_connectivity(&c_, 30, nullptr, 0, &network), ETCM_BUFFER_TOO_SMALL);
  EXPECT_EQ(etcm_relays(&c_, &c_, 15, nullptr, 0), relays(mesh_, mesh_, 15, {}));
  EXPECT_EQ(etcm_barrier_gaps(&c_, &c_, 15, nullptr, 0), barrier_gaps(mesh_, mesh_, 15, {}));
  std::array<etcm_hole_t, 4> holes;
  std::array<Hole, 4> own_holes;
  ASSERT_EQ(etcm_coverage_holes(&c_, nullptr, nullptr, 0, 15, holes.data(), holes.size()),
            coverage_holes(mesh_, {}, 15, own_holes));
  EXPECT_EQ(holes[0].position.x, own_holes[0].position.x);
  const std::vector<etcm_region_t> inside(mesh_.triangle_count(), ETCM_REGION_INSIDE);
  const std::vector<Region> own_inside(mesh_.triangle_count(), Region::inside);
  EXPECT_EQ(etcm_coverage_holes(&c_, &c_, inside.data(), inside.size(), 15, nullptr, 0),
            coverage_holes(mesh_, {&mesh_, own_inside}, 15, {}));
  const std::vector<std::int32_t> readings(mesh_.vertex_id_end(), 7);
  etcm_interpolated_t value;
  ASSERT_EQ(etcm_interpolate(&c_, etcm_point(&c_, 1), readings.data(), readings.size(), &value),
            ETCM_OK);
  EXPECT_EQ(value.type, ETCM_LOCATE_ON_VERTEX);
  EXPECT_EQ(value.value, 7 * ETCM_SUBUNITS_PER_UNIT);
}

TEST_F(CInterface, HandlesNameTheSame) {
  std::vector<std::uint32_t> numbers(ETCM_HANDLES_WORDS(vertices_max, features_max));
  ASSERT_EQ(numbers.size(), Handles::words(mesh_.config()));
  etcm_handles_t handles{};
  EXPECT_EQ(etcm_handles_open(&handles, &c_, numbers.data(), 3, 0), ETCM_STORAGE_TOO_SMALL);
  ASSERT_EQ(etcm_handles_open(&handles, &c_, numbers.data(), numbers.size(), 0), ETCM_OK);
  etcm_node_handle_t a, b, again;
  ASSERT_EQ(etcm_handles_join(&handles, {1, 1}, ETCM_UNLIMITED, &a), ETCM_OK);
  ASSERT_EQ(etcm_handles_join(&handles, {9, 1}, ETCM_UNLIMITED, &b), ETCM_OK);
  etcm_feature_handle_t feature, same;
  ASSERT_EQ(etcm_handles_add_feature(&handles, a, b, ETCM_UNLIMITED, &feature), ETCM_OK);
  ASSERT_EQ(etcm_handles_of_feature(&handles, feature.id, &same), ETCM_OK);
  EXPECT_EQ(same.number, feature.number);
  etcm_feature_t found;
  ASSERT_EQ(etcm_handles_find_feature(&handles, feature, &found), ETCM_OK);
  EXPECT_EQ(found, feature.id);
  EXPECT_EQ(etcm_handles_remove_feature(&handles, feature, ETCM_UNLIMITED), ETCM_OK);
  EXPECT_EQ(etcm_handles_find_feature(&handles, feature, &found), ETCM_STALE_HANDLE);
  EXPECT_EQ(etcm_handles_move(&handles, a, {2, 2}, ETCM_UNLIMITED), ETCM_OK);
  ASSERT_EQ(etcm_handles_of_node(&handles, a.id, &again), ETCM_OK);
  EXPECT_EQ(again.number, a.number);
  EXPECT_EQ(etcm_handles_leave(&handles, a, ETCM_UNLIMITED), ETCM_OK);
  etcm_vertex_t id;
  EXPECT_EQ(etcm_handles_find_node(&handles, a, &id), ETCM_STALE_HANDLE);
  ASSERT_EQ(etcm_handles_find_node(&handles, b, &id), ETCM_OK);
  EXPECT_EQ(id, b.id);
  EXPECT_EQ(etcm_handles_given_out(&handles), 3u);
}

TEST_F(CInterface, DryRunsTellWhatAChangeWouldComeTo) {
  build(inputs::random_graph(100, inputs::FeatureLength::any, 11));
  const auto expect = [&](const Outcome& own, const etcm_outcome_t& c) {
    EXPECT_EQ(c.status, static_cast<int>(own.status));
    EXPECT_EQ(c.detail.vertex, own.detail.vertex.value);
    EXPECT_EQ(c.steiner, own.steiner);
    EXPECT_EQ(c.work, own.work.units);
  };
  const FeatureId feature = *features_of(mesh_).begin();
  const FeatureEnds ends = mesh_.ends(feature);
  etcm_outcome_t c;
  etcm_dry_run_join(&c_, {77, 78}, ETCM_UNLIMITED, &c);
  expect(DryRun(mesh_).join({77, 78}), c);
  etcm_dry_run_leave(&c_, ends.from.value, ETCM_UNLIMITED, &c);
  expect(DryRun(mesh_).leave(ends.from), c);
  etcm_dry_run_move(&c_, ends.from.value, {5, 6}, ETCM_UNLIMITED, &c);
  expect(DryRun(mesh_).move(ends.from, {5, 6}), c);
  etcm_dry_run_add_feature(&c_, ends.from.value, ends.to.value, ETCM_UNLIMITED, &c);
  expect(DryRun(mesh_).add_feature(ends), c);
  etcm_dry_run_remove_feature(&c_, feature.value, ETCM_UNLIMITED, &c);
  expect(DryRun(mesh_).remove_feature(feature), c);
  expect_same();
}

// Looks around in every way there is, then does what it was told to.
etcm_parameter_t look_and_ask(const etcm_split_site_t* site, void* context) {
  auto& rule = *static_cast<const etcm_split_policy_t*>(context);
  etcm_surroundings_t c;
  etcm_surroundings_open(&c, site);
  const auto& own_site = *reinterpret_cast<const SplitSite*>(site);
  Surroundings own(own_site);
  EXPECT_EQ(etcm_surroundings_per_squared_length(&c), own.per_squared_length());
  for (const auto end : {Surroundings::End::head, Surroundings::End::tail}) {
    const auto c_end = static_cast<etcm_end_t>(end);
    etcm_surroundings_start(&c, c_end);
    own.start(end);
    const VertexId shared = own.shared_node(end);
    EXPECT_EQ(etcm_surroundings_shared_node(&c, c_end), shared.value);
    etcm_beside_t seen;
    Surroundings::Beside own_seen;
    for (int i = 0; i < 4 && own.next(own_seen); ++i) {
      EXPECT_TRUE(etcm_surroundings_next(&c, &seen));
      EXPECT_EQ(seen.vertex, own_seen.vertex.value);
      EXPECT_EQ(seen.aside, own_seen.aside);
      if (shared.is_none()) continue;
      EXPECT_EQ(etcm_surroundings_is_on_segment_from(&c, shared.value, seen.vertex),
                own.is_on_segment_from(shared, own_seen.vertex));
    }
  }
  const etcm_parameter_t t = rule.choose(site, rule.context);
  EXPECT_EQ(etcm_surroundings_encroachments(&c, t, 9), own.encroachments(t, 9));
  EXPECT_EQ(etcm_surroundings_encroachments_at_least(&c, t), own.encroachments_at_least(t));
  EXPECT_EQ(etcm_split_site_at(site, t).x, own_site.at(t).x);
  return t;
}

TEST_F(CInterface, KeepsAWatchdogQuiet) {
  std::uint32_t calls = 0;
  etcm_keep_alive(
      &c_, [](void* count) { ++*static_cast<std::uint32_t*>(count); }, &calls);
  build(inputs::random_graph(200, inputs::FeatureLength::any, 3));
  EXPECT_GT(calls, 20u);
  calls = 0;
  etcm_keep_alive(&c_, nullptr, nullptr);
  ASSERT_EQ(etcm_canonicalize(&c_, ETCM_UNLIMITED), ETCM_OK);
  EXPECT_EQ(calls, 0u);
}

TEST_F(CInterface, APolicyOfItsOwnSeesWhatThoseOfTheLibrarySee) {
  const inputs::Graph graph = inputs::random_graph(100, inputs::FeatureLength::any, 12);
  for (const auto choose : {etcm_split_default, etcm_split_paper}) {
    const etcm_split_policy_t rule{choose, nullptr};
    const etcm_split_policy_t looking{look_and_ask, const_cast<etcm_split_policy_t*>(&rule)};
    MeshConfig config = storage_->config();
    config.policy = choose == etcm_split_default ? split_default : split_paper;
    ASSERT_EQ(mesh_.open(storage_->bytes(), config), Status::ok);
    open(&looking);
    build(graph);
    EXPECT_EQ(etcm_hash(&c_), mesh_.hash());
    etcm_config_t told;
    etcm_config(&c_, &told);
    EXPECT_EQ(told.policy, &looking);
    EXPECT_EQ(told.vertices_max, vertices_max);
    open(&rule);
    const auto* nodes = reinterpret_cast<const etcm_position_t*>(graph.nodes.data());
    const auto* features = reinterpret_cast<const etcm_feature_ends_t*>(graph.features.data());
    ASSERT_EQ(
        etcm_build(&c_, nodes, graph.nodes.size(), features, graph.features.size(), ETCM_UNLIMITED),
        ETCM_OK);
    EXPECT_EQ(etcm_hash(&c_), mesh_.hash());
  }
}

TEST_F(CInterface, OpensAMeshWithTheHookItWasGivenBefore) {
  unsigned calls = 0, own_calls = 0;
  etcm_mesh_t other{};
  etcm_keep_alive(
      &other, [](void* count) { ++*static_cast<unsigned*>(count); }, &calls);
  mesh_.keep_alive({[](void* count) noexcept { ++*static_cast<unsigned*>(count); }, &own_calls});
  const inputs::Graph graph = inputs::random_graph(300, inputs::FeatureLength::any, 5);
  std::vector<std::uint64_t> storage(c_storage_.size());
  const etcm_config_t config{vertices_max, features_max, 0, nullptr};
  for (int turn = 0; turn < 2; ++turn) {
    ASSERT_EQ(etcm_open(&other, storage.data(), storage.size() * 8, &config), ETCM_OK);
    ASSERT_EQ(etcm_build(&other, reinterpret_cast<const etcm_position_t*>(graph.nodes.data()),
                         graph.nodes.size(), nullptr, 0, ETCM_UNLIMITED),
              ETCM_OK);
    ASSERT_EQ(mesh_.open(storage_->bytes(), storage_->config()), Status::ok);
    ASSERT_EQ(mesh_.build(graph.nodes, {}), Status::ok);
  }
  EXPECT_GT(calls, 10u);
  EXPECT_EQ(calls, own_calls);
}

TEST_F(CInterface, ARefusedCallLeavesWhatItWouldTell) {
  build(inputs::random_graph(20, inputs::FeatureLength::any, 4));
  etcm_vertex_t node = 77;
  EXPECT_EQ(etcm_join(&c_, {ETCM_POSITION_MAX + 1, 0}, ETCM_UNLIMITED, &node), ETCM_BAD_COORDINATE);
  EXPECT_EQ(node, 77u);
  etcm_interpolated_t value{};
  value.value = 77;
  EXPECT_EQ(etcm_interpolate(&c_, etcm_point(&c_, 1), nullptr, 0, &value), ETCM_BUFFER_TOO_SMALL);
  EXPECT_EQ(value.value, 77);

  std::vector<std::uint32_t> numbers(ETCM_HANDLES_WORDS(vertices_max, features_max));
  etcm_handles_t handles{};
  ASSERT_EQ(etcm_handles_open(&handles, &c_, numbers.data(), numbers.size(), 0), ETCM_OK);
  etcm_node_handle_t a, b{7, 7};
  etcm_feature_handle_t feature{7, 7};
  ASSERT_EQ(etcm_handles_join(&handles, {5001, 1}, ETCM_UNLIMITED, &a), ETCM_OK);
  EXPECT_EQ(etcm_handles_join(&handles, {5001, 1}, ETCM_UNLIMITED, &b), ETCM_DUPLICATE_VERTEX);
  EXPECT_EQ(b.number, 7u);
  EXPECT_EQ(etcm_handles_add_feature(&handles, a, b, ETCM_UNLIMITED, &feature), ETCM_STALE_HANDLE);
  EXPECT_EQ(feature.number, 7u);
}

TEST_F(CInterface, VisitsNoMoreOnceItIsToldToStop) {
  build(inputs::random_graph(20, inputs::FeatureLength::any, 4));
  int visits = 0;
  EXPECT_FALSE(etcm_nodes_of(
      &c_, [](void* context, etcm_vertex_t) { return ++*static_cast<int*>(context) < 2; },
      &visits));
  EXPECT_EQ(visits, 2);
  EXPECT_FALSE(etcm_features_of(
      &c_, [](void* context, etcm_feature_t) { return ++*static_cast<int*>(context) < 4; },
      &visits));
  EXPECT_EQ(visits, 4);
  EXPECT_FALSE(etcm_edges_of(
      &c_, [](void* context, const etcm_edge_t*) { return ++*static_cast<int*>(context) < 6; },
      &visits));
  EXPECT_EQ(visits, 6);
}

TEST_F(CInterface, RefusesWhatThatOfCxxRefuses) {
  etcm_mesh_t other{};
  etcm_config_t config{10, 0, 0, nullptr};
  std::array<std::uint64_t, 300> storage;
  EXPECT_EQ(etcm_open(&other, storage.data(), 16, &config), ETCM_STORAGE_TOO_SMALL);
  config.vertices_max = 0;
  EXPECT_EQ(etcm_validate(&config), ETCM_BAD_CONFIG);
  EXPECT_EQ(etcm_open(&other, storage.data(), sizeof storage, &config), ETCM_BAD_CONFIG);
  const etcm_split_policy_t none{nullptr, nullptr};
  config = {10, 0, 0, &none};
  EXPECT_EQ(etcm_validate(&config), ETCM_BAD_CONFIG);
  EXPECT_EQ(etcm_product(3, 7), 21);
  EXPECT_EQ(etcm_root(81), 9);
  EXPECT_STREQ(etcm_status_name(ETCM_BAD_CONFIG), "bad_config");
  EXPECT_STREQ(etcm_explain(ETCM_BAD_CONFIG), explain(Status::bad_config));
  EXPECT_STREQ(etcm_call_name(static_cast<etcm_call_t>(Call::join)), "join");
  EXPECT_STREQ(etcm_fault_name(ETCM_FAULT_NO_VERTEX), "no such vertex");
}

}  // namespace
}  // namespace etcm::test

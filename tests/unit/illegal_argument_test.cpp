// Every public call that is given what its contract rules out ends in etcm_illegal_argument(), and
// says which call it was and what was wrong.
#include "etcm/illegal_argument.h"

#include <gtest/gtest.h>

#include <array>
#include <cstdio>
#include <cstdlib>
#include <functional>
#include <set>
#include <string>
#include <vector>

#include "etcm/analysis.h"
#include "etcm/audit.h"
#include "etcm/bound.h"
#include "etcm/domain.h"
#include "etcm/dry_run.h"
#include "etcm/handles.h"
#include "etcm/incidence.h"
#include "etcm/locate.h"
#include "etcm/nearest.h"
#include "etcm/split_site.h"
#include "etcm/storage.h"
#include "inputs/random_graph.h"
#include "support/meshes.h"

extern "C" void etcm_illegal_argument(etcm::Call call, etcm::Fault fault) {
  std::fprintf(stderr, "%s: %s\n", to_string(call), to_string(fault));
  std::_Exit(1);
}

namespace etcm::test {
namespace {

// What is asked of a square with one diagonal as feature, or of a mesh that is not open.
struct Case {
  Call call;
  Fault fault;
  const char* name;
  std::function<void(Mesh&)> question;
};

void PrintTo(const Case& each, std::ostream* out) { *out << each.name; }

// For who writes down what nobody reads.
template <class Answer>
void drop(const Answer&) {}

VertexId some_vertex;
FeatureId some_feature;
Connectivity some_connectivity;
Interpolated some_value;
const VertexId v{1};
const FeatureId f{0};
const TriangleId t{0};
constexpr Call last_call = Call::policy;

// The square of each test stands here too, for calls that take two meshes.
const Mesh& open_mesh() {
  static const auto mesh = built({"", {{0, 0}, {9, 0}, {9, 9}, {0, 9}}, {between_nodes(0, 2)}});
  return **mesh;
}

const std::vector<Case> unopened{
    {Call::clear, {}, "clear", [](Mesh& m) { m.clear(); }},
    {Call::build, {}, "build", [](Mesh& m) { drop(m.build({}, {})); }},
    {Call::restore, {}, "restore", [](Mesh& m) { drop(m.restore({}, {}, {})); }},
    {Call::rebuild, {}, "rebuild", [](Mesh& m) { drop(m.rebuild()); }},
    {Call::canonicalize, {}, "canonicalize", [](Mesh& m) { drop(m.canonicalize()); }},
    {Call::work_needed, {}, "work_needed", [](Mesh& m) { drop(m.work_needed()); }},
    {Call::work_used, {}, "work_used", [](Mesh& m) { drop(m.work_used()); }},
    {Call::optimise, {}, "optimise", [](Mesh& m) { drop(m.optimise(1)); }},
    {Call::is_canonical, {}, "is_canonical", [](Mesh& m) { drop(m.is_canonical()); }},
    {Call::join, {}, "join", [](Mesh& m) { drop(m.join({}, some_vertex)); }},
    {Call::leave, {}, "leave", [](Mesh& m) { drop(m.leave(v)); }},
    {Call::move, {}, "move", [](Mesh& m) { drop(m.move(v, {})); }},
    {Call::add_feature,
     {},
     "add_feature",
     [](Mesh& m) {
       drop(m.add_feature({v, v}, some_feature));
     }},
    {Call::remove_feature, {}, "remove_feature", [](Mesh& m) { drop(m.remove_feature(f)); }},
    {Call::config, {}, "config", [](Mesh& m) { drop(m.config()); }},
    {Call::node_count, {}, "node_count", [](Mesh& m) { drop(m.node_count()); }},
    {Call::steiner_count, {}, "steiner_count", [](Mesh& m) { drop(m.steiner_count()); }},
    {Call::feature_count, {}, "feature_count", [](Mesh& m) { drop(m.feature_count()); }},
    {Call::triangle_count, {}, "triangle_count", [](Mesh& m) { drop(m.triangle_count()); }},
    {Call::finite_triangle_count,
     {},
     "finite_triangle_count",
     [](Mesh& m) { drop(m.finite_triangle_count()); }},
    {Call::unresolved, {}, "unresolved", [](Mesh& m) { drop(m.unresolved()); }},
    {Call::vertex_id_end, {}, "vertex_id_end", [](Mesh& m) { drop(m.vertex_id_end()); }},
    {Call::feature_id_end, {}, "feature_id_end", [](Mesh& m) { drop(m.feature_id_end()); }},
    {Call::error_detail, {}, "error_detail", [](Mesh& m) { drop(m.error_detail()); }},
    {Call::kind, {}, "kind", [](Mesh& m) { drop(m.kind(v)); }},
    {Call::point, {}, "point", [](Mesh& m) { drop(m.point(v)); }},
    {Call::position, {}, "position", [](Mesh& m) { drop(m.position(v)); }},
    {Call::feature_of, {}, "feature_of", [](Mesh& m) { drop(m.feature_of(v)); }},
    {Call::neighbours, {}, "neighbours", [](Mesh& m) { drop(m.neighbours(v, {})); }},
    {Call::triangle, {}, "triangle", [](Mesh& m) { drop(m.triangle(t)); }},
    {Call::is_feature, {}, "is_feature", [](Mesh& m) { drop(m.is_feature(f)); }},
    {Call::ends, {}, "ends", [](Mesh& m) { drop(m.ends(f)); }},
    {Call::chain, {}, "chain", [](Mesh& m) { drop(m.chain(f, {})); }},
    {Call::hash, {}, "hash", [](Mesh& m) { drop(m.hash()); }},
    {Call::audit, {}, "audit", [](Mesh& m) { drop(audit(m)); }},
    {Call::locate, {}, "locate", [](Mesh& m) { drop(locate(m, {})); }},
    {Call::label_domain,
     {},
     "label_domain",
     [](Mesh& m) { drop(label_domain(m, Exterior::hull, {}, {}, {})); }},
    {Call::links, {}, "links", [](Mesh& m) { drop(links(m, 0, {})); }},
    {Call::links_at, {}, "links_at", [](Mesh& m) { drop(links_at(m, v, {})); }},
    {Call::connectivity,
     {},
     "connectivity",
     [](Mesh& m) { drop(connectivity(m, 1, {}, some_connectivity)); }},
    {Call::relays, {}, "relays", [](Mesh& m) { drop(relays(m, open_mesh(), 1, {})); }},
    {Call::relays, {}, "relays_of_devices", [](Mesh& m) { drop(relays(open_mesh(), m, 1, {})); }},
    {Call::barrier_gaps,
     {},
     "barrier_gaps",
     [](Mesh& m) { drop(barrier_gaps(m, open_mesh(), 1, {})); }},
    {Call::barrier_gaps,
     {},
     "barrier_gaps_of_sensors",
     [](Mesh& m) { drop(barrier_gaps(open_mesh(), m, 1, {})); }},
    {Call::coverage_holes,
     {},
     "coverage_holes",
     [](Mesh& m) { drop(coverage_holes(m, {}, 1, {})); }},
    {Call::coverage_holes,
     {},
     "coverage_holes_of_a_domain",
     [](Mesh& m) { drop(coverage_holes(open_mesh(), {.mesh = &m}, 1, {})); }},
    {Call::interpolate,
     {},
     "interpolate",
     [](Mesh& m) { drop(interpolate(m, {}, {}, some_value)); }},
    {Call::nearest_node, {}, "nearest_node", [](Mesh& m) { drop(nearest_node(m, {})); }},
    {Call::nearest_nodes, {}, "nearest_nodes", [](Mesh& m) { drop(nearest_nodes(m, {}, {})); }},
    {Call::nodes_within, {}, "nodes_within", [](Mesh& m) { drop(nodes_within(m, {}, 0, {})); }},
    {Call::features_at, {}, "features_at", [](Mesh& m) { drop(features_at(m, v, {})); }},
    {Call::least_steiner,
     {},
     "least_steiner",
     [](Mesh& m) {
       drop(least_steiner(m, {v, v}));
     }},
    {Call::feature_between, {}, "feature_between", [](Mesh& m) { drop(feature_between(m, v, v)); }},
    {Call::handles, {}, "handles", [](Mesh& m) { drop(Handles().open(m, {})); }},
    {Call::handles, {}, "handles_of_no_mesh", [](Mesh&) { drop(Handles().leave({})); }},
    {Call::dry_run, {}, "dry_run", [](Mesh& m) { drop(DryRun(m).join({})); }},
    {Call::seal, {}, "seal", [](Mesh& m) { seal(m); }},
    {Call::saved_bytes, {}, "saved_bytes", [](Mesh& m) { drop(m.saved_bytes()); }},
    {Call::save, {}, "save", [](Mesh& m) { drop(m.save({})); }},
    {Call::load, {}, "load", [](Mesh& m) { drop(m.load({})); }},
};

void open_at(std::byte* storage) {
  const MeshConfig config = MeshStorage<4, 1>::config();
  drop(Mesh().open({storage, storage_bytes(config)}, config));
}

const VertexId no_vertex{};
const VertexId vertex_beyond{5};
const VertexId vertex_that_left{4};
const FeatureId feature_beyond{2};
const FeatureId feature_that_went{1};
const TriangleId triangle_beyond{6};

const std::vector<Case> illegal{
    {Call::open, Fault::bad_storage, "open_null_storage", [](Mesh&) { open_at(nullptr); }},
    {Call::open, Fault::bad_storage, "open_misaligned_storage",
     [](Mesh&) {
       MeshStorage<5, 1> storage;
       open_at(storage.bytes().data() + 4);
     }},
    {Call::attach, Fault::bad_storage, "attach_null_storage", [](Mesh& m) { drop(attach(m, {})); }},
    {Call::attach, Fault::bad_storage, "attach_misaligned_storage",
     [](Mesh& m) {
       MeshStorage<5, 1> storage;
       drop(attach_copy(m, storage.bytes().subspan(4)));
     }},
    {Call::attach, Fault::bad_storage, "read_misaligned_storage",
     [](Mesh&) {
       MeshStorage<5, 1> storage;
       MeshReader reader;
       drop(reader.attach(storage.bytes().subspan(4)));
     }},
    {Call::kind, Fault::no_vertex, "kind_of_none", [](Mesh& m) { drop(m.kind(no_vertex)); }},
    {Call::kind, Fault::no_vertex, "kind_beyond", [](Mesh& m) { drop(m.kind(vertex_beyond)); }},
    {Call::point, Fault::no_vertex, "point_of_none", [](Mesh& m) { drop(m.point(no_vertex)); }},
    {Call::point, Fault::no_vertex, "point_beyond", [](Mesh& m) { drop(m.point(vertex_beyond)); }},
    {Call::point, Fault::no_vertex, "point_of_one_that_left",
     [](Mesh& m) { drop(m.point(vertex_that_left)); }},
    {Call::point, Fault::no_vertex, "point_at_infinity",
     [](Mesh& m) { drop(m.point(infinite_vertex)); }},
    {Call::position, Fault::no_vertex, "position_of_none",
     [](Mesh& m) { drop(m.position(no_vertex)); }},
    {Call::feature_of, Fault::no_vertex, "feature_of_none",
     [](Mesh& m) { drop(m.feature_of(no_vertex)); }},
    {Call::neighbours, Fault::no_vertex, "neighbours_of_none",
     [](Mesh& m) { drop(m.neighbours(no_vertex, {})); }},
    {Call::neighbours, Fault::no_vertex, "neighbours_of_one_that_left",
     [](Mesh& m) { drop(m.neighbours(vertex_that_left, {})); }},
    {Call::triangle, Fault::no_triangle, "triangle_none",
     [](Mesh& m) { drop(m.triangle(TriangleId::none())); }},
    {Call::triangle, Fault::no_triangle, "triangle_beyond",
     [](Mesh& m) { drop(m.triangle(triangle_beyond)); }},
    {Call::ends, Fault::no_feature, "ends_of_none",
     [](Mesh& m) { drop(m.ends(FeatureId::none())); }},
    {Call::ends, Fault::no_feature, "ends_beyond", [](Mesh& m) { drop(m.ends(feature_beyond)); }},
    {Call::ends, Fault::no_feature, "ends_of_one_that_went",
     [](Mesh& m) { drop(m.ends(feature_that_went)); }},
    {Call::chain, Fault::no_feature, "chain_of_none",
     [](Mesh& m) { drop(m.chain(FeatureId::none(), {})); }},
    {Call::chain, Fault::no_feature, "chain_beyond",
     [](Mesh& m) { drop(m.chain(feature_beyond, {})); }},
    {Call::features_at, Fault::no_vertex, "features_at_none",
     [](Mesh& m) { drop(features_at(m, no_vertex, {})); }},
    {Call::features_at, Fault::no_vertex, "features_at_infinity",
     [](Mesh& m) { drop(features_at(m, infinite_vertex, {})); }},
    {Call::features_at, Fault::no_vertex, "features_at_one_that_left",
     [](Mesh& m) { drop(features_at(m, vertex_that_left, {})); }},
    {Call::feature_between, Fault::no_vertex, "feature_between_none_and_one",
     [](Mesh& m) { drop(feature_between(m, no_vertex, v)); }},
    {Call::feature_between, Fault::no_vertex, "feature_between_one_and_another_beyond",
     [](Mesh& m) { drop(feature_between(m, v, vertex_beyond)); }},
    {Call::feature_between, Fault::no_vertex, "feature_between_one_and_infinity",
     [](Mesh& m) { drop(feature_between(m, v, infinite_vertex)); }},
    {Call::least_steiner, Fault::has_features, "least_steiner_beside_features",
     [](Mesh& m) {
       drop(least_steiner(m, {v, v}));
     }},
    {Call::handles, Fault::bad_storage, "handles_of_a_mesh_that_is_another",
     [](Mesh& m) {
       MeshStorage<4, 1> small;
       MeshStorage<5, 2> large;
       std::array<std::uint32_t, 7> numbers{};
       Handles handles;
       drop(m.open(small.bytes(), small.config()));
       drop(handles.open(m, numbers));
       drop(m.open(large.bytes(), large.config()));
       drop(handles.leave({v, 1}));
     }},
    {Call::links_at, Fault::no_vertex, "links_at_none",
     [](Mesh& m) { drop(links_at(m, no_vertex, {})); }},
    {Call::connectivity, Fault::zero_range, "connectivity_in_no_range",
     [](Mesh& m) { drop(connectivity(m, 0, {}, some_connectivity)); }},
    {Call::relays, Fault::zero_range, "relays_in_no_range",
     [](Mesh& m) { drop(relays(m, m, 0, {})); }},
    {Call::barrier_gaps, Fault::zero_range, "barrier_gaps_in_no_range",
     [](Mesh& m) { drop(barrier_gaps(m, m, 0, {})); }},
    {Call::coverage_holes, Fault::zero_range, "coverage_holes_in_no_range",
     [](Mesh& m) { drop(coverage_holes(m, {}, 0, {})); }},
    {Call::coverage_holes, Fault::no_region, "coverage_holes_of_no_region",
     [](Mesh& m) { drop(coverage_holes(m, {.mesh = &m}, 1, {})); }},
};

// Answers of policies that are no place for a split.
const std::vector<SplitPolicy> outside{
    [](const SplitSite& site) noexcept { return site.head; },
    [](const SplitSite& site) noexcept { return site.tail; },
    [](const SplitSite& site) noexcept { return static_cast<Parameter>(site.tail + 1); },
    [](const SplitSite&) noexcept { return Parameter{-5}; },
};

std::string message(Call call, Fault fault) {
  return std::string(to_string(call)) + ": " + to_string(fault) + "\n";
}

std::string name_of(const testing::TestParamInfo<Case>& info) { return info.param.name; }

class UnopenedMesh : public testing::TestWithParam<Case> {};

TEST_P(UnopenedMesh, Stops) {
  Mesh mesh;
  EXPECT_EXIT(GetParam().question(mesh), testing::ExitedWithCode(1),
              message(GetParam().call, Fault::not_open));
}

INSTANTIATE_TEST_SUITE_P(Every, UnopenedMesh, testing::ValuesIn(unopened), name_of);

TEST(UnopenedMesh, IsAskedByEveryCall) {
  std::set<Call> asked{Call::open, Call::attach, Call::policy};
  for (const Case& each : unopened) asked.insert(each.call);
  for (int call = 0; call <= static_cast<int>(last_call); ++call) {
    EXPECT_EQ(asked.count(static_cast<Call>(call)), 1u) << to_string(static_cast<Call>(call));
  }
}

class IllegalArgument : public testing::TestWithParam<Case> {};

TEST_P(IllegalArgument, Stops) {
  const auto mesh =
      built({"", {{0, 0}, {9, 0}, {9, 9}, {0, 9}}, {between_nodes(0, 2), between_nodes(0, 1)}});
  ASSERT_EQ((*mesh)->remove_feature(feature_that_went), Status::ok);
  ASSERT_EQ((*mesh)->leave(vertex_that_left), Status::ok);
  EXPECT_EXIT(GetParam().question(**mesh), testing::ExitedWithCode(1),
              message(GetParam().call, GetParam().fault));
}

INSTANTIATE_TEST_SUITE_P(Every, IllegalArgument, testing::ValuesIn(illegal), name_of);

TEST(IllegalArgumentOfAPolicy, IsAnAnswerOutsideOfTheSubsegment) {
  const inputs::Graph graph = inputs::random_graph(60, inputs::FeatureLength::any, 3);
  for (const SplitPolicy policy : outside) {
    inputs::OwnedMesh mesh(inputs::config_for(graph, 500, policy));
    EXPECT_EXIT(drop(mesh->build(graph.nodes, graph.features)), testing::ExitedWithCode(1),
                message(Call::policy, Fault::outside));
  }
}

TEST(IllegalArgumentNames, AreOnesOwn) {
  std::set<std::string> names;
  for (int call = 0; call <= static_cast<int>(last_call); ++call) {
    EXPECT_TRUE(names.insert(to_string(static_cast<Call>(call))).second) << call;
  }
  for (int fault = 0; fault <= static_cast<int>(Fault::outside); ++fault) {
    EXPECT_TRUE(names.insert(to_string(static_cast<Fault>(fault))).second) << fault;
  }
  EXPECT_EQ(names.count("unknown"), 0u);
  EXPECT_STREQ(to_string(static_cast<Call>(static_cast<int>(last_call) + 1)), "unknown");
  EXPECT_STREQ(to_string(static_cast<Call>(255)), "unknown");
  EXPECT_STREQ(to_string(static_cast<Fault>(255)), "unknown");
}

}  // namespace
}  // namespace etcm::test

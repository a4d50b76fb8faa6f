// Properties of any mesh, on cases that shrink to the smallest one that fails.
#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include "any_graph.h"
#include "etcm/locate.h"
#include "support/meshes.h"
#include "support/oracle.h"

namespace etcm::test {
namespace {

RC_GTEST_PROP(AnyGraph, IsSoundAndIndependentOfOrder, ()) {
  const Graph graph = any_graph();
  const auto mesh = built(graph);
  RC_ASSERT(bool(is_sound(**mesh)));
  RC_ASSERT((*built(shuffled(graph, 1)))->hash() == (*mesh)->hash());
}

RC_GTEST_PROP(AnyGraph, ShiftedIsTheSameMesh, ()) {
  const Graph graph = any_graph();
  Graph shifted = graph;
  const Position by{*rc::gen::inRange(-position_max + 8, position_max - 8),
                    *rc::gen::inRange(-position_max + 8, position_max - 8)};
  for (Position& node : shifted.nodes) node = {node.x + by.x, node.y + by.y};
  const auto mesh = built(graph);
  const auto moved = built(shifted);
  RC_ASSERT(bool(passes_audit(**moved)));
  RC_ASSERT((*moved)->steiner_count() == (*mesh)->steiner_count());
  RC_ASSERT((*moved)->finite_triangle_count() == (*mesh)->finite_triangle_count());
}

RC_GTEST_PROP(AnyGraph, GrownNodeByNodeRebuildsToTheBatchMesh, ()) {
  const Graph graph = any_graph();
  const auto mesh = grown(graph);
  RC_ASSERT(bool(is_sound(**mesh)));
  RC_ASSERT((*mesh)->rebuild() == Status::ok);
  RC_ASSERT((*mesh)->hash() == (*built(graph))->hash());
}

RC_GTEST_PROP(AnyGraph, WithoutItsFeaturesIsThePlainMesh, ()) {
  const Graph graph = any_graph();
  const auto mesh = built(graph);
  for (std::size_t i = 0; i < graph.features.size(); ++i) {
    RC_ASSERT((*mesh)->remove_feature(FeatureId{static_cast<IdValue>(i)}) == Status::ok);
    RC_ASSERT(bool(passes_audit(**mesh)));
  }
  RC_ASSERT((*mesh)->steiner_count() == 0u);
  RC_ASSERT((*mesh)->hash() == (*built({"", graph.nodes, {}}))->hash());
}

RC_GTEST_PROP(AnyGraph, LocatesEveryVertexAtItself, ()) {
  const Graph graph = any_graph();
  const auto mesh = built(graph);
  for (IdValue value = 1; value < (*mesh)->vertex_id_end(); ++value) {
    if ((*mesh)->kind(VertexId{value}) == VertexKind::none) continue;
    const Location location = locate(**mesh, (*mesh)->point(VertexId{value}));
    RC_ASSERT(location.type == LocateType::on_vertex);
    RC_ASSERT(location.vertex == VertexId{value});
  }
}

}  // namespace
}  // namespace etcm::test

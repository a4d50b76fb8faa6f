#include "answer_calls.h"

#include <algorithm>
#include <limits>
#include <memory>

#include "answer_states.h"

namespace etcm::test {
namespace {

using enum Status;

const std::set<Status> room_and_bounds{out_of_vertices, out_of_features, steiner_budget, work_limit,
                                       grid_exhausted};

std::vector<Question> joins(const Mesh&) {
  std::vector<Question> all;
  for (const Position p : places()) {
    all.push_back({[p](Mesh& mesh, Work limit) {
                     VertexId id{7777};
                     const Status status = mesh.join(p, id, limit);
                     EXPECT_EQ(id == VertexId{7777}, status != ok);
                     return status;
                   },
                   [p](Mesh& mesh, Work limit) { return DryRun(mesh).join(p, limit); }});
  }
  return all;
}

std::vector<Question> leaves(const Mesh& mesh) {
  std::vector<Question> all;
  for (const VertexId v : vertex_ids(mesh)) {
    all.push_back({[v](Mesh& m, Work limit) { return m.leave(v, limit); },
                   [v](Mesh& m, Work limit) { return DryRun(m).leave(v, limit); }});
  }
  return all;
}

std::vector<Question> moves(const Mesh& mesh) {
  std::vector<Question> all;
  std::size_t turn = 0;
  for (const VertexId v : vertex_ids(mesh)) {
    for (const Position p : places()) {
      // Each node goes to some of the places, each time to others.
      if (++turn % 5 != 0) continue;
      all.push_back({[v, p](Mesh& m, Work limit) { return m.move(v, p, limit); },
                     [v, p](Mesh& m, Work limit) { return DryRun(m).move(v, p, limit); }});
    }
  }
  return all;
}

std::vector<Question> feature_additions(const Mesh& mesh) {
  std::vector<Question> all;
  for (const VertexId from : vertex_ids(mesh)) {
    for (const VertexId to : vertex_ids(mesh)) {
      const FeatureEnds ends{from, to};
      all.push_back({[ends](Mesh& m, Work limit) {
                       FeatureId id{7777};
                       const Status status = m.add_feature(ends, id, limit);
                       EXPECT_EQ(id == FeatureId{7777}, status != ok);
                       return status;
                     },
                     [ends](Mesh& m, Work limit) { return DryRun(m).add_feature(ends, limit); }});
    }
  }
  return all;
}

std::vector<Question> feature_removals(const Mesh& mesh) {
  std::vector<Question> all;
  for (const FeatureId f : feature_ids(mesh)) {
    all.push_back({[f](Mesh& m, Work limit) { return m.remove_feature(f, limit); },
                   [f](Mesh& m, Work limit) { return DryRun(m).remove_feature(f, limit); }});
  }
  return all;
}

std::vector<Graph> graphs_to_build() {
  std::vector<Graph> graphs = wrong_graphs();
  graphs.push_back({"nothing", {}, {}});
  graphs.push_back({"one", {{1, 1}}, {}});
  graphs.push_back(crossing_lines());
  graphs.push_back(needle_eye());
  return graphs;
}

std::vector<Question> builds(const Mesh&) {
  std::vector<Question> all;
  for (const Graph& graph : graphs_to_build()) {
    all.push_back(
        {[graph](Mesh& m, Work limit) { return m.build(graph.nodes, graph.features, limit); }});
  }
  return all;
}

std::vector<SteinerPlace> standing_places(const Mesh& mesh) {
  std::vector<SteinerPlace> found;
  for (const VertexId v : steiner_vertices(mesh)) {
    found.push_back({mesh.feature_of(v).value, mesh.point(v)});
  }
  return found;
}

std::vector<Question> restores(const Mesh&) {
  std::vector<Question> all;
  const auto add = [&all](const Graph& graph, const std::vector<SteinerPlace>& steiner) {
    all.push_back({[graph, steiner](Mesh& m, Work limit) {
      return m.restore(graph.nodes, graph.features, steiner, limit);
    }});
  };
  for (const Graph& graph : graphs_to_build()) add(graph, {});
  const std::vector<SteinerPlace> right = standing_places(**built(crossing_lines()));
  add(crossing_lines(), right);
  std::vector<SteinerPlace> places = right;
  places.push_back(right.front());
  add(crossing_lines(), places);
  places = right;
  places.front().feature = 9;
  add(crossing_lines(), places);
  places = right;
  places.front().point.y += 1;
  add(crossing_lines(), places);
  return all;
}

std::vector<Question> loads(const Mesh&) {
  std::vector<Question> all;
  const auto mesh = built(crossing_lines());
  std::vector<std::byte> saved((*mesh)->saved_bytes());
  EXPECT_EQ((*mesh)->save(saved), ok);
  const auto add = [&all](const std::vector<std::byte>& bytes) {
    all.push_back({[bytes](Mesh& m, Work limit) { return m.load(bytes, limit); }});
  };
  add(saved);
  for (std::size_t at = 0; at < saved.size(); at += 3) {
    std::vector<std::byte> bytes = saved;
    bytes[at] ^= std::byte{0x10};
    add(bytes);
  }
  for (const std::size_t size : {std::size_t{0}, std::size_t{8}, saved.size() - 1}) {
    add({saved.begin(), saved.begin() + static_cast<std::ptrdiff_t>(size)});
  }
  return all;
}

std::vector<Question> saves(const Mesh& mesh) {
  std::vector<Question> all;
  // What is not whole has no bytes; then the span is as long as any.
  const std::size_t bytes = mesh.unresolved() == 0 ? mesh.saved_bytes() : 4096;
  for (const std::size_t size : {std::size_t{0}, bytes - 1, bytes, bytes + 9}) {
    all.push_back({[size](Mesh& m, Work) {
      std::vector<std::byte> out(size, std::byte{0x5a});
      const Status status = m.save(out);
      const auto is_left = [](std::byte b) { return b == std::byte{0x5a}; };
      if (status != ok) {
        EXPECT_TRUE(std::all_of(out.begin(), out.end(), is_left));
      }
      return status;
    }});
  }
  return all;
}

std::vector<Question> trials(const Mesh&) {
  std::vector<Question> all;
  for (const std::uint32_t first : {0u, 1u, 5u, 4'000'000'000u}) {
    all.push_back({[first](Mesh& m, Work limit) { return m.optimise(6, first, limit); }});
  }
  all.push_back({[](Mesh& m, Work limit) { return m.optimise(0, 0, limit); }});
  return all;
}

std::vector<Question> one(const std::function<Status(Mesh&, Work)>& ask) { return {{ask}}; }

std::set<Status> promised_of_build() {
  return with({ok, bad_coordinate, duplicate_vertex, unknown_vertex, zero_length_feature,
               repeated_feature, overlapping_features, crossing_features, mesh_not_empty},
              room_and_bounds);
}

std::set<Status> promised_of_restore() {
  std::set<Status> some = with(promised_of_build(), {unknown_feature, mesh_unresolved});
  some.erase(grid_exhausted);
  return some;
}

}  // namespace

std::set<Status> with(std::set<Status> some, const std::set<Status>& more) {
  some.insert(more.begin(), more.end());
  return some;
}

// Ids in use, free ones between, those beyond, and none.
std::vector<VertexId> vertex_ids(const Mesh& mesh) {
  std::vector<VertexId> ids{VertexId::none()};
  for (IdValue i = 0; i < mesh.vertex_id_end() + 2; ++i) ids.emplace_back(i);
  return ids;
}

std::vector<FeatureId> feature_ids(const Mesh& mesh) {
  std::vector<FeatureId> ids{FeatureId::none()};
  for (IdValue i = 0; i < mesh.feature_id_end() + 2; ++i) ids.emplace_back(i);
  return ids;
}

// On features, nodes and Steiner vertices, in triangles, on the hull, outside, far away and beyond.
std::vector<Position> places() {
  std::vector<Position> all{{position_max, position_max},
                            {-position_max, 3},
                            {0, -position_max},
                            {position_max + 1, 0},
                            {0, -position_max - 1},
                            {std::numeric_limits<std::int32_t>::min(), 0},
                            {100, 1},
                            beside_the_line};
  for (const std::int32_t y : {-6, -1, 0, 1, 6}) {
    for (std::int32_t x = -1; x <= 17; x += y == 0 ? 1 : 2) all.push_back({x, y});
  }
  return all;
}

std::set<Status> promised_of_join() {
  return with({ok, bad_coordinate, duplicate_vertex, mesh_unresolved}, room_and_bounds);
}

std::set<Status> promised_of_leave() {
  std::set<Status> some = with(
      {ok, unknown_vertex, endpoint_in_use, crossing_features, mesh_unresolved}, room_and_bounds);
  some.erase(out_of_features);
  return some;
}

std::set<Status> promised_of_move() {
  return with(promised_of_join(), {unknown_vertex, overlapping_features, crossing_features});
}

std::set<Status> promised_of_addition() {
  return with({ok, unknown_vertex, zero_length_feature, repeated_feature, overlapping_features,
               crossing_features, mesh_unresolved},
              room_and_bounds);
}

std::set<Status> promised_of_removal() {
  return {ok, unknown_feature, work_limit, mesh_unresolved};
}

std::vector<MeshCall> mesh_calls() {
  const std::set<Status> again = with({ok, mesh_unresolved}, room_and_bounds);
  const Refused nothing = Refused::changes_nothing, none = Refused::leaves_none;
  std::vector<MeshCall> calls{
      {"build", promised_of_build(), none, true, true, builds},
      {"restore", promised_of_restore(), none, true, true, restores},
      {"load",
       {ok, mesh_not_empty, not_a_mesh, wrong_version, damaged, out_of_vertices, out_of_features,
        steiner_budget, work_limit},
       none,
       true,
       true,
       loads},
      {"save", {ok, buffer_too_small, mesh_unresolved}, nothing, false, false, saves},
      {"canonicalize", again, Refused::keeps_a_part, true, true,
       [](const Mesh&) { return one([](Mesh& m, Work limit) { return m.canonicalize(limit); }); }},
      {"rebuild", again, nothing, true, true,
       [](const Mesh&) { return one([](Mesh& m, Work limit) { return m.rebuild(limit); }); }},
      {"optimise", {ok, mesh_unresolved, work_limit}, Refused::keeps_a_part, true, true, trials},
      {"join", promised_of_join(), nothing, true, true, joins},
      {"leave", promised_of_leave(), nothing, true, true, leaves},
      {"move", promised_of_move(), nothing, true, true, moves},
      {"add_feature", promised_of_addition(), nothing, true, true, feature_additions},
      {"remove_feature", promised_of_removal(), nothing, true, true, feature_removals},
  };
  for (const auto& more : {calls_of_memory(), calls_by_handle(), calls_that_ask()}) {
    calls.insert(calls.end(), more.begin(), more.end());
  }
  return calls;
}

}  // namespace etcm::test

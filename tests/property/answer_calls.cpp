#include "answer_calls.h"

#include <algorithm>
#include <limits>
#include <memory>
#include <numeric>

#include "answer_states.h"
#include "etcm/handles.h"
#include "etcm/storage.h"
#include "support/mesh_block.h"

namespace etcm::test {
namespace {

using enum Status;

const std::set<Status> room_and_bounds{out_of_vertices, out_of_features, steiner_budget, work_limit,
                                       grid_exhausted};

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

// Of mesh bytes that were altered: the byte, and what it is changed with.
struct Harm {
  std::size_t at;
  unsigned char bits;
};

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

// Takes bytes of another mesh, whole or harmed; where they are whole, the first goes on with a copy
// of its own.
std::vector<Question> attachments(bool is_copy) {
  std::vector<Question> all;
  const auto add = [&](const std::function<void(MeshBlock&)>& harm, std::size_t cut = 0,
                       SplitPolicy policy = split_default) {
    all.push_back({[=](Mesh& m, Work) {
      static std::vector<std::unique_ptr<MeshBlock>> kept;
      kept.clear();
      const MeshConfig config{.vertices_max = 40, .features_max = 20};
      kept.push_back(std::make_unique<MeshBlock>(config));
      MeshBlock& block = *kept.back();
      EXPECT_EQ(block->open(block.bytes(), config), ok);
      EXPECT_EQ(block->build(crossing_lines().nodes, crossing_lines().features), ok);
      seal(*block);
      harm(block);
      const std::span<std::byte> bytes = block.bytes().first(cut != 0 ? cut : block.bytes().size());
      return is_copy ? attach_copy(m, bytes, policy) : attach(m, bytes, policy);
    }});
  };
  add([](MeshBlock&) {});
  add([](MeshBlock&) {}, 0, nullptr);
  add([](MeshBlock&) {}, 800);
  add([](MeshBlock&) {}, 8);
  for (const Harm harm :
       {Harm{0, 1}, Harm{seal_version, 0xff}, Harm{seal_id_bits, 0x70}, Harm{seal_bytes, 1}}) {
    add([harm](MeshBlock& block) { block.in_seal(harm.at) ^= static_cast<std::byte>(harm.bits); });
  }
  add([](MeshBlock& block) { std::reverse(&block.in_seal(0), &block.in_seal(0) + 8); });
  return all;
}

// Handles of all that stands, and a few that stand for nothing.
struct OpenHandles {
  explicit OpenHandles(Mesh& mesh, std::uint32_t given_out = 0)
      : words(Handles::words(mesh.config())) {
    EXPECT_EQ(handles.open(mesh, words, given_out), ok);
  }
  NodeHandle node(VertexId id) {
    NodeHandle found{VertexId{1}, 99'999};
    return handles.handle_of(id, found) == ok ? found : NodeHandle{VertexId{1}, 99'999};
  }
  std::vector<std::uint32_t> words;
  Handles handles;
};

constexpr std::uint32_t handles_most = std::numeric_limits<std::uint32_t>::max();

std::vector<Question> joins_by_handle(const Mesh&) {
  std::vector<Question> all;
  for (const std::uint32_t given_out : {0u, handles_most}) {
    for (const Position p : places()) {
      all.push_back({[=](Mesh& mesh, Work limit) {
        OpenHandles open(mesh, given_out);
        NodeHandle node;
        return open.handles.join(p, node, limit);
      }});
    }
  }
  return all;
}

std::vector<Question> leaves_by_handle(const Mesh& mesh) {
  std::vector<Question> all;
  for (const VertexId v : vertex_ids(mesh)) {
    all.push_back({[v](Mesh& m, Work limit) {
      OpenHandles open(m);
      return open.handles.leave(open.node(v), limit);
    }});
  }
  return all;
}

std::vector<Question> moves_by_handle(const Mesh& mesh) {
  std::vector<Question> all;
  std::size_t turn = 0;
  for (const VertexId v : vertex_ids(mesh)) {
    for (const Position p : places()) {
      if (++turn % 5 != 0) continue;
      all.push_back({[v, p](Mesh& m, Work limit) {
        OpenHandles open(m);
        return open.handles.move(open.node(v), p, limit);
      }});
    }
  }
  return all;
}

std::vector<Question> features_by_handle(const Mesh& mesh) {
  std::vector<Question> all;
  for (const VertexId from : vertex_ids(mesh)) {
    for (const VertexId to : vertex_ids(mesh)) {
      all.push_back({[from, to](Mesh& m, Work limit) {
        OpenHandles open(m);
        FeatureHandle feature;
        return open.handles.add_feature(open.node(from), open.node(to), feature, limit);
      }});
    }
  }
  all.push_back({[](Mesh& m, Work limit) {
    OpenHandles open(m, handles_most - 2);
    FeatureHandle feature;
    const NodeHandle from = open.node(VertexId{1}), to = open.node(VertexId{2});
    return open.handles.add_feature(from, to, feature, limit);
  }});
  return all;
}

std::vector<Question> removals_by_handle(const Mesh& mesh) {
  std::vector<Question> all;
  for (const FeatureId f : feature_ids(mesh)) {
    all.push_back({[f](Mesh& m, Work limit) {
      OpenHandles open(m);
      FeatureHandle feature;
      static_cast<void>(open.handles.handle_of(f, feature));
      return open.handles.remove_feature(feature, limit);
    }});
  }
  return all;
}

std::vector<Question> one(const std::function<Status(Mesh&, Work)>& ask) { return {{ask}}; }

std::set<Status> promised_of_build() {
  return with({ok, bad_coordinate, duplicate_vertex, unknown_vertex, zero_length_feature,
               repeated_feature, overlapping_features, crossing_features, mesh_not_empty},
              room_and_bounds);
}

const std::set<Status> of_join{ok, bad_coordinate, duplicate_vertex, mesh_unresolved};
const std::set<Status> of_leave{ok, unknown_vertex, endpoint_in_use, crossing_features,
                                mesh_unresolved};
const std::set<Status> of_addition{ok,
                                   unknown_vertex,
                                   zero_length_feature,
                                   repeated_feature,
                                   overlapping_features,
                                   crossing_features,
                                   mesh_unresolved};
const std::set<Status> of_removal{ok, unknown_feature, work_limit, mesh_unresolved};
const std::set<Status> of_attachment{ok,
                                     bad_config,
                                     not_a_mesh,
                                     wrong_byte_order,
                                     wrong_version,
                                     wrong_id_width,
                                     storage_too_small,
                                     damaged};

std::set<Status> by_handle(const std::set<Status>& some, std::set<Status> of_handles) {
  return with(some, of_handles);
}

std::vector<MeshCall> calls_by_handle() {
  const std::set<Status> join = with(of_join, room_and_bounds);
  const std::set<Status> leave = with(of_leave, room_and_bounds);
  const std::set<Status> addition = with(of_addition, room_and_bounds);
  const Refused nothing = Refused::changes_nothing;
  return {
      {"Handles::join", by_handle(join, {out_of_handles}), nothing, true, false, joins_by_handle},
      {"Handles::leave", by_handle(leave, {stale_handle}), nothing, true, false, leaves_by_handle},
      {"Handles::move", by_handle(with(with(leave, join), addition), {stale_handle}), nothing, true,
       false, moves_by_handle},
      {"Handles::add_feature", by_handle(addition, {stale_handle, out_of_handles}), nothing, true,
       false, features_by_handle},
      {"Handles::remove_feature", by_handle(of_removal, {stale_handle}), nothing, true, false,
       removals_by_handle},
  };
}

}  // namespace

std::vector<MeshCall> mesh_calls() {
  const std::set<Status> join = with(of_join, room_and_bounds);
  const std::set<Status> leave = with(of_leave, room_and_bounds);
  const std::set<Status> addition = with(of_addition, room_and_bounds);
  const std::set<Status> again = with({ok, mesh_unresolved}, room_and_bounds);
  const Refused nothing = Refused::changes_nothing, none = Refused::leaves_none;
  std::vector<MeshCall> calls{
      {"build", promised_of_build(), none, true, true, builds},
      {"restore", with(promised_of_build(), {unknown_feature, mesh_unresolved}), none, true, true,
       restores},
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
      {"join", join, nothing, true, true, joins},
      {"leave", leave, nothing, true, true, leaves},
      {"move", with(with(leave, join), addition), nothing, true, true, moves},
      {"add_feature", addition, nothing, true, true, feature_additions},
      {"remove_feature", of_removal, nothing, true, true, feature_removals},
      {"attach", of_attachment, nothing, false, false,
       [](const Mesh&) { return attachments(false); }},
      {"attach_copy", of_attachment, nothing, false, false,
       [](const Mesh&) { return attachments(true); }},
  };
  for (MeshCall& call : calls_by_handle()) calls.push_back(std::move(call));
  return calls;
}

}  // namespace etcm::test

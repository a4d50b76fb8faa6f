// The calls of Handles.
#include <limits>

#include "answer_calls.h"
#include "etcm/handles.h"

namespace etcm::test {
namespace {

using enum Status;

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

std::vector<Question> openings_of_handles(const Mesh& mesh) {
  std::vector<Question> all;
  const std::size_t words = Handles::words(mesh.config());
  for (const std::uint32_t given_out : {0u, handles_most}) {
    for (const std::size_t size : {std::size_t{0}, words - 1, words, words + 3}) {
      all.push_back({[=](Mesh& m, Work) {
        std::vector<std::uint32_t> storage(size, 0xdeadbeefu);
        Handles handles;
        const Status status = handles.open(m, storage, given_out);
        EXPECT_EQ(handles.given_out(), status == ok ? given_out : 0);
        return status;
      }});
    }
  }
  return all;
}

std::vector<Question> nodes_found(const Mesh& mesh) {
  std::vector<Question> all;
  for (const VertexId v : vertex_ids(mesh)) {
    for (const std::uint32_t off : {0u, 1u}) {
      all.push_back({[=](Mesh& m, Work) {
        OpenHandles open(m);
        NodeHandle node = open.node(v);
        node.number += off;
        VertexId id{7777};
        const Status status = open.handles.find(node, id);
        EXPECT_EQ(id, status == ok ? v : VertexId{7777});
        return status;
      }});
    }
  }
  return all;
}

std::vector<Question> features_found(const Mesh& mesh) {
  std::vector<Question> all;
  for (const FeatureId f : feature_ids(mesh)) {
    for (const std::uint32_t off : {0u, 1u}) {
      all.push_back({[=](Mesh& m, Work) {
        OpenHandles open(m);
        FeatureHandle feature;
        static_cast<void>(open.handles.handle_of(f, feature));
        feature.number += off;
        FeatureId id{7777};
        const Status status = open.handles.find(feature, id);
        EXPECT_EQ(id, status == ok ? f : FeatureId{7777});
        return status;
      }});
    }
  }
  return all;
}

// Of what stands it is the same a second time.
template <class Handle, class Named>
std::vector<Question> handles_of(const std::vector<Named>& ids) {
  std::vector<Question> all;
  for (const std::uint32_t given_out : {0u, handles_most}) {
    for (const Named id : ids) {
      all.push_back({[=](Mesh& m, Work) {
        OpenHandles open(m, given_out);
        Handle first, second;
        const Status status = open.handles.handle_of(id, first);
        EXPECT_EQ(open.handles.handle_of(id, second), status);
        EXPECT_EQ(first, second);
        EXPECT_EQ(first.number != 0, status == ok);
        return status;
      }});
    }
  }
  return all;
}

// The errors of a call by ids, but that there is no unknown id.
std::set<Status> by_handle(std::set<Status> some, const std::set<Status>& of_handles) {
  some.erase(unknown_vertex);
  some.erase(unknown_feature);
  return with(some, of_handles);
}

}  // namespace

std::vector<MeshCall> calls_by_handle() {
  const Refused nothing = Refused::changes_nothing;
  return {
      {"Handles::open", {ok, storage_too_small}, nothing, false, false, openings_of_handles},
      {"Handles::find(NodeHandle)", {ok, stale_handle}, nothing, false, false, nodes_found},
      {"Handles::find(FeatureHandle)", {ok, stale_handle}, nothing, false, false, features_found},
      {"Handles::handle_of(VertexId)",
       {ok, unknown_vertex, out_of_handles},
       nothing,
       false,
       false,
       [](const Mesh& mesh) { return handles_of<NodeHandle>(vertex_ids(mesh)); }},
      {"Handles::handle_of(FeatureId)",
       {ok, unknown_feature, out_of_handles},
       nothing,
       false,
       false,
       [](const Mesh& mesh) { return handles_of<FeatureHandle>(feature_ids(mesh)); }},
      {"Handles::join", by_handle(promised_of_join(), {out_of_handles}), nothing, true, false,
       joins_by_handle},
      {"Handles::leave", by_handle(promised_of_leave(), {stale_handle}), nothing, true, false,
       leaves_by_handle},
      {"Handles::move", by_handle(promised_of_move(), {stale_handle}), nothing, true, false,
       moves_by_handle},
      {"Handles::add_feature", by_handle(promised_of_addition(), {stale_handle, out_of_handles}),
       nothing, true, false, features_by_handle},
      {"Handles::remove_feature", by_handle(promised_of_removal(), {stale_handle}), nothing, true,
       false, removals_by_handle},
  };
}

}  // namespace etcm::test

// Every call that answers a Status, with the answers that its header promises and arguments of
// every kind.
#pragma once

#include <functional>
#include <set>
#include <string>
#include <vector>

#include "etcm/dry_run.h"
#include "support/mesh_block.h"
#include "support/meshes.h"

namespace etcm::test {

// A call with its arguments.
struct Question {
  std::function<Status(Mesh&, Work)> ask{};
  // Where there is a dry run of it.
  std::function<Outcome(Mesh&, Work)> foretell{};
  // In place of the first, where it is about the bytes in which the mesh is.
  std::function<Status(MeshBlock&)> ask_of_bytes{};
};

enum class Refused : std::uint8_t {
  changes_nothing,
  keeps_a_part,  // where it needs more work than its limit
  leaves_none    // and may leave a part undone
};

struct MeshCall {
  std::string name;  // a method of others than Mesh, and one of several, with what tells them apart
  std::set<Status> promised;
  Refused refused = Refused::changes_nothing;
  bool has_limit = true;
  bool tells_detail = true;  // error_detail() is about it
  std::function<std::vector<Question>(const Mesh&)> questions;
};

// All of them.
std::vector<MeshCall> mesh_calls();

// --- Its parts

std::vector<MeshCall> calls_of_memory();
std::vector<MeshCall> calls_by_handle();
std::vector<MeshCall> calls_that_ask();

std::set<Status> with(std::set<Status> some, const std::set<Status>& more);
std::set<Status> promised_of_join();
std::set<Status> promised_of_leave();
std::set<Status> promised_of_move();
std::set<Status> promised_of_addition();
std::set<Status> promised_of_removal();

// Ids in use, free ones between, those beyond, and none.
std::vector<VertexId> vertex_ids(const Mesh& mesh);
std::vector<FeatureId> feature_ids(const Mesh& mesh);
// On features, nodes and Steiner vertices, in triangles, on the hull, outside, far away and beyond.
std::vector<Position> places();

}  // namespace etcm::test

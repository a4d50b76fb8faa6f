// Every call that changes a mesh, writes or takes it, with the answers that its header promises and
// arguments of every kind.
#pragma once

#include <functional>
#include <set>
#include <string>
#include <vector>

#include "etcm/dry_run.h"
#include "support/meshes.h"

namespace etcm::test {

// A call with its arguments.
struct Question {
  std::function<Status(Mesh&, Work)> ask;
  // Where there is a dry run of it.
  std::function<Outcome(Mesh&, Work)> foretell{};
};

enum class Refused : std::uint8_t {
  changes_nothing,
  keeps_a_part,  // where it needs more work than its limit
  leaves_none    // and may leave a part undone
};

struct MeshCall {
  std::string name;
  std::set<Status> promised;
  Refused refused = Refused::changes_nothing;
  bool has_limit = true;
  bool tells_detail = true;  // error_detail() is about it
  std::function<std::vector<Question>(const Mesh&)> questions;
};

std::vector<MeshCall> mesh_calls();

}  // namespace etcm::test

// The cluster head of cluster_head.c in C++: it says the same.
#include <array>
#include <span>

#include "etcm/mesh.h"
#include "etcm/storage.h"
#include "messages.h"
#include "out.h"

namespace {

constexpr std::uint32_t devices_max = 16;
// The work that a message may take; docs/work.md says what a unit takes.
constexpr etcm::Work share{20'000};

// All that must outlive a reset: kept in memory that is not cleared then, or written to flash.
struct Kept {
  etcm::MeshStorage<100, 20> mesh;
  std::array<etcm::IdValue, devices_max> vertex_of;  // 0: the device has not joined
} kept;

etcm::Mesh mesh;

void say(const message_t& message, etcm::Status status) {
  constexpr std::array words{"joins", "moves", "leaves", "road"};
  out("device ");
  out_number(message.device);
  out(" ");
  out(words[message.kind]);
  out(": ");
  out(to_string(status));
  out("\n");
}

// What is refused changes nothing: the message is answered with why, and all goes on.
etcm::Status hear(const message_t& message) {
  const etcm::Position place{message.x, message.y};
  const etcm::VertexId vertex{kept.vertex_of[message.device]};
  etcm::VertexId joined;
  etcm::FeatureId feature;
  etcm::Status status = etcm::Status::ok;
  switch (message.kind) {
    case joins:
      status = mesh.join(place, joined, share);
      if (status == etcm::Status::ok) kept.vertex_of[message.device] = joined.value;
      break;
    case moves:
      status = mesh.move(vertex, place, share);
      break;
    case leaves:
      status = mesh.leave(vertex, share);
      if (status == etcm::Status::ok) kept.vertex_of[message.device] = 0;
      break;
    default:
      status =
          mesh.add_feature({vertex, etcm::VertexId{kept.vertex_of[message.other]}}, feature, share);
  }
  return status;
}

// Between messages: takes back what history has left, a share of work at a time.
void tidy_up() {
  for (int shares = 0; shares < 10 && !mesh.is_canonical(); ++shares) {
    if (mesh.canonicalize(share) != etcm::Status::work_limit) return;
  }
}

void tell_neighbours(etcm::VertexId vertex) {
  std::array<etcm::Neighbour, 8> around;
  const std::uint32_t count = mesh.neighbours(vertex, around);
  out("neighbours of vertex ");
  out_number(vertex.value);
  out(":");
  for (const etcm::Neighbour& neighbour :
       std::span(around).first(count < around.size() ? count : around.size())) {
    out(" ");
    out_number(neighbour.vertex.value);
    if (neighbour.constrained) out("=");
  }
  out("\n");
}

void tell() {
  out_number(mesh.node_count());
  out(" devices, ");
  out_number(mesh.feature_count());
  out(" roads, ");
  out_number(mesh.steiner_count());
  out(" Steiner vertices\n");
}

}  // namespace

int main() {
  if (mesh.open(kept.mesh.bytes(), kept.mesh.config()) != etcm::Status::ok) return 1;
  for (const message_t& message : messages) {
    say(message, hear(message));
    tidy_up();
  }
  tell();
  const etcm::VertexId asked{kept.vertex_of[4]};
  tell_neighbours(asked);

  // A reset: all is gone but what was kept.
  seal(mesh);
  const std::uint64_t before = mesh.hash();
  const etcm::Status status = attach(mesh, kept.mesh.bytes());
  out("after a reset: ");
  out(to_string(status));
  out(status == etcm::Status::ok && mesh.hash() == before ? ", the same mesh\n" : "\n");
  tell_neighbours(asked);
  return status == etcm::Status::ok ? 0 : 1;
}

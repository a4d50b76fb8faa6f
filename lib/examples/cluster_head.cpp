// The cluster head of cluster_head.c in C++: it says the same.
#include <array>
#include <span>

#include "etcm/mesh.h"
#include "etcm/storage.h"
#include "messages.h"
#include "out.h"

namespace {

constexpr std::uint32_t devices_max = 16, roads_max = 10;
constexpr int shares_max = roads_max + 8;  // one for each group of roads, and some to look for them
constexpr etcm::MeshConfig capacity = etcm::capacity_for(devices_max, roads_max);
// The work that a message may take: 95 ms at the most on a Cortex-M4 of 168 MHz with two cycles an
// instruction. docs/cost.md has what to set for other watchdogs and machines: a Cortex-M0+ of
// 16 MHz takes 3.5 s for as many.
constexpr etcm::Work share{20'000};

// All that must outlive a reset: in memory that is not cleared then (a section such as .noinit,
// which the linker script has to know), or written to flash and read back.
struct Kept {
  etcm::MeshStorage<capacity.vertices_max, capacity.features_max> mesh;
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

// Between messages: takes back what history has left, a share of work at a time. Where one group of
// roads needs more than a share it stays as it is, conforming all the same.
// A board kicks its watchdog before each share.
void tidy_up() {
  etcm::FeatureId last;
  for (int i = 0; i < shares_max; ++i) {
    if (mesh.canonicalize(share) != etcm::Status::work_limit) return;
    const etcm::FeatureId feature = mesh.error_detail().feature;
    // No feature is named while groups are still looked for.
    if (!feature.is_none() && feature == last) return;
    last = feature;
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

// At each start: takes up what has been kept. Where that is no mesh, as at the first start or after
// a reset in the midst of a change, it begins with an empty one, and the devices join anew.
etcm::Status wake_up() {
  const etcm::Status status = attach(mesh, kept.mesh.bytes());
  if (status == etcm::Status::ok) return status;
  kept.vertex_of = {};
  const etcm::Status opened = mesh.open(kept.mesh.bytes(), kept.mesh.config());
  return opened == etcm::Status::ok ? status : opened;
}

void say_start(etcm::Status status) {
  out("start: ");
  out(to_string(status));
  out(status == etcm::Status::ok ? ", the mesh is there\n" : ", an empty mesh\n");
}

}  // namespace

int main() {
  say_start(wake_up());
  for (const message_t& message : messages) {
    say(message, hear(message));
    tidy_up();
    // From here until the next change a reset finds the mesh whole.
    seal(mesh);
  }
  tell();
  const etcm::VertexId asked{kept.vertex_of[4]};
  tell_neighbours(asked);

  // A reset: all is gone but what was kept.
  const std::uint64_t before = mesh.hash();
  say_start(wake_up());
  tell_neighbours(asked);
  return mesh.hash() == before ? 0 : 1;
}

// One writer, four readers, and each of many thousand reads is of a whole mesh.
//
// The changes are made once without readers, and the hash after each is written down. A reader must
// find one of those, and never an earlier one than before. The writer goes on only when somebody
// has read what it has published, so that reads and changes meet; the answer does not depend on
// when.
#include <array>
#include <atomic>
#include <cstdint>
#include <cstdio>
#include <cstring>
#include <thread>

#include "etcm/audit.h"
#include "etcm/locate.h"
#include "published_mesh.h"

namespace {

using namespace etcm;

constexpr std::uint32_t vertices_max = 700, features_max = 60;
constexpr std::uint32_t change_count = 100;
constexpr unsigned reader_count = 4;

// A grid of posts with a fence through its middle, then sensors that join between them.
constexpr std::int32_t side = 12, spacing = 100;

Status set_up(Mesh& mesh, Work limit) noexcept {
  VertexId first, last, id;
  Status status = mesh.join({-50, -37}, first, limit);
  if (status == Status::ok) status = mesh.join({side * spacing, side * spacing - 13}, last, limit);
  FeatureId fence;
  if (status == Status::ok) status = mesh.add_feature({first, last}, fence, limit);
  for (std::int32_t i = 0; i < side * side && status == Status::ok; ++i) {
    status = mesh.join({i % side * spacing, i / side * spacing}, id, limit);
  }
  return status;
}

Status change(Mesh& mesh, std::uint32_t number, Work limit) noexcept {
  const auto scatter = static_cast<std::int32_t>(number * 7919u % 1'000'003u);
  VertexId id;
  return mesh.join({1 + scatter % (side * spacing), 1 + scatter / 7 % (side * spacing)}, id, limit);
}

using Hashes = std::array<std::uint64_t, change_count + 1>;

bool write_down(Hashes& hashes) {
  static MeshStorage<vertices_max, features_max> storage;
  Mesh mesh;
  if (mesh.open(storage.bytes(), storage.config()) != Status::ok) return false;
  if (set_up(mesh, Work::unlimited()) != Status::ok) return false;
  hashes[0] = mesh.hash();
  for (std::uint32_t i = 0; i < change_count; ++i) {
    // What is refused changes nothing, and is refused by both meshes.
    static_cast<void>(change(mesh, i, Work::unlimited()));
    hashes[i + 1] = mesh.hash();
  }
  return true;
}

struct Answer {
  std::uint64_t hash;
  bool is_whole;
};

Answer look(const Mesh& mesh) noexcept {
  const Location place = locate(mesh, to_point({333, 444}));
  const bool is_found = place.type != LocateType::outside;
  return {mesh.hash(), is_found && bool(audit(mesh))};
}

using Published = example::PublishedMesh<vertices_max, features_max>;

// How far a reader has come; all of them together, for the writer.
struct Progress {
  std::atomic<std::uint32_t> seen{0};
  std::atomic<std::uint64_t> reads{0};
  std::atomic<std::uint64_t> torn{0};
};

void read_on(Published& published, const Hashes& hashes, Progress& progress) {
  std::uint32_t at = 0;
  while (at < change_count) {
    const Answer answer = published.read(look);
    std::uint32_t now = at;
    while (now <= change_count && hashes[now] != answer.hash) ++now;
    if (now > change_count || !answer.is_whole) {
      ++progress.torn;
      progress.seen = change_count;
      return;
    }
    at = now;
    ++progress.reads;
    // Those that are refused leave the hash as it was: the last of them is where the mesh may be.
    while (at < change_count && hashes[at + 1] == hashes[at]) ++at;
    std::uint32_t seen = progress.seen.load();
    while (seen < at && !progress.seen.compare_exchange_weak(seen, at)) {
    }
  }
}

// A copy of a mesh at rest is another mesh, wherever it lies.
bool copy_is_read(std::uint64_t hash) {
  static MeshStorage<vertices_max, features_max> original, copy;
  Mesh mesh;
  if (mesh.open(original.bytes(), original.config()) != Status::ok) return false;
  if (set_up(mesh, Work::unlimited()) != Status::ok) return false;
  std::memcpy(copy.bytes().data(), original.bytes().data(), original.bytes().size());
  MeshReader reader;
  if (reader.attach_copy(copy.bytes()) != Status::ok) return false;
  bool is_right = false;
  std::thread other([&] { is_right = look(reader.mesh()).hash == hash; });
  VertexId id;
  const bool goes_on = mesh.join({7, 7}, id) == Status::ok;
  other.join();
  return is_right && goes_on;
}

}  // namespace

int main() {
  static Published published;
  static Hashes hashes;
  static Progress progress;
  if (!write_down(hashes) || published.open() != Status::ok) return 1;
  const auto rest = [] { std::this_thread::yield(); };
  if (published.change(set_up, Work::unlimited(), rest) != Status::ok) return 1;

  std::array<std::thread, reader_count> readers;
  for (std::thread& reader : readers)
    reader = std::thread([] { read_on(published, hashes, progress); });
  for (std::uint32_t i = 0; i < change_count; ++i) {
    while (progress.seen.load() < i) rest();
    static_cast<void>(
        published.change([i](Mesh& mesh, Work limit) noexcept { return change(mesh, i, limit); },
                         Work::unlimited(), rest));
  }
  for (std::thread& reader : readers) reader.join();

  const bool is_copied = copy_is_read(hashes[0]);
  std::printf("%s, %s\n", progress.torn == 0 ? "no read was torn" : "a read was torn",
              is_copied ? "and the copy was whole" : "but the copy was not");
  return progress.torn == 0 && progress.reads >= change_count / 2 && is_copied ? 0 : 1;
}

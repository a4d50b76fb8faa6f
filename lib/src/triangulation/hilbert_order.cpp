#include "triangulation/hilbert_order.h"

#include "base/begin_array.h"
#include "geometry/wide_int.h"
#include "triangulation/mesh_state.h"

namespace etcm::internal {
namespace {

// The place along a Hilbert curve through 2^levels x 2^levels cells.
std::uint32_t hilbert_key(std::uint32_t x, std::uint32_t y, int levels) noexcept {
  std::uint32_t key = 0;
  // The lower quadrants hold the curve mirrored at a diagonal: the left one with the axes swapped,
  // the right one with both complemented as well. Without branches: half of them would be guessed
  // wrong, which takes longer than all the rest.
  std::uint32_t swapped = 0, complemented = 0;
  for (int level = levels - 1; level >= 0; --level) {
    const std::uint32_t x_bit = (x >> level) & 1u, y_bit = (y >> level) & 1u;
    const std::uint32_t exchange = (x_bit ^ y_bit) & swapped;
    const std::uint32_t right = x_bit ^ exchange ^ complemented;
    const std::uint32_t upper = y_bit ^ exchange ^ complemented;
    key = (key << 2) | ((right * 3u) ^ upper);
    const std::uint32_t lower = upper ^ 1u;
    complemented ^= lower & right;
    swapped ^= lower;
  }
  return key;
}

// Nodes go in in four rounds, each three quarters of what is left counted from the last, and each
// along the curve: a coarse mesh of all places first, so that a new node never meets the long thin
// triangles at the edge of what the curve has filled (Amenta, Choi, Rote: Incremental constructions
// con BRIO, 2003). Which round is a hash of the index; the mesh does not depend on it. Where it
// matters more what the worst takes, there are eight rounds, each a half: however the nodes stand,
// each turns few edges then, in the mean.
std::uint32_t round_of(std::uint32_t index, Rounds rounds) noexcept {
  std::uint32_t hash = index * 2654435761u;
  hash = (hash ^ (hash >> 15)) * 2246822519u;
  hash ^= hash >> 13;
  const bool is_even = rounds == Rounds::even;
  const std::uint32_t bits = is_even ? 1 : 2;
  std::uint32_t round = is_even ? 7 : 3;
  for (; round != 0 && (hash & ((1u << bits) - 1)) == 0; hash >>= bits) --round;
  return round;
}

// Least significant digit first, in two or four stable passes from one buffer to the other and
// back.
void radix_sort(MeshState& m, OrderEntry* entries, OrderEntry* buffer, std::size_t count,
                int bits) noexcept {
  const unsigned passes = bits <= 16 ? 2 : 4;
  for (unsigned shift = 0; shift < 8 * passes; shift += 8) {
    std::uint32_t start[256] = {};
    for (std::size_t i = 0; i < count; ++i) {
      m.work.pass_entry(i);
      ++start[(entries[i].key >> shift) & 255u];
    }
    std::uint32_t sum = 0;
    for (std::uint32_t& s : start) {
      const std::uint32_t here = s;
      s = sum;
      sum += here;
    }
    for (std::size_t i = 0; i < count; ++i) {
      m.work.pass_entry(i);
      buffer[start[(entries[i].key >> shift) & 255u]++] = entries[i];
    }
    OrderEntry* const swapped = entries;
    entries = buffer;
    buffer = swapped;
  }
}

Position unit_position(const MeshState& m, IdValue i) noexcept {
  return {static_cast<std::int32_t>(m.points[i].x >> subunit_bits),
          static_cast<std::int32_t>(m.points[i].y >> subunit_bits)};
}

// Sorts entries along the curve through their own bounding box, by rounds first where there are.
void sort_along_curve(MeshState& m, OrderEntry* entries, OrderEntry* buffer, std::size_t count,
                      Rounds rounds) noexcept {
  Position low{position_max, position_max}, high{-position_max, -position_max};
  for (std::size_t i = 0; i < count; ++i) {
    m.work.pass_entry(i);
    const Position p = unit_position(m, static_cast<IdValue>(entries[i].vertex));
    if (p.x < low.x) low.x = p.x;
    if (p.y < low.y) low.y = p.y;
    if (p.x > high.x) high.x = p.x;
    if (p.y > high.y) high.y = p.y;
  }
  const auto width = static_cast<std::uint32_t>(high.x - low.x);
  const auto height = static_cast<std::uint32_t>(high.y - low.y);
  // About one node a cell; finer would only take longer.
  int levels = 1;
  while (levels < 14 && (std::size_t{1} << (2 * levels)) < count) ++levels;
  int cell_bits = 0;
  while (((width | height) >> (cell_bits + levels)) != 0) ++cell_bits;
  for (std::size_t i = 0; i < count; ++i) {
    m.work.pass(2);
    const Position p = unit_position(m, static_cast<IdValue>(entries[i].vertex));
    const auto x = static_cast<std::uint32_t>(p.x - low.x);
    const auto y = static_cast<std::uint32_t>(p.y - low.y);
    const std::uint32_t round = rounds == Rounds::none ? 0 : round_of(entries[i].vertex, rounds);
    entries[i].key = (round << (2 * levels)) | hilbert_key(x >> cell_bits, y >> cell_bits, levels);
  }
  radix_sort(m, entries, buffer, count, 2 * levels + 3);
}

// Half as many of one cell need no order.
constexpr std::size_t crowd = 64;
// Cells of crowds are cut into 8 by 8 at least, so after as many turns they are of one place.
constexpr int turns_most = 8;

// Where many stand in one cell of the curve, as all but a few may where those are far away, each
// such crowd is sorted along a curve of its own. Returns whether there was one.
bool sort_crowds(MeshState& m, OrderEntry* entries, OrderEntry* buffer,
                 std::size_t count) noexcept {
  bool found = false;
  for (std::size_t i = crowd / 2; i < count; i += crowd / 2) {
    m.work.pass(1);
    std::size_t first = i - crowd / 2;
    const std::uint32_t key = entries[first].key;
    if (entries[i].key != key) continue;
    while (first != 0 && entries[first - 1].key == key) --first;
    while (i < count && entries[i].key == key) ++i;
    if (i - first < crowd) continue;
    sort_along_curve(m, entries + first, buffer, i - first, Rounds::none);
    found = true;
  }
  return found;
}

}  // namespace

OrderEntry* hilbert_order(MeshState& m, Rounds rounds) noexcept {
  const std::size_t count = m.vertex_count();
  auto* const triangle_memory = reinterpret_cast<std::byte*>(m.topology.triangle_memory());
  std::byte* const end = triangle_memory + m.config.vertices_max * bytes_per_vertex_triangles;
  auto* const entries = begin_array<OrderEntry>(end - count * sizeof(OrderEntry), count);
  auto* const buffer = begin_array<OrderEntry>(end - 2 * count * sizeof(OrderEntry), count);
  std::size_t found = 0;
  for (IdValue i = 1; i < m.vertex_end; ++i) {
    m.work.pass_entry(i);
    if (is_in_mesh(m.owners[i].role())) entries[found++].vertex = i;
  }
  sort_along_curve(m, entries, buffer, count, rounds);
  for (int turn = 0; turn < turns_most && sort_crowds(m, entries, buffer, count); ++turn) {
  }
  return entries;
}

}  // namespace etcm::internal

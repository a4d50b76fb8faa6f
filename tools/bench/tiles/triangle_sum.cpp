#include "bench/tiles/triangle_sum.h"

#include <algorithm>

namespace etcm::bench {

namespace {

std::uint64_t mixed(std::uint64_t value) noexcept {
  value = (value ^ value >> 30) * std::uint64_t{0xbf58476d1ce4e5b9};
  value = (value ^ value >> 27) * std::uint64_t{0x94d049bb133111eb};
  return value ^ value >> 31;
}

}  // namespace

void TriangleSum::add(const Corners& corners) noexcept {
  std::uint64_t value = 0;
  for (const Point& point : corners) {
    value = mixed(value ^ static_cast<std::uint64_t>(point.x));
    value = mixed(value + static_cast<std::uint64_t>(point.y));
  }
  ++count;
  hash += value;
}

void TriangleSum::add(const TriangleSum& other) noexcept {
  count += other.count;
  hash += other.hash;
}

bool is_in(const Point& point, const Square& square) noexcept {
  const Point low = to_point(square.low), high = to_point(square.high);
  return point.x >= low.x && point.y >= low.y && point.x < high.x + subunits_per_unit &&
         point.y < high.y + subunits_per_unit;
}

void for_each_triangle(const Mesh& mesh, const Square& square,
                       const std::function<void(const Corners&)>& visit) {
  for (std::uint32_t i = 0; i < mesh.triangle_count(); ++i) {
    const Triangle triangle = mesh.triangle(TriangleId{static_cast<IdValue>(i)});
    Corners corners{};
    for (std::size_t k = 0; k < 3; ++k) {
      const VertexId vertex = triangle.corner[k];
      corners[k] = vertex == infinite_vertex ? beyond : mesh.point(vertex);
    }
    std::rotate(corners.begin(), std::min_element(corners.begin(), corners.end()), corners.end());
    if (is_in(corners[0], square)) visit(corners);
  }
}

TriangleSum triangles_in(const Mesh& mesh, const Square& square) {
  TriangleSum sum;
  for_each_triangle(mesh, square, [&](const Corners& corners) { sum.add(corners); });
  return sum;
}

}  // namespace etcm::bench

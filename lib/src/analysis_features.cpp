// Along features: relays and barrier gaps.
#include "analysis_internal.h"

namespace etcm {

using namespace internal;

namespace {

// The fewest hops of at most the range that make up the length: the least n with
// (n * range)^2 >= length. A length is below 2^26 units, and so is n.
std::uint32_t hops(const SquaredLength& length, std::uint32_t range) noexcept {
  const Int256 goal = widened(limbs(length));
  std::uint32_t fewer = 0;
  for (int bit = 26; bit >= 0; --bit) {
    const std::uint32_t next = fewer + (std::uint32_t{1} << bit);
    const Int256 reach = Wide::product(limbs(squared_range(range, 0)), Wide::product(next, next));
    if ((reach - goal).is_negative()) fewer = next;
  }
  return fewer + 1;
}

// k / n of the way, rounded down; no product leaves 64 bits.
std::int64_t part_way(std::int64_t from, std::int64_t to, std::int64_t k, std::int64_t n) noexcept {
  const std::int64_t way = to - from;
  const std::int64_t rest = way % n * k;
  return from + way / n * k + rest / n - (rest % n < 0 ? 1 : 0);
}

VertexId sensor_at(const Mesh& sensors, const Point& place) noexcept {
  return locate(sensors, place).vertex;
}

bool sees_all(const MeshState& sensors, VertexId from, VertexId to, std::uint32_t range) noexcept {
  NearestWalk walk(sensors, from, to);
  while (walk.next()) {
    if (walk.is_beyond(range)) return false;
  }
  return true;
}

}  // namespace

std::uint64_t relays(const Mesh& mesh, std::uint32_t radio_range, std::span<Relay> out) noexcept {
  ETCM_CHECK(radio_range != 0);
  const MeshState& m = state_of(mesh);
  std::uint64_t count = 0;
  const auto add = [&](const Relay& relay) {
    if (count < out.size()) out[static_cast<std::size_t>(count)] = relay;
    ++count;
  };
  for_each_piece(m, [&](SectionId s, VertexId head, VertexId tail) {
    const FeatureId feature = internal::feature_of(m, s);
    if (m.owner(head).role() != Role::node) add({m.at(head), feature, head});
    const Point& from = m.at(head);
    const Point& to = m.at(tail);
    const std::uint32_t n = hops(squared_distance(from, to), radio_range);
    for (std::uint32_t k = 1; k < n; ++k) {
      if (count >= out.size()) {
        count += n - k;
        break;
      }
      add({{part_way(from.x, to.x, k, n), part_way(from.y, to.y, k, n)}, feature, {}});
    }
  });
  return count;
}

std::uint32_t barrier_gaps(const Mesh& mesh, const Mesh& sensors, std::uint32_t sensing_range,
                           std::span<Gap> out) noexcept {
  const MeshState& m = state_of(mesh);
  const SquaredLength limit = squared_range(sensing_range, 1);
  std::uint32_t count = 0;
  // The last sensor passed: its id in either mesh.
  VertexId from{}, from_sensor{};
  for_each_piece(m, [&](SectionId s, VertexId head, VertexId tail) {
    if (head == m.section(s).from) {
      from = head;
      from_sensor = sensor_at(sensors, m.at(head));
      ETCM_CHECK(!from_sensor.is_none());
    }
    const VertexId to_sensor = sensor_at(sensors, m.at(tail));
    if (to_sensor.is_none()) {
      ETCM_CHECK(tail != m.section(s).to);
      return;
    }
    if (squared_distance(m.at(from), m.at(tail)) > limit) {
      if (count < out.size()) {
        out[count] = {internal::feature_of(m, s), from, tail,
                      sees_all(state_of(sensors), from_sensor, to_sensor, sensing_range)};
      }
      ++count;
    }
    from = tail;
    from_sensor = to_sensor;
  });
  return count;
}

}  // namespace etcm

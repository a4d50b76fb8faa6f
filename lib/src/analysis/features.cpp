// Along features: relays and barrier gaps.
#include "analysis/internal.h"
#include "geometry/wide_int.h"
#include "triangulation/circle_walk.h"
#include "triangulation/hints.h"
#include "triangulation/locate.h"
#include "triangulation/march.h"
#include "triangulation/mesh_state.h"
#include "triangulation/pulse.h"
#include "triangulation/segment_store.h"

namespace etcm {
inline namespace ETCM_IDS {

using namespace internal;

namespace {

// The fewest hops of at most the range that make up the length: the least n with
// (n * range)^2 >= length. A length is below 2^26 units, and so is n.
std::uint32_t hops(const SquaredLength& length, std::uint32_t range) noexcept {
  const Int256 goal = widened(limbs(length));
  std::uint32_t fewer = 0;
  for (int bit = 26; bit >= 0; --bit) {
    const std::uint32_t next = fewer + (std::uint32_t{1} << bit);
    const Int256 feasible =
        Wide::product(limbs(squared_range(range, 0)), Wide::product(next, next));
    if ((feasible - goal).is_negative()) fewer = next;
  }
  return fewer + 1;
}

// Whether rounding the places between n hops to sub-units can make one longer than the range: each
// of its parts becomes less than one greater. One hop more is short enough then, for it takes at
// least five sub-units off.
bool rounds_beyond(const Point& from, const Point& to, std::uint32_t n,
                   std::uint32_t range) noexcept {
  const auto most = [n](std::int64_t way) noexcept { return ((way < 0 ? -way : way) + n - 1) / n; };
  return squared_distance({0, 0}, {most(to.x - from.x), most(to.y - from.y)}) >
         squared_range(range, 0);
}

// k / n of the way, rounded down; no product leaves 64 bits.
std::int64_t part_way(std::int64_t from, std::int64_t to, std::int64_t k, std::int64_t n) noexcept {
  const std::int64_t way = to - from;
  const std::int64_t rest = way % n * k;
  return from + way / n * k + rest / n - (rest % n < 0 ? 1 : 0);
}

bool has_device(const MeshState& devices, const Point& place, Pulse& pulse) noexcept {
  const Found found = find(devices, place, edge_near(devices, place));
  pulse.pass(found.steps + 16);
  return found.type == LocateType::on_vertex;
}

// One of the features that the vertex is on, the same whatever the history; none: it is on none.
FeatureId feature_at(const MeshState& m, VertexId v) noexcept {
  const SegmentId first = m.owner(v).segment();
  if (m.owner(v).role() != Role::node) return internal::feature_of(m, first);
  FeatureId least{};
  StepBound bound(m.segment_end);
  for (SegmentId s = first; !s.is_none(); s = next_at(m, s, v)) {
    bound.step();
    const FeatureId feature = internal::feature_of(m, s);
    if (least.is_none() || feature < least) least = feature;
  }
  return least;
}

// Between two places, both included. The distance to the nearest sensor is greatest at one of them
// or where two sensors take turns.
bool sees_all(const MeshState& sensors, const Point& from, const Point& to,
              std::uint32_t range) noexcept {
  const VertexId first = nearest_vertex(sensors, from).node;
  const SquaredLength limit = squared_range(range, 0);
  if (first.is_none() || squared_distance(from, sensors.at(first)) > limit) return false;
  NearestWalk walk(sensors, from, to, first);
  while (walk.next()) {
    if (walk.is_beyond(range)) return false;
  }
  return squared_distance(to, sensors.at(walk.nearest())) <= limit;
}

// Goes along one feature after the other, from stop to stop.
class GapSearch {
 public:
  GapSearch(const MeshState& m, const MeshState& sensors, std::uint32_t range,
            std::span<Gap> out) noexcept
      : m_(m), sensors_(sensors), range_(range), out_(out), pulse_(m) {}

  std::uint32_t run() noexcept {
    for (IdValue value = 0; value < m_.segment_end; ++value) {
      const SegmentId root{value};
      if (is_linked(m_, root) && internal::feature_of(m_, root).value == value) follow(root);
    }
    return count_;
  }

 private:
  struct Stop {
    VertexId vertex{};
    bool senses = false;
  };

  Stop stop_at(VertexId v) noexcept { return {v, has_device(sensors_, m_.at(v), pulse_)}; }

  void follow(SegmentId root) noexcept {
    Stop from = stop_at(m_.segment(root).from);
    StepBound bound(m_.segment_end);
    for (SegmentId s = root; !s.is_none(); s = m_.segment(s).next) {
      bound.step();
      const VertexId end = m_.segment(s).to;
      for (VertexId head = m_.segment(s).from; head != end;) {
        head = march(m_, head, end).tail;
        const Stop to = stop_at(head);
        const bool is_last = head == end && m_.segment(s).next.is_none();
        if (!to.senses && !is_last) continue;
        look_between(internal::feature_of(m_, root), from, to);
        from = to;
      }
    }
  }

  // Each of the two that senses does so for a range of the way.
  void look_between(FeatureId feature, const Stop& from, const Stop& to) noexcept {
    const Point& start = m_.at(from.vertex);
    const Point& end = m_.at(to.vertex);
    if (from.senses || to.senses) {
      const int doublings = from.senses && to.senses ? 1 : 0;
      if (squared_distance(start, end) <= squared_range(range_, doublings)) return;
    }
    pulse_.pass(64);
    if (count_ < out_.size()) {
      out_[count_] = {feature, from.vertex, to.vertex, sees_all(sensors_, start, end, range_)};
    }
    ++count_;
  }

  const MeshState& m_;
  const MeshState& sensors_;
  const std::uint32_t range_;
  const std::span<Gap> out_;
  Pulse pulse_;
  std::uint32_t count_ = 0;
};

}  // namespace

std::uint64_t relays(const Mesh& mesh, const Mesh& devices, std::uint32_t radio_range,
                     std::span<Relay> out) noexcept {
  const MeshState& m = opened(mesh, Call::relays);
  demand(radio_range != 0, Call::relays, Fault::zero_range);
  const MeshState& with_device = opened(devices, Call::relays);
  std::uint64_t count = 0;
  const auto add = [&](const Relay& relay) noexcept {
    if (count < out.size()) out[static_cast<std::size_t>(count)] = relay;
    ++count;
  };
  Pulse pulse(m);
  for (IdValue value = 1; value < m.vertex_end; ++value) {
    const VertexId v{value};
    if (m.owner(v).role() == Role::free || has_device(with_device, m.at(v), pulse)) continue;
    add({m.at(v), feature_at(m, v), v});
  }
  for_each_subsegment(m, [&](SegmentId s, VertexId head, VertexId tail) noexcept {
    const FeatureId feature = internal::feature_of(m, s);
    const Point& from = m.at(head);
    const Point& to = m.at(tail);
    std::uint32_t n = hops(squared_distance(from, to), radio_range);
    if (rounds_beyond(from, to, n, radio_range)) ++n;
    for (std::uint32_t k = 1; k < n; ++k) {
      if (count >= out.size()) {
        count += n - k;
        break;
      }
      pulse.pass(4);
      add({{part_way(from.x, to.x, k, n), part_way(from.y, to.y, k, n)}, feature, {}});
    }
  });
  return count;
}

std::uint32_t barrier_gaps(const Mesh& mesh, const Mesh& sensors, std::uint32_t sensing_range,
                           std::span<Gap> out) noexcept {
  const MeshState& m = opened(mesh, Call::barrier_gaps);
  demand(sensing_range != 0, Call::barrier_gaps, Fault::zero_range);
  return GapSearch(m, opened(sensors, Call::barrier_gaps), sensing_range, out).run();
}

}  // namespace ETCM_IDS
}  // namespace etcm

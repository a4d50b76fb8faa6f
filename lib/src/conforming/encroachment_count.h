// What a split would cost its surroundings.
#pragma once

#include "etcm/split_site.h"
#include "triangulation/mesh_state.h"

namespace etcm::internal {

// The line of a subsegment, from its head, for what is worked out in double.
struct SubsegmentLine {
  const SplitSite& site;
  const MeshState& mesh;
  Point head;
  double dx;
  double dy;
  double per_squared_length;
};

inline SubsegmentLine line_of(const SplitSite& site) noexcept {
  const double dx = static_cast<double>(site.to.x) - site.from.x;
  const double dy = static_cast<double>(site.to.y) - site.from.y;
  return {site, state_of(*site.mesh), site.at(site.head), dx, dy, 1.0 / (dx * dx + dy * dy)};
}

// Counts what vertices at several places of one subsegment would break: the subsegments between two
// triangles whose circles both hold the place. The mesh must not change meanwhile.
class EncroachmentCount {
 public:
  explicit EncroachmentCount(const SubsegmentLine& line) noexcept : line_(line) {}

  // Works out where on the subsegment a split would break this edge, if it is a subsegment: from
  // then on at_least() counts it.
  void watch(Edge edge) noexcept;
  // How many of the watched subsegments a split at t would break. Without rounding this would be no
  // more than at() counts.
  unsigned at_least(Parameter t) const noexcept;
  // Stops at `enough`, and says that too where t is no place for a vertex. Watches what it finds.
  // Starts to look for the place at `near`.
  // O(the triangles that a vertex there would change); a few hundred bytes of stack.
  unsigned at(Parameter t, Edge near, unsigned enough) noexcept;

 private:
  // Parameters from head.
  struct Span {
    double from;
    double to;
  };
  struct Watched {
    Edge edge;
    Span breaks;
  };
  bool chord(Edge edge, Span& span) const noexcept;

  static constexpr unsigned watched_most = 4;
  const SubsegmentLine& line_;
  unsigned watched_count_ = 0;
  Watched watched_[watched_most];
};

}  // namespace etcm::internal

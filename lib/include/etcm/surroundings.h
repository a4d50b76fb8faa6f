// What stands around a missing subsegment: for split policies that look further than their site.
#pragma once

#include <cstdint>

#include "etcm/split_site.h"

namespace etcm {
inline namespace ETCM_IDS {

// The triangles that the subsegment of a site crosses, and what a vertex on it would break. It may
// be used while the policy runs that was given the site. What is a double here is near enough for a
// choice and decides nothing; it is the same on every machine. A few hundred bytes; no memory.
class Surroundings {
 public:
  explicit Surroundings(const SplitSite& site) noexcept;
  Surroundings(const Surroundings&) = delete;
  Surroundings& operator=(const Surroundings&) = delete;

  enum class End : std::uint8_t { head, tail };

  // A vertex beside the subsegment.
  struct Beside {
    VertexId vertex{};
    bool is_node = false;  // else a Steiner vertex
    Point point{};
    double along = 0;  // where it stands along the subsegment, in parameters from site.head
    double aside = 0;  // how far it stands from its line, in the same unit
  };

  // One over the squared length of the segment in user units: sub-units to parameters.
  [[nodiscard]] double per_squared_length() const noexcept { return per_squared_length_; }

  // Goes along the triangles from one end on: next() answers with the two ends of the edge that the
  // subsegment crosses first, then with the vertex of each triangle that it enters. It answers
  // false where the other end is reached, and from tail where it comes to what head's walk has
  // seen. So head comes first, and each end once.
  void start(End end) noexcept;
  [[nodiscard]] bool next(Beside& out) noexcept;

  // The node at that end of the segment (from, to), where other segments end too; else none.
  [[nodiscard]] VertexId shared_node(End end) const noexcept;
  // Whether the vertex stands on a segment that ends at the node. O(segments that end at it).
  [[nodiscard]] bool is_on_segment_from(VertexId node, VertexId vertex) const noexcept;

  // How many subsegments a vertex at t would break: those between two triangles whose circles both
  // hold the place. Stops at `enough`, and says that too where t is no place for a vertex. O(the
  // triangles that a vertex there would change).
  [[nodiscard]] unsigned encroachments(Parameter t, unsigned enough) noexcept;
  // The same of those subsegments alone that next() and encroachments() have come by, at most four.
  // Without rounding this would be no more than encroachments(). O(1).
  [[nodiscard]] unsigned encroachments_at_least(Parameter t) const noexcept;

 private:
  // Parameters from head.
  struct Span {
    double from;
    double to;
  };
  // An oriented edge of the mesh, as the library numbers them.
  using EdgeWord = IdValue;
  struct Watched {
    EdgeWord edge;
    Span breaks;
  };
  static constexpr unsigned watched_most = 4;

  [[nodiscard]] EdgeWord edge_before(TriangleId triangle, const Point& end) const noexcept;
  [[nodiscard]] bool chord(EdgeWord edge, Span& span) const noexcept;
  void watch(EdgeWord edge) noexcept;
  void watch_subsegment(EdgeWord edge) noexcept;
  void see(VertexId v, Beside& out) const noexcept;

  const SplitSite& site_;
  const internal::MeshState& mesh_;
  // The line of the subsegment, from head.
  Point head_;
  double dx_;
  double dy_;
  double per_squared_length_;
  // Opposite head and tail in the triangles by which the subsegment leaves and arrives.
  EdgeWord head_edge_;
  EdgeWord tail_edge_;
  // The walk: the edge that is crossed next, and the one at which it ends.
  EdgeWord edge_ = TriangleId::none_value;
  EdgeWord stop_ = TriangleId::none_value;
  End end_ = End::head;
  std::uint8_t told_ = 0;  // of the ends of the first edge
  std::uint8_t watched_count_ = 0;
  Watched watched_[watched_most];
};

}  // namespace ETCM_IDS
}  // namespace etcm

#include <cmath>

#include "conforming/encroachment_count.h"
#include "etcm/policy.h"
#include "etcm/split_site.h"
#include "geometry/predicates_inline.h"
#include "triangulation/mesh_state.h"
#include "triangulation/segment_store.h"

namespace etcm {
inline namespace ETCM_IDS {
namespace {

using internal::Edge;
using internal::MeshState;
using internal::SegmentId;
using internal::Topology;

// Reduces a parameter to the open subsegment; only the middle of a subsegment that is one step long
// cannot.
Parameter within(const SplitSite& site, Parameter t) noexcept {
  if (t <= site.head) return static_cast<Parameter>(site.head + 1);
  if (t >= site.tail) return static_cast<Parameter>(site.tail - 1);
  return t;
}

// Where a split aims at another vertex, it leaves that vertex's feature a neighbour at its side
// instead of one in the way: worth so many times the length it finishes.
constexpr double aimed_worth = 1.7;
// The same where it aims at a Steiner vertex so near, against the longest part that one split can
// finish, that its feature runs beside this one. Among parallels too every place returns on all of
// them, so one that is there is better than a new one; but no better than to break a subsegment.
constexpr double aligned_worth = 2.0;
constexpr double beside = 0.03;
// The same where both features leave a node at an angle below `narrow`, and both vertices stand at
// one distance from it. In a fan every distance at which one feature has a vertex returns on its
// neighbours; so the fewer the distances, the fewer the vertices, whatever this split breaks.
constexpr double ring_worth = 3.0;
constexpr double narrow = 0.1;
// In the overlap every split finishes both ends; the middle is better by this much.
constexpr double middle_bonus = 0.1;
// No split stands nearer to a node than this part of the subsegment, unless it aims at another
// node.
constexpr double nearest_to_node = 0.003;
// From each end of the subsegment, the vertices of this many triangles at most, ...
constexpr int triangles_most = 6;
// ... and of this many at least, even where they stand beside nothing that can be finished.
constexpr int triangles_least = 2;

// The candidates for one split and what each is worth, in units of the longest part that one split
// can finish. In double: a choice, not a test, and + - * / sqrt give the same bits everywhere.
class Choice {
 public:
  explicit Choice(const SplitSite& site) noexcept
      : site_(site),
        mesh_(state_of(*site.mesh)),
        line_(internal::line_of(site)),
        encroachments_(line_),
        head_edge_(edge_before(site.head_triangle, line_.head)),
        tail_edge_(edge_before(site.tail_triangle, site.at(site.tail))),
        from_(shared_node(mesh_.topology.apex(head_edge_), site.head_is_node, true)),
        to_(shared_node(mesh_.topology.apex(tail_edge_), site.tail_is_node, false)),
        length_(site.tail - site.head),
        nearest_(nearest_to_node * length_),
        overlap_(site.feasible_head >= site.feasible_tail) {
    const Parameter at_head = site.feasible_head - site.head;
    const Parameter at_tail = site.tail - site.feasible_tail;
    per_longest_ = 1.0 / (at_head > at_tail ? at_head : at_tail);
  }

  Parameter best() noexcept;

 private:
  // Where a vertex stands along the subsegment, in parameters from head, and on which side.
  struct View {
    double along;
    internal::Cross across;
  };

  View view(VertexId v) const noexcept;
  bool is_clear_of_nodes(Parameter t) const noexcept;
  void add(Parameter t, double worth) noexcept;
  void add_clear(Parameter t) noexcept;
  void add_ends() noexcept;
  void add_fractions() noexcept;
  VertexId shared_node(VertexId end, bool is_node, bool at_from) const noexcept;
  bool ends_at(VertexId v, VertexId node) const noexcept;
  void aim_at(VertexId v, const View& seen) noexcept;
  void aim_along(double along, VertexId v, double worth) noexcept;
  Edge edge_before(TriangleId triangle, const Point& end) const noexcept;
  Edge look_along(Edge e, Edge stop) noexcept;
  void look_around() noexcept;
  void choose() noexcept;

  const SplitSite& site_;
  const MeshState& mesh_;
  internal::SubsegmentLine line_;
  internal::EncroachmentCount encroachments_;
  // By which the subsegment leaves head's triangle and enters tail's.
  Edge head_edge_;
  Edge tail_edge_;
  // The nodes at the ends of the segment, where other features end too.
  VertexId from_;
  VertexId to_;
  double length_;
  double nearest_;
  bool overlap_;
  double per_longest_;
  // Rarely more than a dozen; what finds no room goes without.
  static constexpr int capacity = 19;
  int count_ = 0;
  Parameter places_[capacity];
  double gains_[capacity];
  double best_score_ = -1e9;
  Parameter best_ = 0;
};

Choice::View Choice::view(VertexId v) const noexcept {
  const internal::Offset at = internal::offset(mesh_.at(v), line_.head);
  return {(at.x * line_.dx + at.y * line_.dy) * line_.per_squared_length,
          internal::cross({line_.dx, line_.dy}, at)};
}

// Candidates outside both feasible sets, or in only one where both can be had, are none.
void Choice::add(Parameter t, double worth) noexcept {
  if (count_ == capacity || t <= site_.head || t >= site_.tail) return;
  const bool finishes_head = t <= site_.feasible_head, finishes_tail = t >= site_.feasible_tail;
  double gain = 0;
  if (overlap_) {
    if (!finishes_head || !finishes_tail) return;
    const double half = (site_.feasible_head - site_.feasible_tail) / 2.0 + 1.0;
    gain = 1.0 - middle_bonus * std::fabs(t - (site_.feasible_tail + half)) / half;
  } else if (finishes_head) {
    gain = (t - site_.head) * per_longest_;
  } else if (finishes_tail) {
    gain = (site_.tail - t) * per_longest_;
  } else {
    return;
  }
  places_[count_] = t;
  gains_[count_] = gain * worth;
  ++count_;
}

bool Choice::is_clear_of_nodes(Parameter t) const noexcept {
  return !(site_.head_is_node && t - site_.head < nearest_) &&
         !(site_.tail_is_node && site_.tail - t < nearest_);
}

void Choice::add_clear(Parameter t) noexcept {
  if (is_clear_of_nodes(t)) add(t, 1.0);
}

void Choice::add_ends() noexcept {
  if (overlap_) {
    add_clear(static_cast<Parameter>(site_.feasible_tail +
                                     (site_.feasible_head - site_.feasible_tail) / 2));
  } else {
    add_clear(site_.feasible_head);
    add_clear(site_.feasible_tail);
  }
}

// Where nothing stands to aim at, some way short of the longest part may harm less.
void Choice::add_fractions() noexcept {
  if (overlap_) {
    const std::int64_t span = site_.feasible_head - site_.feasible_tail;
    for (int eighth = 0; eighth <= 8; ++eighth) {
      add_clear(static_cast<Parameter>(site_.feasible_tail + span * eighth / 8));
    }
    return;
  }
  const std::int64_t at_head = site_.feasible_head - site_.head;
  const std::int64_t at_tail = site_.tail - site_.feasible_tail;
  for (int tenth = 9; tenth >= 3; tenth -= 2) {
    add_clear(static_cast<Parameter>(site_.head + at_head * tenth / 10));
    add_clear(static_cast<Parameter>(site_.tail - at_tail * tenth / 10));
  }
}

// An end of the segment on which the subsegment lies, where another one ends there too; else none.
VertexId Choice::shared_node(VertexId end, bool is_node, bool at_from) const noexcept {
  const auto& segment = mesh_.segment(mesh_.owner(end).segment());
  const VertexId node = is_node ? end : at_from ? segment.from : segment.to;
  const SegmentId first = mesh_.owner(node).segment();
  return next_at(mesh_, first, node).is_none() ? VertexId::none() : node;
}

// Whether v stands on a feature segment that ends at the node.
bool Choice::ends_at(VertexId v, VertexId node) const noexcept {
  const auto owner = mesh_.owner(v);
  for (SegmentId s = owner.segment(); !s.is_none(); s = next_at(mesh_, s, v)) {
    const auto& r = mesh_.segment(s);
    if (r.from == node || r.to == node) return true;
    if (owner.role() != internal::Role::node) return false;
  }
  return false;
}

void Choice::aim_along(double along, VertexId v, double worth) noexcept {
  if (!(along > 0 && along < length_)) return;
  const auto t = static_cast<Parameter>(site_.head + static_cast<Parameter>(along));
  if (is_clear_of_nodes(t) || mesh_.owner(v).role() == internal::Role::node) add(t, worth);
}

void Choice::aim_at(VertexId v, const View& seen) noexcept {
  const double aside = std::fabs(seen.across.value) * line_.per_squared_length;
  // On a feature that shares a node with this one, the same distance from there: the two vertices
  // and the node are isosceles, so neither is in the other's way.
  const auto distance_from = [&](VertexId node) {
    const internal::Offset at = internal::offset(mesh_.at(v), mesh_.at(node));
    return std::sqrt(internal::lift(at) * line_.per_squared_length);
  };
  const auto worth = [&](double distance) {
    return aside < narrow * distance ? ring_worth : aimed_worth;
  };
  if (!from_.is_none() && ends_at(v, from_)) {
    const double distance = distance_from(from_);
    aim_along(std::floor(distance + 0.5) - site_.head, v, worth(distance));
  }
  if (!to_.is_none() && ends_at(v, to_)) {
    const double distance = distance_from(to_);
    aim_along(std::ceil(parameter_end - distance - 0.5) - site_.head, v, worth(distance));
  }
  // Else straight beside it, where the subsegment's two parts see it under no more than a right
  // angle.
  const bool is_aligned =
      aside * per_longest_ < beside && mesh_.owner(v).role() != internal::Role::node;
  aim_along(seen.along, v, is_aligned ? aligned_worth : aimed_worth);
}

// Opposite the end of the subsegment in its triangle.
Edge Choice::edge_before(TriangleId triangle, const Point& end) const noexcept {
  Edge e = Topology::edge(triangle.value, 0);
  while (mesh_.at(mesh_.topology.apex(e)) != end) e = Topology::next(e);
  return e;
}

// Aims at the vertices of the triangles that the subsegment crosses, from one end on, and has the
// subsegments among their sides watched. Returns the edge before which it stopped; none: at the
// other end.
Edge Choice::look_along(Edge e, Edge stop) noexcept {
  const Topology& topo = mesh_.topology;
  const bool from_head = e == head_edge_;
  aim_at(topo.target(e), view(topo.target(e)));
  aim_at(topo.origin(e), view(topo.origin(e)));
  encroachments_.watch(Topology::next(e));
  encroachments_.watch(Topology::prev(e));
  for (int triangles = 1; triangles <= triangles_most && e != stop; ++triangles) {
    const Edge beyond = topo.twin(e);
    const VertexId v = topo.apex(beyond);
    const View seen = view(v);
    int side = internal::orient2d_filter(seen.across);
    if (side == 0) {
      side = internal::orient2d_settle(to_point(site_.from), to_point(site_.to), mesh_.at(v));
    }
    const Edge after = Topology::next(beyond), before = Topology::prev(beyond);
    if (side == 0) {
      encroachments_.watch(after);
      encroachments_.watch(before);
      return {};
    }
    aim_at(v, seen);
    // From head the left comes at the end of an edge, from tail at its start.
    const bool onward = (side > 0) == from_head;
    e = onward ? after : before;
    encroachments_.watch(onward ? before : after);
    const bool is_past = from_head ? seen.along > site_.feasible_head - site_.head
                                   : seen.along < site_.feasible_tail - site_.head;
    if (is_past && triangles >= triangles_least) break;
  }
  return e;
}

void Choice::look_around() noexcept {
  const Edge met = look_along(head_edge_, {});
  if (!met.is_none()) look_along(tail_edge_, mesh_.topology.twin(met));
}

// Takes the candidate with the greatest gain less the subsegments it would break, each of which
// costs about one more split. The most promising come first, and harm is counted only where the
// candidate could still win.
void Choice::choose() noexcept {
  constexpr double used = -1e9;
  constexpr double most_harm = 100.0;
  for (;;) {
    int next = -1;
    double most = best_score_;
    for (int i = 0; i < count_; ++i) {
      if (!(gains_[i] > best_score_)) continue;
      const double score = gains_[i] - encroachments_.at_least(places_[i]);
      if (score > most || (next >= 0 && score == most && places_[i] < places_[next])) {
        next = i;
        most = score;
      }
    }
    if (next < 0) return;
    const bool near_head = places_[next] - site_.head <= site_.tail - places_[next];
    const Edge near = near_head ? head_edge_ : tail_edge_;
    const double room = gains_[next] - best_score_;
    // What harms more cannot win.
    const auto enough = static_cast<unsigned>(room < most_harm ? room : most_harm) + 1;
    const double score = gains_[next] - encroachments_.at(places_[next], near, enough);
    gains_[next] = used;
    if (score > best_score_) {
      best_score_ = score;
      best_ = places_[next];
    }
  }
}

Parameter Choice::best() noexcept {
  look_around();
  add_ends();
  choose();
  // No fraction is worth more than this.
  if (best_score_ < (overlap_ ? 1.0 - middle_bonus / 4 : 0.9)) {
    add_fractions();
    choose();
  }
  return best_ == 0 ? split_paper(site_) : best_;
}

}  // namespace

Parameter split_paper(const SplitSite& site) noexcept {
  if (site.feasible_head >= site.feasible_tail) {
    return within(site, static_cast<Parameter>(site.feasible_tail +
                                               (site.feasible_head - site.feasible_tail) / 2));
  }
  const Parameter from_head = site.feasible_head - site.head;
  const Parameter from_tail = site.tail - site.feasible_tail;
  // Both parts lie on one line, so parameters compare as lengths do. Equal: the head, which is the
  // lexicographically smaller end however the feature was given.
  return within(site, from_head >= from_tail ? site.feasible_head : site.feasible_tail);
}

Parameter split_default(const SplitSite& site) noexcept { return Choice(site).best(); }

}  // namespace ETCM_IDS
}  // namespace etcm

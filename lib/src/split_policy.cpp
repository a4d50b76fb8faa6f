#include <cmath>

#include "etcm/policy.h"
#include "etcm/split_site.h"
#include "predicates_inline.h"
#include "split_harm.h"

namespace etcm {
namespace {

using internal::Edge;
using internal::MeshState;
using internal::SectionId;
using internal::Topology;

// Reduces a parameter to the open piece; only the middle of a piece that is one step long cannot.
Parameter within(const SplitSite& site, Parameter t) noexcept {
  if (t <= site.head) return static_cast<Parameter>(site.head + 1);
  if (t >= site.tail) return static_cast<Parameter>(site.tail - 1);
  return t;
}

// Where a split aims at another vertex, it leaves that vertex's feature a neighbour at its side
// instead of one in the way: worth this much more of the length it finishes.
constexpr double aimed_bonus = 0.7;
// In the overlap every split finishes both ends; the middle is better by this much.
constexpr double middle_bonus = 0.1;
// No split stands nearer to a node than this part of the piece, unless it aims at another node.
constexpr double nearest_to_node = 0.003;
// The march along the piece looks at this many vertices at least, and collects them while they
// stand beside what can be finished.
constexpr int vertices_looked_at = 3;
constexpr int vertices_collected = 6;

// The candidates for one split and what each is worth, in units of the longest part that one split
// can finish. In double: a choice, not a test, and + - * / sqrt give the same bits everywhere.
class Choice {
 public:
  explicit Choice(const SplitSite& site) noexcept
      : site_(site),
        mesh_(state_of(*site.mesh)),
        dx_(static_cast<double>(site.to.x) - site.from.x),
        dy_(static_cast<double>(site.to.y) - site.from.y),
        per_squared_length_(1.0 / (dx_ * dx_ + dy_ * dy_)),
        overlap_(site.reach_head >= site.reach_tail) {
    const Parameter at_head = site.reach_head - site.head;
    const Parameter at_tail = site.tail - site.reach_tail;
    per_longest_ = 1.0 / (at_head > at_tail ? at_head : at_tail);
  }

  Parameter best() noexcept;

 private:
  struct Aim {
    bool at_node;
    double bonus;
  };
  static constexpr Aim nothing{false, 0.0};

  void add(Parameter t, Aim aim) noexcept;
  void add_fractions() noexcept;
  void add_vertices(TriangleId triangle, const Point& start, const Point& goal) noexcept;
  void aim_at(VertexId v) noexcept;
  bool ends_at(VertexId v, const Point& node) const noexcept;
  Parameter clamp(double t) const noexcept;
  Parameter foot_of(const Point& p) const noexcept;
  double distance(const Point& p, const Point& q) const noexcept;
  Parameter least_harmful() noexcept;

  const SplitSite& site_;
  const MeshState& mesh_;
  double dx_;
  double dy_;
  double per_squared_length_;
  bool overlap_;
  double per_longest_;
  // Two ends of the reach, at most 8 fractions of it, and one or two for each vertex on both ways.
  static constexpr int capacity = 2 + 8 + 16;
  int count_ = 0;
  Parameter places_[capacity];
  double gains_[capacity];
};

Parameter Choice::clamp(double t) const noexcept {
  if (!(t > site_.head)) return site_.head;
  if (t >= site_.tail) return site_.tail;
  return static_cast<Parameter>(t);
}

// The foot of the perpendicular from p.
Parameter Choice::foot_of(const Point& p) const noexcept {
  const Point from = to_point(site_.from);
  return clamp((static_cast<double>(p.x - from.x) * dx_ + static_cast<double>(p.y - from.y) * dy_) *
               per_squared_length_);
}

// In parameters of this stretch.
double Choice::distance(const Point& p, const Point& q) const noexcept {
  const auto x = static_cast<double>(p.x - q.x), y = static_cast<double>(p.y - q.y);
  return std::sqrt((x * x + y * y) * per_squared_length_);
}

void Choice::add(Parameter t, Aim aim) noexcept {
  if (count_ == capacity || t <= site_.head || t >= site_.tail) return;
  const Parameter from_head = t - site_.head, from_tail = site_.tail - t;
  if (!aim.at_node) {
    const double nearest = nearest_to_node * (site_.tail - site_.head);
    if ((site_.head_is_node && from_head < nearest) ||
        (site_.tail_is_node && from_tail < nearest)) {
      return;
    }
  }
  double gain = 0;
  const bool finishes_head = t <= site_.reach_head, finishes_tail = t >= site_.reach_tail;
  if (overlap_) {
    if (!finishes_head || !finishes_tail) return;
    const double half = (site_.reach_head - site_.reach_tail) / 2.0 + 1.0;
    gain = 1.0 - middle_bonus * std::fabs(t - (site_.reach_tail + half)) / half;
  } else if (finishes_head) {
    gain = from_head * per_longest_;
  } else if (finishes_tail) {
    gain = from_tail * per_longest_;
  } else {
    return;
  }
  places_[count_] = t;
  gains_[count_] = gain * (1.0 + aim.bonus);
  ++count_;
}

// Where nothing stands to aim at, some way short of the longest part may harm less.
void Choice::add_fractions() noexcept {
  if (overlap_) {
    const std::int64_t span = site_.reach_head - site_.reach_tail;
    for (int eighth = 0; eighth <= 8; ++eighth) {
      add(static_cast<Parameter>(site_.reach_tail + span * eighth / 8), nothing);
    }
    return;
  }
  const std::int64_t at_head = site_.reach_head - site_.head;
  const std::int64_t at_tail = site_.tail - site_.reach_tail;
  for (int tenth = 9; tenth >= 3; tenth -= 2) {
    add(static_cast<Parameter>(site_.head + at_head * tenth / 10), nothing);
    add(static_cast<Parameter>(site_.tail - at_tail * tenth / 10), nothing);
  }
}

// Whether v stands on a feature stretch that ends at the node.
bool Choice::ends_at(VertexId v, const Point& node) const noexcept {
  const auto owner = mesh_.owner(v);
  for (SectionId s = owner.section(); !s.is_none(); s = next_at(mesh_, s, v)) {
    const auto& r = mesh_.section(s);
    if (mesh_.at(r.from) == node || mesh_.at(r.to) == node) return true;
    if (owner.role() != internal::Role::node) return false;
  }
  return false;
}

void Choice::aim_at(VertexId v) noexcept {
  const Point& p = mesh_.at(v);
  const Aim aim{mesh_.owner(v).role() == internal::Role::node, aimed_bonus};
  // On a feature that shares this one's node, the same distance from there: the two vertices and
  // the node are isosceles, so neither is in the other's way.
  if (site_.head_is_node) {
    const Point node = site_.at(site_.head);
    if (ends_at(v, node)) add(clamp(std::floor(site_.head + distance(p, node) + 0.5)), aim);
  }
  if (site_.tail_is_node) {
    const Point node = site_.at(site_.tail);
    if (ends_at(v, node)) add(clamp(std::ceil(site_.tail - distance(p, node) - 0.5)), aim);
  }
  // Else straight beside it, where the piece's two parts see it under no more than a right angle.
  add(foot_of(p), aim);
}

// Aims at the vertices of the triangles that the piece crosses, from one end on.
void Choice::add_vertices(TriangleId triangle, const Point& start, const Point& goal) noexcept {
  const Topology& topo = mesh_.topology;
  Edge e{};
  for (unsigned side = 0; side < 3; ++side) {
    const VertexId v = topo.triangle(triangle.value).corner[side];
    if (v != infinite_vertex && mesh_.at(v) == start) e = Topology::edge(triangle.value, side);
  }
  const bool from_head = start < goal;
  aim_at(topo.target(e));
  aim_at(topo.origin(e));
  for (int looked = 0; looked < vertices_collected * 4; ++looked) {
    const Edge beyond = topo.twin(e);
    const VertexId v = topo.apex(beyond);
    const int side = internal::orient2d_fast(start, goal, mesh_.at(v));
    if (side == 0) return;
    const Parameter foot = foot_of(mesh_.at(v));
    if (from_head ? foot > site_.reach_head : foot < site_.reach_tail) {
      if (looked > vertices_looked_at) return;
    } else {
      aim_at(v);
    }
    e = side > 0 ? Topology::next(beyond) : Topology::prev(beyond);
  }
}

// The candidate with the greatest gain less the subsegments it would break, each of which costs
// about one more split. The most promising come first, and harm is counted only where the gain
// could still win.
Parameter Choice::least_harmful() noexcept {
  constexpr double used = -1.0;
  constexpr double worst_harm = 100.0;
  internal::HarmCount harm_count(mesh_);
  double best_score = -1e9;
  Parameter best = site_.head;
  for (;;) {
    int next = -1;
    for (int i = 0; i < count_; ++i) {
      if (gains_[i] <= best_score || gains_[i] == used) continue;
      if (next < 0 || gains_[i] > gains_[next] ||
          (gains_[i] == gains_[next] && places_[i] < places_[next])) {
        next = i;
      }
    }
    if (next < 0) return best;
    const Parameter t = places_[next];
    const bool near_head = t - site_.head <= site_.tail - t;
    const TriangleId near = near_head ? site_.head_triangle : site_.tail_triangle;
    // What harms more cannot win.
    const auto enough = best_score < -worst_harm
                            ? static_cast<unsigned>(worst_harm)
                            : static_cast<unsigned>(gains_[next] - best_score) + 1;
    const unsigned harm = harm_count.at(site_.at(t), Topology::edge(near.value, 0), enough);
    const double score = gains_[next] - harm;
    gains_[next] = used;
    if (score > best_score) {
      best_score = score;
      best = t;
    }
  }
}

Parameter Choice::best() noexcept {
  if (overlap_) {
    add(static_cast<Parameter>(site_.reach_tail + (site_.reach_head - site_.reach_tail) / 2),
        nothing);
  } else {
    add(site_.reach_head, nothing);
    add(site_.reach_tail, nothing);
  }
  add_fractions();
  const Point head = site_.at(site_.head), tail = site_.at(site_.tail);
  add_vertices(site_.head_triangle, head, tail);
  add_vertices(site_.tail_triangle, tail, head);
  return count_ == 0 ? split_paper(site_) : least_harmful();
}

}  // namespace

Parameter split_paper(const SplitSite& site) noexcept {
  if (site.reach_head >= site.reach_tail) {
    return within(
        site, static_cast<Parameter>(site.reach_tail + (site.reach_head - site.reach_tail) / 2));
  }
  const Parameter from_head = site.reach_head - site.head;
  const Parameter from_tail = site.tail - site.reach_tail;
  // Both parts lie on one line, so parameters compare as lengths do. Equal: the head, which is the
  // lexicographically smaller end however the feature was given.
  return within(site, from_head >= from_tail ? site.reach_head : site.reach_tail);
}

Parameter split_default(const SplitSite& site) noexcept { return Choice(site).best(); }

}  // namespace etcm

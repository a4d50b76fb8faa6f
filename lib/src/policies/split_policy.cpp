// The policies that come with the library. They include its public headers alone: what they do, one
// of your own can.
#include <cmath>

#include "etcm/policy.h"
#include "etcm/split_site.h"
#include "etcm/surroundings.h"

namespace etcm {
inline namespace ETCM_IDS {
namespace {

// Reduces a parameter to the open subsegment; only the middle of a subsegment that is one step long
// cannot.
Parameter within(const SplitSite& site, Parameter t) noexcept {
  if (t <= site.head) return static_cast<Parameter>(site.head + 1);
  if (t >= site.tail) return static_cast<Parameter>(site.tail - 1);
  return t;
}

// The whole numbers beside a parameter; where it is beyond the ends of the segment, something that
// is too.
double whole_below(double t) noexcept {
  return t >= 0 && t < parameter_end ? static_cast<Parameter>(t) : t;
}
double whole_above(double t) noexcept {
  const double below = whole_below(t);
  return below < t ? below + 1 : below;
}

// Where a split aims at another vertex, it leaves that vertex's feature a neighbour at its side
// instead of one in the way: worth so many times the length it finishes.
constexpr double aimed_worth = 1.7;
// The same where it aims at a Steiner vertex so near, against the longest part that one split can
// finish, that its feature runs beside this one. Among parallels too every place returns on all of
// them, so one that is there is better than a new one; but no better than to break a subsegment.
constexpr double aligned_worth = 2.0;
constexpr double beside = 0.03;
// A vertex that is nearer at the side than so many steps of the grid is missed by too much to be
// aimed at: two features that run beside each other so near would split each other step by step.
constexpr double steps_aside = 16.0;
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
constexpr int looks_most = 6;
// ... and of this many at least, even where they stand beside nothing that can be finished.
constexpr int looks_least = 2;

// The candidates for one split and what each is worth, in units of the longest part that one split
// can finish. In double: a choice, not a test, and the same bits everywhere (policy.h).
class Choice {
 public:
  explicit Choice(const SplitSite& site) noexcept
      : site_(site),
        surroundings_(site),
        from_(surroundings_.shared_node(End::head)),
        to_(surroundings_.shared_node(End::tail)),
        overlap_(site.feasible_head >= site.feasible_tail) {
    const Parameter at_head = site.feasible_head - site.head;
    const Parameter at_tail = site.tail - site.feasible_tail;
    per_longest_ = 1.0 / (at_head > at_tail ? at_head : at_tail);
  }

  Parameter best() noexcept;

 private:
  using End = Surroundings::End;
  using Beside = Surroundings::Beside;

  double distance(const Point& a, const Position& node) const noexcept;
  bool is_clear_of_nodes(Parameter t) const noexcept;
  void add(Parameter t, double worth) noexcept;
  void add_clear(Parameter t) noexcept;
  void add_ends() noexcept;
  void add_fractions() noexcept;
  void aim_at(const Beside& seen) noexcept;
  void aim_along(double along, bool is_node, double worth) noexcept;
  void look_from(End end) noexcept;
  void choose() noexcept;

  const SplitSite& site_;
  Surroundings surroundings_;
  // The nodes at the ends of the segment, where other features end too.
  VertexId from_;
  VertexId to_;
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
  gains_[count_] = product(gain, worth);
  ++count_;
}

bool Choice::is_clear_of_nodes(Parameter t) const noexcept {
  const double nearest = nearest_to_node * (site_.tail - site_.head);
  return !(site_.head_is_node && t - site_.head < nearest) &&
         !(site_.tail_is_node && site_.tail - t < nearest);
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

void Choice::aim_along(double along, bool is_node, double worth) noexcept {
  if (!(along > 0 && along < site_.tail - site_.head)) return;
  const auto t = static_cast<Parameter>(site_.head + static_cast<Parameter>(along));
  if (is_clear_of_nodes(t) || is_node) add(t, worth);
}

// In parameters.
double Choice::distance(const Point& a, const Position& node) const noexcept {
  const Point b = to_point(node);
  const auto dx = static_cast<double>(a.x - b.x), dy = static_cast<double>(a.y - b.y);
  return root(product(product(dx, dx) + product(dy, dy), surroundings_.per_squared_length()));
}

void Choice::aim_at(const Beside& seen) noexcept {
  // On a feature that shares a node with this one, the same distance from there: the two vertices
  // and the node are isosceles, so neither is in the other's way.
  const auto worth = [&](double away) noexcept {
    return seen.aside < narrow * away ? ring_worth : aimed_worth;
  };
  if (!from_.is_none() && surroundings_.is_on_segment_from(from_, seen.vertex)) {
    const double away = distance(seen.point, site_.from);
    aim_along(whole_below(away + 0.5) - site_.head, seen.is_node, worth(away));
  }
  if (!to_.is_none() && surroundings_.is_on_segment_from(to_, seen.vertex)) {
    const double away = distance(seen.point, site_.to);
    aim_along(whole_above(parameter_end - away - 0.5) - site_.head, seen.is_node, worth(away));
  }
  // Else straight beside it, where the subsegment's two parts see it under no more than a right
  // angle.
  const bool is_aligned = seen.aside * per_longest_ < beside && !seen.is_node;
  const double worth_aside = is_aligned ? aligned_worth : aimed_worth;
  aim_along(seen.along, seen.is_node, seen.aside < steps_aside ? 1.0 : worth_aside);
}

// Aims at the vertices of the triangles that the subsegment crosses, from one end on.
void Choice::look_from(End end) noexcept {
  surroundings_.start(end);
  Beside seen;
  // The first two are the ends of the edge that is crossed first.
  for (int triangles = -1; triangles <= looks_most && surroundings_.next(seen); ++triangles) {
    aim_at(seen);
    const bool is_past = end == End::head ? seen.along > site_.feasible_head - site_.head
                                          : seen.along < site_.feasible_tail - site_.head;
    if (is_past && triangles >= looks_least) break;
  }
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
      const double score = gains_[i] - surroundings_.encroachments_at_least(places_[i]);
      if (score > most || (next >= 0 && score == most && places_[i] < places_[next])) {
        next = i;
        most = score;
      }
    }
    if (next < 0) return;
    const double room = gains_[next] - best_score_;
    // What harms more cannot win.
    const auto enough = static_cast<unsigned>(room < most_harm ? room : most_harm) + 1;
    const double score = gains_[next] - surroundings_.encroachments(places_[next], enough);
    gains_[next] = used;
    if (score > best_score_) {
      best_score_ = score;
      best_ = places_[next];
    }
  }
}

Parameter Choice::best() noexcept {
  look_from(End::head);
  look_from(End::tail);
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

Parameter split_default(const SplitSite& site) noexcept {
  return site.is_lone ? split_paper(site) : Choice(site).best();
}

}  // namespace ETCM_IDS
}  // namespace etcm

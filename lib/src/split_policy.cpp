#include "etcm/policy.h"
#include "etcm/split_site.h"

namespace etcm {
namespace {

// Reduces a parameter to the open piece; only the middle of a piece that is one step long cannot.
Parameter within(const SplitSite& site, Parameter t) noexcept {
  if (t <= site.head) return static_cast<Parameter>(site.head + 1);
  if (t >= site.tail) return static_cast<Parameter>(site.tail - 1);
  return t;
}

// The parameter nearest to the foot of the perpendicular from p. In double: it is a choice, not a
// test, and the same double operations give the same bits on every machine.
Parameter project(const SplitSite& site, const Point& p) noexcept {
  const double dx = static_cast<double>(site.to.x) - site.from.x;
  const double dy = static_cast<double>(site.to.y) - site.from.y;
  const Point from = to_point(site.from);
  const double along =
      static_cast<double>(p.x - from.x) * dx + static_cast<double>(p.y - from.y) * dy;
  const double t = along / (dx * dx + dy * dy);
  if (t <= site.head) return site.head;
  if (t >= site.tail) return site.tail;
  return static_cast<Parameter>(t);
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

Parameter split_default(const SplitSite& site) noexcept {
  const Parameter paper = split_paper(site);
  const Point candidates[4] = {site.head_right, site.head_left, site.tail_right, site.tail_left};
  const bool overlap = site.reach_head >= site.reach_tail;
  Parameter best = paper;
  Parameter best_gain = -1;
  for (const Point& p : candidates) {
    const Parameter t = project(site, p);
    if (t <= site.head || t >= site.tail) continue;
    if (overlap) {
      if (t < site.reach_tail || t > site.reach_head) continue;
      const Parameter gain = t - site.head < site.tail - t ? t - site.head : site.tail - t;
      if (gain > best_gain) {
        best_gain = gain;
        best = t;
      }
      continue;
    }
    const Parameter gain = t <= site.reach_head   ? t - site.head
                           : t >= site.reach_tail ? site.tail - t
                                                  : -1;
    if (gain > best_gain) {
      best_gain = gain;
      best = t;
    }
  }
  return best;
}

}  // namespace etcm

// Along a line through the Voronoi cells of the vertices. A cell is left across the bisector with a
// Delaunay neighbour, the first one the line comes to; each step goes to a vertex that lies farther
// in the direction of the line, so the walk ends.
#include "analysis/internal.h"
#include "geometry/wide_int.h"
#include "triangulation/mesh_state.h"

namespace etcm::internal {

void NearestWalk::enter() noexcept {
  Handover first;
  while (leave_cell(first) && Wide::sign(first.step) == 0) {
    bound_.step();
    nearest_ = first.after;
  }
}

bool NearestWalk::falls_at_start() const noexcept {
  return Wide::sign(dot(along_, between(origin_, m_.at(nearest_)))) > 0;
}

// |along * t - before|^2 = |along * t - after|^2 is linear in t. With coordinates seen from the
// origin, differences are at most 2^53, so step is below 2^108 and scale below 2^109.
Handover NearestWalk::candidate(VertexId after) const noexcept {
  const Vector before = between(origin_, m_.at(nearest_));
  const Vector beyond = between(origin_, m_.at(after));
  return {nearest_, after, dot(beyond, beyond) - dot(before, before),
          twice(dot(along_, between(m_.at(nearest_), m_.at(after))))};
}

bool NearestWalk::leave_cell(Handover& out) noexcept {
  if (m_.topology.triangle_count() == 0) return false;
  Handover first;
  Spokes spokes(m_.topology, nearest_);
  do {
    const VertexId v = spokes.target();
    if (v == infinite_vertex) continue;
    pulse_.pass(6);
    const Handover other = candidate(v);
    if (Wide::sign(other.scale) <= 0) continue;
    if (first.after.is_none() || Wide::sign(Wide::product(other.step, first.scale) -
                                            Wide::product(first.step, other.scale)) < 0) {
      first = other;
    }
  } while (spokes.turn());
  out = first;
  return !first.after.is_none();
}

bool NearestWalk::next() noexcept {
  Handover first;
  if (!leave_cell(first) || Wide::sign(first.step - first.scale) >= 0) return false;
  bound_.step();
  here_ = first;
  nearest_ = first.after;
  return true;
}

// Both sides times scale^2: below 2^332 and 2^340.
bool NearestWalk::is_beyond(std::uint32_t range) const noexcept {
  const Vector before = between(origin_, m_.at(here_.before));
  const Int256 x =
      Wide::product(here_.step, widened(along_.x)) - Wide::product(here_.scale, widened(before.x));
  const Int256 y =
      Wide::product(here_.step, widened(along_.y)) - Wide::product(here_.scale, widened(before.y));
  const Int512 limit = Wide::product(Wide::product(here_.scale, here_.scale),
                                     widened(limbs(squared_range(range, 0))));
  return Wide::sign(Wide::product(x, x) + Wide::product(y, y) - limit) > 0;
}

int NearestWalk::sign_ahead_of(VertexId v) const noexcept {
  return Wide::sign(Wide::product(here_.step, dot(along_, along_)) -
                    Wide::product(here_.scale, dot(along_, between(origin_, m_.at(v)))));
}

// Where several vertices hand over at one place, the one in their middle may have its foot there;
// then the first of those handovers counts. Where that one stays the nearest, the distance goes on
// to rise.
bool NearestWalk::is_peak() noexcept {
  if (sign_ahead_of(here_.before) <= 0) return false;
  const int ahead = sign_ahead_of(here_.after);
  return ahead < 0 || (ahead == 0 && hands_over_again());
}

bool NearestWalk::hands_over_again() noexcept {
  Handover following;
  return leave_cell(following) && Wide::sign(Wide::product(following.step, here_.scale) -
                                             Wide::product(here_.step, following.scale)) == 0;
}

Point NearestWalk::place() const noexcept {
  return {origin_.x + rounded_quotient(Wide::product(here_.step, widened(along_.x)), here_.scale),
          origin_.y + rounded_quotient(Wide::product(here_.step, widened(along_.y)), here_.scale)};
}

}  // namespace etcm::internal

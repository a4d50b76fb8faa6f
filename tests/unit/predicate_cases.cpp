#include "predicate_cases.h"

#include <algorithm>

namespace etcm::test {

namespace {

using etcm::Point;

Point clamp(Point p) {
  return {std::clamp(p.x, -coordinate_max, coordinate_max),
          std::clamp(p.y, -coordinate_max, coordinate_max)};
}

Point nudged(Random& random, Point p) {
  return clamp({p.x + random.between(-1, 1), p.y + random.between(-1, 1)});
}

FourPoints full_range(Random& random) {
  FourPoints four;
  for (Point& p : four) p = random.point(coordinate_max);
  return four;
}

FourPoints tiny(Random& random) {
  FourPoints four;
  for (Point& p : four) p = random.point(4);
  return four;
}

FourPoints tiny_in_a_far_corner(Random& random) {
  FourPoints four = tiny(random);
  const std::int64_t x = random.between(0, 1) != 0 ? coordinate_max : -coordinate_max;
  const std::int64_t y = random.between(0, 1) != 0 ? coordinate_max : -coordinate_max;
  for (Point& p : four) p = clamp({x + p.x, y + p.y});
  return four;
}

FourPoints nodes_on_the_user_grid(Random& random) {
  FourPoints four;
  for (Point& p : four) {
    p = {random.between(-8, 8) * etcm::subunits_per_unit,
         random.between(-8, 8) * etcm::subunits_per_unit};
  }
  return four;
}

// Vertices of one feature: exactly collinear, then moved by one sub-unit at most.
FourPoints nearly_collinear(Random& random) {
  const std::int64_t reach = std::int64_t{1} << random.between(2, 24);
  const Point p = random.point(reach);
  const Point q = random.point(reach);
  FourPoints four;
  for (Point& r : four) {
    const std::int64_t t = random.between(0, etcm::subunits_per_unit);
    r = {p.x * etcm::subunits_per_unit + t * (q.x - p.x),
         p.y * etcm::subunits_per_unit + t * (q.y - p.y)};
    if (random.between(0, 3) == 0) r = nudged(random, r);
  }
  return four;
}

// The eight images of one vector under reflection and exchange lie on a circle.
Point image(Point p, std::int64_t which) {
  if ((which & 1) != 0) p.x = -p.x;
  if ((which & 2) != 0) p.y = -p.y;
  if ((which & 4) != 0) std::swap(p.x, p.y);
  return p;
}

FourPoints cocircular(Random& random) {
  const std::int64_t radius = std::int64_t{1} << random.between(1, 52);
  const Point spoke = random.point(radius);
  const Point centre = random.point(coordinate_max - radius);
  FourPoints four;
  for (Point& p : four) {
    const Point offset = image(spoke, random.between(0, 7));
    p = {centre.x + offset.x, centre.y + offset.y};
  }
  return four;
}

FourPoints nearly_cocircular(Random& random) {
  FourPoints four = cocircular(random);
  const auto moved = static_cast<std::size_t>(random.between(0, 3));
  four[moved] = nudged(random, four[moved]);
  return four;
}

// Corners, side middles and centre of the whole box, at most one sub-unit off: the differences are
// as great as they can be.
FourPoints extreme(Random& random) {
  FourPoints four;
  for (Point& p : four) {
    p = nudged(random,
               {random.between(-1, 1) * coordinate_max, random.between(-1, 1) * coordinate_max});
  }
  return four;
}

FourPoints of_mixed_magnitude(Random& random) {
  FourPoints four;
  for (Point& p : four) p = random.point(std::int64_t{1} << random.between(0, 52));
  return four;
}

constexpr Family table[] = {
    {"full_range", full_range},
    {"tiny", tiny},
    {"tiny_in_a_far_corner", tiny_in_a_far_corner},
    {"nodes_on_the_user_grid", nodes_on_the_user_grid},
    {"nearly_collinear", nearly_collinear},
    {"cocircular", cocircular},
    {"nearly_cocircular", nearly_cocircular},
    {"extreme", extreme},
    {"of_mixed_magnitude", of_mixed_magnitude},
};

}  // namespace

std::span<const Family> families() { return table; }

}  // namespace etcm::test

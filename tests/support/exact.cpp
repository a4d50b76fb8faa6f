#include "support/exact.h"

#include <algorithm>
#include <array>

#include "support/big_integer.h"

namespace etcm::test {
namespace {

mpz_class doubled_area(const Point& a, const Point& b, const Point& c) {
  return (integer(b.x) - integer(a.x)) * (integer(c.y) - integer(a.y)) -
         (integer(b.y) - integer(a.y)) * (integer(c.x) - integer(a.x));
}

}  // namespace

int exact_orientation(const Point& a, const Point& b, const Point& c) {
  return sgn(doubled_area(a, b, c));
}

int exact_incircle(const Point& a, const Point& b, const Point& c, const Point& d) {
  // The height of d over the plane through the lifted a, b, c, expanded along the lift.
  const auto lift = [&d](const Point& p) {
    const mpz_class x = integer(p.x) - integer(d.x);
    const mpz_class y = integer(p.y) - integer(d.y);
    return mpz_class(x * x + y * y);
  };
  const mpz_class height = lift(a) * doubled_area(d, b, c) + lift(b) * doubled_area(a, d, c) +
                           lift(c) * doubled_area(a, b, d);
  return sgn(height);
}

int exact_incircle_perturbed(const Point& a, const Point& b, const Point& c, const Point& d) {
  const int unperturbed = exact_incircle(a, b, c, d);
  if (unperturbed != 0) return unperturbed;
  // Raising a corner raises the plane at d by the corner's share in d; raising d itself puts it
  // outside. The greatest point is raised by infinitely more than the others.
  struct Share {
    Point point;
    int sign;
  };
  std::array<Share, 4> shares{
      Share{a, exact_orientation(d, b, c)}, Share{b, exact_orientation(a, d, c)},
      Share{c, exact_orientation(a, b, d)}, Share{d, -exact_orientation(a, b, c)}};
  std::sort(shares.begin(), shares.end(),
            [](const Share& l, const Share& r) { return l.point > r.point; });
  for (const Share& share : shares) {
    if (share.sign != 0) return share.sign;
  }
  return 0;
}

}  // namespace etcm::test

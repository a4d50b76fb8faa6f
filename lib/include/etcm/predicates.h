// The two questions all geometry here is made of, answered exactly for every input.
//
// Positive orientation is counter-clockwise, here and everywhere in the library.
// Coordinates: |x|, |y| <= 2^52 (any Point the mesh can hold). Neither function rounds, wraps or
// fails; the same input gives the same sign on every machine.
#pragma once

#include "etcm/types.h"

namespace etcm {
inline namespace ETCM_IDS {

// +1 where a, b, c turn counter-clockwise (c is left of a -> b), -1 clockwise, 0 collinear.
// Swapping two arguments flips the sign.
[[nodiscard]] int orient2d(const Point& a, const Point& b, const Point& c) noexcept;

// For a counter-clockwise triangle a, b, c: +1 where d is strictly inside its circumcircle, -1
// strictly outside, 0 on it. For a clockwise one the signs are exchanged; for collinear a, b, c it
// is the side of the line (a circle through infinity), or 0 with four collinear points.
[[nodiscard]] int incircle(const Point& a, const Point& b, const Point& c, const Point& d) noexcept;

// incircle for a counter-clockwise triangle of four distinct points, with ties broken by the
// lexicographic symbolic perturbation: each point is lifted a little off the paraboloid, the
// lexicographically greater by infinitely more (Devillers, Teillaud: Perturbations for Delaunay and
// weighted Delaunay 3D triangulations, 2011). Never 0, and consistent: it is the incircle of some
// set of points in general position, so a set of points has ONE Delaunay triangulation.
[[nodiscard]] int incircle_perturbed(const Point& a, const Point& b, const Point& c,
                                     const Point& d) noexcept;

}  // namespace ETCM_IDS
}  // namespace etcm

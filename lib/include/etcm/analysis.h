// What a mesh tells the operator of the network: links, relays, holes, gaps, readings in between.
//
// Every comparison is exact. Ranges are whole user units, at least 1. Nothing here changes a mesh,
// takes memory of its own or recurses; the library is etcm::analysis.
//
// What counts. Links and connectivity take each vertex of the mesh they are given for a device. So
// there are two answers, and the mesh says which:
//   the network as it stands: the mesh of the devices alone (build() with no features);
//   the network with a device at each vertex of the conforming mesh, Steiner vertices included.
// The first cannot be read off the second: the devices' own Delaunay edges are not all in it.
// What goes along features or is asked of a domain is told the devices as a mesh of their own:
// each of its vertices is one, wherever it stands, and nothing else is. It may be the same mesh.
//
// A longer range than range_max changes nothing.
//
// Lists: a call writes as many entries as fit and returns how many there are.
#pragma once

#include <cstdint>
#include <span>

#include "etcm/domain.h"
#include "etcm/length.h"
#include "etcm/locate.h"
#include "etcm/mesh.h"

namespace etcm {
inline namespace ETCM_IDS {

// No two nodes are farther apart.
inline constexpr std::uint32_t range_max = 3 * static_cast<std::uint32_t>(position_max);

// --- Links

// An edge of the mesh. Both subgraphs contain the Euclidean minimum spanning tree, so they keep the
// network connected with fewer links.
struct Link {
  VertexId from;
  VertexId to;
  bool constrained;  // part of a feature
  bool gabriel;      // no other vertex in or on the circle that has the edge as diameter
  bool urquhart;     // in neither of its triangles longer than both other edges
};

// The edges longer than a range, each once; 0: all edges. A vertex that leaves them out reaches
// whom it can. O(n).
[[nodiscard]] std::uint32_t links(const Mesh& mesh, std::uint32_t longer_than,
                                  std::span<Link> out) noexcept;

// The links of one vertex, from it to each neighbour, in the order of Mesh::neighbours().
// O(degree).
[[nodiscard]] std::uint32_t links_at(const Mesh& mesh, VertexId vertex,
                                     std::span<Link> out) noexcept;

// How a network of all vertices hangs together.
struct Connectivity {
  // The longest edge of the minimum spanning tree: radios that reach this far, and no less, make
  // the network one. 0 with fewer than two vertices.
  SquaredLength least;
  VertexId from{};  // that edge (with several as long, any)
  VertexId to{};
  // The parts into which it falls when the radios reach `radio_range`, whatever links are allowed.
  std::uint32_t parts = 0;
};

struct ConnectivityScratch {
  VertexId part;
  IdValue edge;
};

// The answer holds for links between any two vertices, not only along edges of the mesh.
// `scratch` needs vertex_id_end() elements, which are at most vertices_max + 1; else
// buffer_too_small, and nothing is written. O(n log n).
Status connectivity(const Mesh& mesh, std::uint32_t radio_range,
                    std::span<ConnectivityScratch> scratch, Connectivity& out) noexcept;

// --- Along features

// A place for a relay.
struct Relay {
  Point position;
  FeatureId feature{};  // that it is on (of several, any); none: a node that is on none
  VertexId vertex{};    // that stands there without a device; none: it is between vertices
};

// Each vertex of `mesh` at whose place there is no device, and then on each subsegment of a feature
// that is longer than the range as many more, evenly spaced, that no hop is: ceil(length / range)
// - 1. The latter are rounded down to the sub-unit; where that can make a hop longer than the
// range, which is where hops are as long but for a sub-unit, there is one more. The vertices of
// `devices` are the devices. O(n + entries written), n of both meshes.
[[nodiscard]] std::uint64_t relays(const Mesh& mesh, const Mesh& devices, std::uint32_t radio_range,
                                   std::span<Relay> out) noexcept;

// A segment of a feature from a sensor at one of its vertices to the next such one, or to an end of
// the feature that has none, which they do not see whole: where both ends sense, longer than twice
// the range; where one does, longer than the range; where neither does, any. Somebody may cross it
// unseen by those two: a sensor between its vertices counts as one beside the feature.
struct Gap {
  FeatureId feature;
  VertexId from;  // ids of the mesh that has the features
  VertexId to;
  bool watched;  // sensors beside the feature see every place between them all the same
};

// The gaps along the features of `mesh`. The vertices of `sensors` sense. O(n) plus the triangles
// that gaps pass.
[[nodiscard]] std::uint32_t barrier_gaps(const Mesh& mesh, const Mesh& sensors,
                                         std::uint32_t sensing_range, std::span<Gap> out) noexcept;

// --- Coverage

// Where coverage is asked for: the triangles of a conforming mesh that are labelled inside
// (label_domain). Without a mesh, or where it has no finite triangle (fewer than three vertices, or
// all of them on one line): the hull of the sensors.
struct Domain {
  const Mesh* mesh = nullptr;
  std::span<const Region> region{};
};

// A place of the domain farther than the sensing range from every sensor, and no nearer to one than
// the places around it, or than those beside it on the boundary: where one more sensor would see
// most. A hole may have several.
struct Hole {
  Point position;    // rounded to the nearest sub-unit
  Point sensor;      // the nearest (one of them)
  bool on_boundary;  // on the boundary of the domain; else inside
};

// None, exactly if each place of the domain, boundary included, is within the sensing range of a
// sensor. The vertices of `sensors` sense, in the domain or outside of it. Without sensors no place
// is the worst, and there is none.
//
// Why that is all: where the distance to the nearest sensor is greatest inside the domain, at least
// three sensors are equally near and the place is in their midst, so it is the circumcentre of a
// Delaunay triangle that is not obtuse. (An obtuse triangle's circumcentre lies beyond its longest
// edge, where the next triangle's circle is greater still: such triangles lead to another one, or
// to the boundary.) On the boundary it is a corner without a sensor, or where two sensors take
// turns in being the nearest, and these places are visited one by one. O(n), n of both meshes, plus
// the triangles that long segments of the boundary pass.
[[nodiscard]] std::uint32_t coverage_holes(const Mesh& sensors, const Domain& domain,
                                           std::uint32_t sensing_range,
                                           std::span<Hole> out) noexcept;

// --- Readings

// A reading at any place within the hull, linear in the triangle there. `readings` has one for each
// node, by vertex id; it needs vertex_id_end() elements, those of other ids are not looked at. A
// Steiner vertex takes the value that is linear between the two nodes of its segment of feature.
// `value` is in 2^-28 of the unit of the readings, rounded to the nearest, halves up.
// `type` says whether there is any: with LocateType::outside, value is 0. `place` may be any point.
struct Interpolated {
  LocateType type = LocateType::outside;
  std::int64_t value = 0;
};

// Errors: buffer_too_small, and `out` is as it was. Costs one locate().
Status interpolate(const Mesh& mesh, const Point& place, std::span<const std::int32_t> readings,
                   Interpolated& out) noexcept;

}  // namespace ETCM_IDS
}  // namespace etcm

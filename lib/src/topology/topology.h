// Triangles and how they hang together. Knows no coordinates: what is flipped, and why, is the
// caller's business.
//
// A mesh of v vertices with the one at infinity is a triangulated sphere, so it has exactly
// 2 v - 4 triangles, and they are kept dense: removing a vertex moves the last two triangles into
// the gaps. Collinear nodes are a sphere too: two ghosts for each segment between neighbours.
#pragma once

#include <cstdint>
#include <limits>

#include "etcm/types.h"

namespace etcm::internal {

// One oriented edge: side i of triangle t is 4 t + i, runs counter-clockwise, and lies opposite
// corner i.
struct Edge {
  IdValue value = std::numeric_limits<IdValue>::max();
  constexpr bool is_none() const noexcept { return value == std::numeric_limits<IdValue>::max(); }
  friend constexpr bool operator==(Edge, Edge) = default;
};

struct TriangleRecord {
  VertexId corner[3];
  IdValue link[3];  // the twin's Edge, with constrained_bit where the edge is part of a feature
};

inline constexpr IdValue constrained_bit =
    static_cast<IdValue>(IdValue{1} << (std::numeric_limits<IdValue>::digits - 1));

// Stops the program (check.h): a walk has not ended where in a mesh every walk has. So the mesh is
// none any more, because its storage was written to, or was asked for a vertex that is not in it.
[[noreturn, gnu::cold]] void stop_lost_walk() noexcept;

// The most steps that a walk may take.
class StepBound {
 public:
  explicit StepBound(std::uint32_t most) noexcept : left_(most) {}
  void step() noexcept {
    if (left_ == 0) stop_lost_walk();
    --left_;
  }

 private:
  std::uint32_t left_;
};

class Topology {
 public:
  Topology() noexcept = default;
  Topology(TriangleRecord* triangles, Edge* vertex_edges, IdValue triangle_count) noexcept
      : triangles_(triangles), vertex_edges_(vertex_edges), triangle_count_(triangle_count) {}

  // Of all the triangles that there is room for.
  TriangleRecord* triangle_memory() const noexcept { return triangles_; }
  IdValue triangle_count() const noexcept { return triangle_count_; }
  const TriangleRecord& triangle(IdValue t) const noexcept { return triangles_[t]; }

  static Edge edge(IdValue triangle, unsigned side) noexcept {
    return Edge{static_cast<IdValue>(triangle * 4u + side)};
  }
  static IdValue triangle_of(Edge e) noexcept { return static_cast<IdValue>(e.value >> 2); }
  static unsigned side_of(Edge e) noexcept { return e.value & 3u; }
  // The following and the preceding edge of the same triangle, counter-clockwise.
  static Edge next(Edge e) noexcept {
    return Edge{static_cast<IdValue>(side_of(e) == 2u ? e.value - 2u : e.value + 1u)};
  }
  static Edge prev(Edge e) noexcept {
    return Edge{static_cast<IdValue>(side_of(e) == 0u ? e.value + 2u : e.value - 1u)};
  }

  Edge twin(Edge e) const noexcept {
    return Edge{static_cast<IdValue>(link(e) & static_cast<IdValue>(~constrained_bit))};
  }
  bool is_constrained(Edge e) const noexcept { return (link(e) & constrained_bit) != 0; }
  VertexId apex(Edge e) const noexcept { return triangles_[triangle_of(e)].corner[side_of(e)]; }
  VertexId origin(Edge e) const noexcept { return apex(next(e)); }
  VertexId target(Edge e) const noexcept { return apex(prev(e)); }

  // Some edge that starts at the vertex.
  Edge edge_at(VertexId v) const noexcept { return vertex_edges_[v.value]; }
  // The next edge from the same origin.
  Edge rotate_ccw(Edge e) const noexcept { return twin(prev(e)); }
  Edge rotate_cw(Edge e) const noexcept { return next(twin(e)); }
  // The next edge of the link of e's apex, counter-clockwise.
  Edge next_link_edge(Edge e) const noexcept { return next(twin(next(e))); }

  bool has_corner(IdValue t, VertexId v) const noexcept {
    const TriangleRecord& r = triangles_[t];
    return r.corner[0] == v || r.corner[1] == v || r.corner[2] == v;
  }
  bool is_ghost(IdValue t) const noexcept { return has_corner(t, infinite_vertex); }

  // The edge from u to v; false where there is none. O(degree of u).
  bool find_edge(VertexId u, VertexId v, Edge& e) const noexcept;
  // At most one more than `most`.
  unsigned degree(VertexId v, std::uint32_t most = 0xffff'ffffu) const noexcept;

  void mark(Edge e) noexcept {
    link(e) |= constrained_bit;
    link(twin(e)) |= constrained_bit;
  }
  void unmark(Edge e) noexcept {
    const Edge f = twin(e);
    link(e) = f.value;
    link(f) = e.value;
  }

  void clear() noexcept { triangle_count_ = 0; }

  // Gives every vertex v the id name(v), each its own; O(triangles).
  template <class Name>
  void rename_vertices(Name name) noexcept;

  // Flips the edge of the two triangles of e: afterwards it joins e's apex with that of its twin.
  // e then is the first of the two edges that come to face e's apex; the second is returned. The
  // new edge is unconstrained.
  Edge flip(Edge e) noexcept;

  // The first two vertices: two ghosts back to back.
  void start(VertexId a, VertexId b) noexcept;
  // Puts v into triangle t, which becomes three; returns one edge of the link of v.
  Edge split_triangle(IdValue t, VertexId v) noexcept;
  // Opens e into two edges and puts v between them, a vertex of degree 2 (a collinear mesh grows).
  void split_open(Edge e, VertexId v) noexcept;
  // The inverses: v has degree 3, or 2. Two triangles are left over, linked to nothing, until they
  // are released. Returns an edge of the triangle that takes the gap.
  Edge unsplit_triangle(VertexId v) noexcept;
  void unsplit_open(VertexId v) noexcept;
  // Frees what unsplitting has left over. Other triangles may have other ids afterwards; keeps
  // `follow` right.
  void release_left_over(Edge& follow) noexcept;

  // Cuts the end b of a spoke off the star of the spoke's origin: the spoke flips, and b is the tip
  // of a triangle outside of the star, an ear. Returns the ear's edge to the star, which is marked.
  // Until it is opened again an ear holds `below` in place of a corner: a stack of ears.
  Edge cut_ear(Edge spoke, Edge below) noexcept;
  // Makes the ear that was cut last a triangle like others, and returns what is below it.
  Edge open_ear(Edge ear) noexcept;

 private:
  IdValue& link(Edge e) noexcept { return triangles_[triangle_of(e)].link[side_of(e)]; }
  const IdValue& link(Edge e) const noexcept { return triangles_[triangle_of(e)].link[side_of(e)]; }
  // Makes the edges of two links twins; a constrained bit in either word stays with the edge.
  void join(Edge e, IdValue twin_word) noexcept;
  void set_corners(IdValue t, VertexId a, VertexId b, VertexId c) noexcept;
  void leave_over(IdValue s, IdValue q) noexcept;
  // Frees a triangle that nothing links to; the last one takes its place. Keeps `follow` right.
  void release(IdValue t, Edge& follow) noexcept;

  TriangleRecord* triangles_ = nullptr;
  Edge* vertex_edges_ = nullptr;
  IdValue triangle_count_ = 0;
  IdValue left_over_[2] = {};  // the greater first
};

// The edges from a vertex, once around it counter-clockwise, while nothing flips. A triangle has
// one of them at most. The turn may be given up after so many.
class Spokes {
 public:
  Spokes(const Topology& topo, VertexId v, std::uint32_t most = 0xffff'ffffu) noexcept
      : topo_(topo),
        first_(topo.edge_at(v)),
        edge_(first_),
        bound_(most < topo.triangle_count() ? most : topo.triangle_count()) {
    if (Topology::triangle_of(first_) >= topo.triangle_count() || topo.origin(first_) != v) {
      stop_lost_walk();
    }
  }
  Edge edge() const noexcept { return edge_; }
  VertexId target() const noexcept { return topo_.target(edge_); }
  // On to the next one; false where that is the first again, or there have been too many.
  bool turn() noexcept {
    ++turns_;
    edge_ = topo_.rotate_ccw(edge_);
    if (edge_ == first_) return false;
    if (turns_ <= bound_) return true;
    if (bound_ == topo_.triangle_count()) stop_lost_walk();
    return false;
  }
  // How many there have been; more than `most` where it was given up.
  std::uint32_t turns() const noexcept { return turns_; }

 private:
  const Topology& topo_;
  Edge first_;
  Edge edge_;
  std::uint32_t bound_;
  std::uint32_t turns_ = 0;
};

inline Edge Topology::flip(Edge e) noexcept {
  // t is (p, u, v) with e = u -> v; s is (w, v, u). They become (p, u, w) and (w, v, p), each
  // keeping its first corner's slot, so that two of the four outer links stay as they are.
  const IdValue t = triangle_of(e);
  const unsigned i = side_of(e);
  const Edge f = twin(e);
  const IdValue s = triangle_of(f);
  const unsigned j = side_of(f);
  TriangleRecord& a = triangles_[t];
  TriangleRecord& b = triangles_[s];
  constexpr unsigned after[3] = {1, 2, 0};
  const unsigned i1 = after[i], i2 = after[i1], j1 = after[j], j2 = after[j1];
  const VertexId u = a.corner[i1], v = a.corner[i2], p = a.corner[i], w = b.corner[j];
  const IdValue outer_uw = b.link[j1];
  const IdValue outer_vp = a.link[i1];
  a.corner[i2] = w;
  b.corner[j2] = p;
  join(e, outer_uw);
  join(f, outer_vp);
  a.link[i1] = edge(s, j1).value;
  b.link[j1] = edge(t, i1).value;
  vertex_edges_[u.value] = e;
  vertex_edges_[v.value] = f;
  return edge(s, j2);
}

inline void Topology::join(Edge e, IdValue twin_word) noexcept {
  link(e) = twin_word;
  link(Edge{static_cast<IdValue>(twin_word & static_cast<IdValue>(~constrained_bit))}) =
      static_cast<IdValue>(e.value | (twin_word & constrained_bit));
}

inline Edge Topology::split_triangle(IdValue t, VertexId v) noexcept {
  // (a, b, c) becomes (v, b, c), (v, c, a), (v, a, b).
  TriangleRecord& r = triangles_[t];
  const VertexId a = r.corner[0], b = r.corner[1], c = r.corner[2];
  const IdValue outer_ca = r.link[1], outer_ab = r.link[2];
  const IdValue s = triangle_count_;
  const IdValue q = static_cast<IdValue>(triangle_count_ + 1u);
  triangle_count_ = static_cast<IdValue>(triangle_count_ + 2u);
  r.corner[0] = v;
  set_corners(s, v, c, a);
  set_corners(q, v, a, b);
  join(edge(s, 0), outer_ca);
  join(edge(q, 0), outer_ab);
  join(edge(t, 1), edge(s, 2).value);
  join(edge(s, 1), edge(q, 2).value);
  join(edge(q, 1), edge(t, 2).value);
  vertex_edges_[a.value] = edge(q, 0);
  vertex_edges_[b.value] = edge(t, 0);
  vertex_edges_[c.value] = edge(s, 0);
  vertex_edges_[v.value] = edge(t, 2);
  return edge(t, 0);
}

template <class Name>
void Topology::rename_vertices(Name name) noexcept {
  for (IdValue t = 0; t < triangle_count_; ++t) {
    for (unsigned side = 0; side < 3; ++side) {
      VertexId& corner = triangles_[t].corner[side];
      corner = name(corner);
      vertex_edges_[corner.value] = prev(edge(t, side));
    }
  }
}

inline void Topology::set_corners(IdValue t, VertexId a, VertexId b, VertexId c) noexcept {
  triangles_[t].corner[0] = a;
  triangles_[t].corner[1] = b;
  triangles_[t].corner[2] = c;
}

}  // namespace etcm::internal

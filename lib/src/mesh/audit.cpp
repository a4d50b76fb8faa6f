#include "etcm/audit.h"

#include "base/texts.h"
#include "geometry/predicates_inline.h"
#include "triangulation/locate.h"
#include "triangulation/march.h"
#include "triangulation/mesh_state.h"
#include "triangulation/pulse.h"
#include "triangulation/segment_store.h"

namespace etcm {
inline namespace ETCM_IDS {

using namespace internal;

namespace {

class Auditor {
 public:
  explicit Auditor(const MeshState& m) noexcept : m_(m), topo_(m.topology), pulse_(m) {}

  Audit run() noexcept {
    Audit result;
    using Check = Audit (Auditor::*)() noexcept;
    for (const Check check :
         {&Auditor::counts, &Auditor::links, &Auditor::incidence, &Auditor::orientation,
          &Auditor::hull, &Auditor::circles, &Auditor::on_feature, &Auditor::conforming}) {
      result = (this->*check)();
      if (!result) break;
    }
    return result;
  }

 private:
  static Audit broken(Rule rule, VertexId v, TriangleId t = {}, FeatureId f = {}) noexcept {
    return {.broken = rule, .vertex = v, .triangle = t, .feature = f};
  }
  static TriangleId id_of(Edge e) noexcept { return TriangleId{Topology::triangle_of(e)}; }

  bool in_use(VertexId v) const noexcept {
    const Role role = m_.owner(v).role();
    return role == Role::node || role == Role::steiner || role == Role::fresh;
  }

  // Calls visit(edge), some units of work, for each oriented edge until one answers with a broken
  // rule.
  template <class Visit>
  Audit each_edge(std::uint32_t units, Visit visit) noexcept {
    for (IdValue t = 0; t < topo_.triangle_count(); ++t) {
      pulse_.pass(3 * units);
      for (unsigned side = 0; side < 3; ++side) {
        const Audit result = visit(Topology::edge(t, side));
        if (!result) return result;
      }
    }
    return {};
  }

  Audit counts() noexcept {
    std::uint32_t nodes = 0, steiner = 0;
    for (IdValue i = 1; i < m_.vertex_end; ++i) {
      pulse_.pass(1);
      const Role role = m_.owner(VertexId{i}).role();
      nodes += role == Role::node;
      steiner += role == Role::steiner || role == Role::fresh;
    }
    const std::uint32_t n = nodes + steiner;
    const bool good = nodes == m_.node_count && steiner == m_.steiner_count &&
                      topo_.triangle_count() == (n < 2 ? 0 : 2 * n - 2) &&
                      (n == 1) == !m_.only_vertex.is_none();
    return good ? Audit{} : broken(Rule::counts, {});
  }

  Audit links() noexcept {
    return each_edge(1, [this](Edge e) noexcept {
      const Edge f = topo_.twin(e);
      const bool good = Topology::triangle_of(f) < topo_.triangle_count() &&
                        Topology::side_of(f) < 3 && topo_.twin(f) == e &&
                        topo_.origin(f) == topo_.target(e) && topo_.target(f) == topo_.origin(e) &&
                        topo_.is_constrained(f) == topo_.is_constrained(e);
      return good ? Audit{} : broken(Rule::links, topo_.origin(e), id_of(e));
    });
  }

  Audit incidence() noexcept {
    if (topo_.triangle_count() == 0) return {};
    // One turn around each vertex meets all its corners, so together they meet all there are.
    std::uint64_t corners = 0;
    for (IdValue i = 0; i < m_.vertex_end; ++i) {
      const VertexId v{i};
      if (v != infinite_vertex && !in_use(v)) continue;
      const Edge e = topo_.edge_at(v);
      if (Topology::triangle_of(e) >= topo_.triangle_count() || Topology::side_of(e) > 2 ||
          topo_.origin(e) != v) {
        return broken(Rule::incidence, v);
      }
      const std::uint32_t degree = topo_.degree(v);
      pulse_.pass(1 + degree / 4);
      corners += degree;
    }
    return corners == 3ull * topo_.triangle_count() ? Audit{} : broken(Rule::incidence, {});
  }

  Audit orientation() noexcept {
    for (IdValue t = 0; t < topo_.triangle_count(); ++t) {
      pulse_.pass(2);
      if (topo_.is_ghost(t)) continue;
      const TriangleRecord& r = topo_.triangle(t);
      if (orient2d_fast(m_.at(r.corner[0]), m_.at(r.corner[1]), m_.at(r.corner[2])) <= 0) {
        return broken(Rule::orientation, r.corner[0], TriangleId{t});
      }
    }
    return {};
  }

  Audit hull() noexcept {
    if (topo_.triangle_count() == 0) return {};
    const bool flat = is_flat(m_);
    return each_edge(1, [this, flat](Edge e) noexcept {
      if (topo_.apex(e) != infinite_vertex) return Audit{};
      const Edge onward = Topology::next(topo_.twin(Topology::next(e)));
      const Point& u = m_.at(topo_.origin(e));
      const Point& v = m_.at(topo_.target(e));
      const Point& w = m_.at(topo_.target(onward));
      const int turn = orient2d_fast(u, v, w);
      const bool straight_on = (u < v) == (v < w);
      const bool back = onward == topo_.twin(e);
      const bool good =
          flat ? turn == 0 && (straight_on || back) : turn < 0 || (turn == 0 && straight_on);
      return good ? Audit{} : broken(Rule::hull, topo_.target(e), id_of(e));
    });
  }

  Audit circles() noexcept {
    for (const Rule rule : {Rule::delaunay, Rule::canonical}) {
      const Audit result = each_edge(8, [this, rule](Edge e) noexcept {
        const Edge f = topo_.twin(e);
        const VertexId a = topo_.apex(e), b = topo_.origin(e), c = topo_.target(e);
        const VertexId d = topo_.apex(f);
        if (a == infinite_vertex || b == infinite_vertex || c == infinite_vertex ||
            d == infinite_vertex) {
          return Audit{};
        }
        const int side = incircle_fast(m_.at(a), m_.at(b), m_.at(c), m_.at(d));
        const bool good = rule == Rule::delaunay
                              ? side <= 0
                              : side != 0 || topo_.is_constrained(e) ||
                                    incircle_perturbed(m_.at(a), m_.at(b), m_.at(c), m_.at(d)) < 0;
        return good ? Audit{} : broken(rule, d, id_of(e));
      });
      if (!result) return result;
    }
    return {};
  }

  Audit on_feature() noexcept {
    for (IdValue i = 1; i < m_.vertex_end; ++i) {
      pulse_.pass(2);
      const VertexId v{i};
      const Role role = m_.owner(v).role();
      if (role != Role::steiner && role != Role::fresh) continue;
      const SegmentId s = m_.owner(v).segment();
      if (s.is_none() || s.value >= m_.segment_end || !is_linked(m_, s)) {
        return broken(Rule::on_feature, v);
      }
      const Parameter t = parameter_of(m_, s, v);
      if (t <= 0 || t >= parameter_end || point_at(m_, s, t) != m_.at(v)) {
        return broken(Rule::on_feature, v, {}, internal::feature_of(m_, s));
      }
    }
    return {};
  }

  Audit conforming() noexcept {
    std::uint64_t subsegments = 0, steiner = 0, missing = 0;
    for (IdValue i = 0; i < m_.segment_end; ++i) {
      const SegmentId s{i};
      if (!is_linked(m_, s)) continue;
      const VertexId end = m_.segment(s).to;
      for (VertexId v = m_.segment(s).from; v != end;) {
        const Subsegment subsegment = march(m_, v, end);
        pulse_.pass(subsegment.steps);
        const bool marked = subsegment.is_edge && topo_.is_constrained(subsegment.edge);
        if (!marked && (m_.unresolved == 0 || ++missing > m_.unresolved)) {
          return broken(Rule::conforming, v, {}, internal::feature_of(m_, s));
        }
        subsegments += marked;
        v = subsegment.tail;
        if (v == end) break;
        if (m_.owner(v).role() == Role::node || m_.owner(v).segment() != s) {
          return broken(Rule::conforming, v, {}, internal::feature_of(m_, s));
        }
        ++steiner;
      }
    }
    std::uint64_t marks = 0;
    each_edge(1, [&](Edge e) noexcept {
      marks += topo_.is_constrained(e);
      return Audit{};
    });
    const bool good = marks == 2 * subsegments && steiner == m_.steiner_count;
    return good ? Audit{} : broken(Rule::conforming, {});
  }

  const MeshState& m_;
  const Topology& topo_;
  Pulse pulse_;
};

// In the order of the rules, and one for what is none.
constexpr char rule_names[] =
    "none\0"
    "counts\0"
    "links\0"
    "incidence\0"
    "orientation\0"
    "hull\0"
    "delaunay\0"
    "canonical\0"
    "on_feature\0"
    "conforming\0"
    "unknown";
constexpr std::size_t rule_count = static_cast<std::size_t>(Rule::conforming) + 1;
static_assert(text_count(rule_names) == rule_count + 1);

}  // namespace

const char* to_string(Rule rule) noexcept {
  return nth_text(rule_names, static_cast<std::size_t>(rule), rule_count);
}

Audit audit(const Mesh& mesh) noexcept { return Auditor(opened(mesh, Call::audit)).run(); }

}  // namespace ETCM_IDS
}  // namespace etcm

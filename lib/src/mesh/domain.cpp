#include "etcm/domain.h"

#include "etcm/locate.h"
#include "triangulation/mesh_state.h"
#include "triangulation/pulse.h"

namespace etcm {
inline namespace ETCM_IDS {

using namespace internal;

namespace {

class Labeller {
 public:
  Labeller(const MeshState& m, std::span<Region> region, std::span<TriangleId> waiting) noexcept
      : topo_(m.topology), m_(m), region_(region), waiting_(waiting), pulse_(m) {}

  void all_inside() noexcept {
    for (IdValue t = 0; t < topo_.triangle_count(); ++t) {
      pulse_.pass(1);
      region_[t] = topo_.is_ghost(t) ? Region::outside : Region::inside;
    }
  }

  void flood_from_ghosts() noexcept {
    for (IdValue t = 0; t < topo_.triangle_count(); ++t) {
      pulse_.pass(1);
      if (topo_.is_ghost(t)) waiting_[count_++] = TriangleId{t};
    }
    spread(Region::outside);
  }

  void flood_from(IdValue t, Region label) noexcept {
    if (region_[t] != Region::inside) return;
    region_[t] = label;
    waiting_[count_++] = TriangleId{t};
    spread(label);
  }

  // A node all around which is outside is on no closed feature and in none.
  bool leaves_a_node_outside() noexcept {
    for (IdValue i = 1; i < m_.vertex_end; ++i) {
      pulse_.pass(1);
      const VertexId v{i};
      if (m_.owner(v).role() != Role::node) continue;
      Spokes spokes(topo_, v);
      bool outside = true;
      do {
        outside = region_[Topology::triangle_of(spokes.edge())] == Region::outside;
      } while (outside && spokes.turn());
      if (outside) return true;
    }
    return false;
  }

 private:
  // Each triangle waits at most once: it is labelled when it is put in line.
  void spread(Region label) noexcept {
    while (count_ != 0) {
      pulse_.pass(1);
      const IdValue t = waiting_[--count_].value;
      for (unsigned side = 0; side < 3; ++side) {
        const Edge e = Topology::edge(t, side);
        const IdValue other = Topology::triangle_of(topo_.twin(e));
        if (topo_.is_constrained(e) || region_[other] != Region::inside) continue;
        region_[other] = label;
        waiting_[count_++] = TriangleId{other};
      }
    }
  }

  const Topology& topo_;
  const MeshState& m_;
  std::span<Region> region_;
  std::span<TriangleId> waiting_;
  Pulse pulse_;
  std::size_t count_ = 0;
};

bool is_on_feature(const MeshState& m, const Location& at) noexcept {
  const Topology& topo = m.topology;
  if (at.type == LocateType::on_edge) {
    return topo.is_constrained(Topology::edge(at.triangle.value, static_cast<unsigned>(at.side)));
  }
  if (at.type != LocateType::on_vertex) return false;
  Spokes spokes(topo, at.vertex);
  do {
    if (topo.is_constrained(spokes.edge())) return true;
  } while (spokes.turn());
  return false;
}

}  // namespace

Status label_domain(const Mesh& mesh, Exterior exterior, std::span<const Point> hole_seeds,
                    std::span<Region> region, std::span<TriangleId> scratch) noexcept {
  const MeshState& m = opened(mesh, Call::label_domain);
  const std::size_t count = m.topology.triangle_count();
  if (region.size() < count || scratch.size() < count) return Status::buffer_too_small;
  if (count == 0) return Status::ok;
  Labeller labeller(m, region, scratch);
  labeller.all_inside();
  if (exterior != Exterior::hull) {
    labeller.flood_from_ghosts();
    if (exterior == Exterior::automatic && labeller.leaves_a_node_outside()) labeller.all_inside();
  }
  for (const Point& seed : hole_seeds) {
    const Location at = locate(mesh, seed);
    if (at.type != LocateType::outside && !is_on_feature(m, at)) {
      labeller.flood_from(at.triangle.value, Region::hole);
    }
  }
  return Status::ok;
}

}  // namespace ETCM_IDS
}  // namespace etcm

// All nodes, features or edges of a mesh, for a range-based for:
//
//   for (const VertexId node : nodes_of(mesh)) use(mesh.position(node));
//   for (const FeatureId feature : features_of(mesh)) use(mesh.ends(feature));
//   for (const MeshEdge edge : edges_of(mesh)) use(mesh.point(edge.from), mesh.point(edge.to));
//
// The mesh must be open, stay where it is and not change while a range of it is in use; the ids may
// be kept. Nodes and features come by increasing ids, edges in the order of the triangles beside
// them. A mesh without nodes, features or edges has empty ranges; one of nodes on a line has an
// edge between each two neighbours. Going through a range is O(n), n being the ids below
// vertex_id_end(), feature_id_end() or triangle_count(); a range is one pointer, an iterator two
// words, and neither takes other memory or stack to speak of. Iterators are forward iterators of
// C++20, which answer with values.
#pragma once

#include <cstddef>
#include <cstdint>

#include "etcm/mesh.h"

namespace etcm {
inline namespace ETCM_IDS {

// An edge between two vertices, nodes or not; from.value < to.value.
struct MeshEdge {
  VertexId from{};
  VertexId to{};
  bool constrained = false;  // part of a feature: feature_between() says of which (incidence.h)
  friend constexpr bool operator==(const MeshEdge&, const MeshEdge&) = default;
};

}  // namespace ETCM_IDS
}  // namespace etcm

// What a range goes over: places numbered from 0 up to end(), some of which hold an entry.
namespace etcm::internal {

struct NodePlaces {
  using Entry = VertexId;
  [[nodiscard]] static std::uint32_t end(const Mesh& mesh) noexcept { return mesh.vertex_id_end(); }
  [[nodiscard]] static bool holds(const Mesh& mesh, std::uint32_t place) noexcept {
    return mesh.kind(at(mesh, place)) == VertexKind::node;
  }
  [[nodiscard]] static Entry at(const Mesh&, std::uint32_t place) noexcept {
    return Entry{static_cast<IdValue>(place)};
  }
};

struct FeaturePlaces {
  using Entry = FeatureId;
  [[nodiscard]] static std::uint32_t end(const Mesh& mesh) noexcept {
    return mesh.feature_id_end();
  }
  [[nodiscard]] static bool holds(const Mesh& mesh, std::uint32_t place) noexcept {
    return mesh.is_feature(at(mesh, place));
  }
  [[nodiscard]] static Entry at(const Mesh&, std::uint32_t place) noexcept {
    return Entry{static_cast<IdValue>(place)};
  }
};

// The sides of the triangles, three each; of the two sides of an edge that of the first triangle.
struct EdgePlaces {
  using Entry = MeshEdge;
  [[nodiscard]] static std::uint32_t end(const Mesh& mesh) noexcept {
    return 3u * mesh.triangle_count();
  }
  [[nodiscard]] static bool holds(const Mesh& mesh, std::uint32_t place) noexcept {
    const TriangleId id{static_cast<IdValue>(place / 3)};
    return id < mesh.triangle(id).neighbour[place % 3] && at(mesh, place).from != infinite_vertex;
  }
  [[nodiscard]] static Entry at(const Mesh& mesh, std::uint32_t place) noexcept {
    const Triangle triangle = mesh.triangle(TriangleId{static_cast<IdValue>(place / 3)});
    const VertexId one = triangle.corner[(place + 1) % 3];
    const VertexId other = triangle.corner[(place + 2) % 3];
    const bool constrained = triangle.constrained[place % 3];
    return one < other ? Entry{one, other, constrained} : Entry{other, one, constrained};
  }
};

}  // namespace etcm::internal

namespace etcm {
inline namespace ETCM_IDS {

template <class Places>
class MeshRange {
 public:
  class Iterator {
   public:
    using value_type = typename Places::Entry;
    using difference_type = std::ptrdiff_t;

    constexpr Iterator() noexcept = default;
    [[nodiscard]] value_type operator*() const noexcept { return Places::at(*mesh_, place_); }
    Iterator& operator++() noexcept {
      ++place_;
      settle();
      return *this;
    }
    Iterator operator++(int) noexcept {
      const Iterator before = *this;
      ++*this;
      return before;
    }
    friend constexpr bool operator==(const Iterator&, const Iterator&) noexcept = default;

   private:
    friend MeshRange;
    Iterator(const Mesh& mesh, std::uint32_t place) noexcept : mesh_(&mesh), place_(place) {
      settle();
    }
    // On to the next place that holds an entry, or to the end.
    void settle() noexcept {
      const std::uint32_t end = Places::end(*mesh_);
      while (place_ < end && !Places::holds(*mesh_, place_)) ++place_;
    }

    const Mesh* mesh_ = nullptr;
    std::uint32_t place_ = 0;
  };

  explicit MeshRange(const Mesh& mesh) noexcept : mesh_(&mesh) {}
  [[nodiscard]] Iterator begin() const noexcept { return {*mesh_, 0}; }
  [[nodiscard]] Iterator end() const noexcept { return {*mesh_, Places::end(*mesh_)}; }

 private:
  const Mesh* mesh_;
};

[[nodiscard]] inline MeshRange<internal::NodePlaces> nodes_of(const Mesh& mesh) noexcept {
  return MeshRange<internal::NodePlaces>(mesh);
}
[[nodiscard]] inline MeshRange<internal::FeaturePlaces> features_of(const Mesh& mesh) noexcept {
  return MeshRange<internal::FeaturePlaces>(mesh);
}
[[nodiscard]] inline MeshRange<internal::EdgePlaces> edges_of(const Mesh& mesh) noexcept {
  return MeshRange<internal::EdgePlaces>(mesh);
}

}  // namespace ETCM_IDS
}  // namespace etcm

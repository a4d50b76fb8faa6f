// Handles: names of nodes and features that never name another one.
//
// An id names a place in the storage, and the place is used again: after node 5 has left, 5 is the
// id of whoever comes next. A handle is an id and a number that no other handle has, so a call that
// is given the handle of a node or feature that has gone answers stale_handle, and changes nothing.
//
//   static std::uint32_t numbers[etcm::Handles::words(config)];
//   etcm::Handles handles;
//   if (handles.open(mesh, numbers) != etcm::Status::ok) ...
//   etcm::NodeHandle node;
//   if (handles.join({10, 20}, node) != etcm::Status::ok) ...
//   if (handles.leave(node) != etcm::Status::ok) ...
//   handles.move(node, {0, 0});  // stale_handle, whoever has its id by now
//
// The mesh may be used beside it, with ids: canonicalize(), rebuild(), optimise(), leave(), move()
// and remove_feature() leave the handles of all others as they are. Where a node or a feature comes
// without the handles knowing, by join(), add_feature(), build(), restore() or load() of the mesh,
// and after its clear(), all handles are stale, and handle_of() gives new ones. So one Handles for
// a mesh.
//
// A handle belongs to the Handles that gave it. Each is given a number once, 2^32 - 1 in all: where
// they are used up the answer is out_of_handles, and never a number again.
#pragma once

#include <compare>
#include <cstddef>
#include <cstdint>
#include <span>

#include "etcm/mesh.h"

namespace etcm {
inline namespace ETCM_IDS {

struct NodeHandle {
  VertexId id{};
  std::uint32_t number = 0;  // 0: of none
  friend constexpr auto operator<=>(const NodeHandle&, const NodeHandle&) = default;
};

struct FeatureHandle {
  FeatureId id{};
  std::uint32_t number = 0;  // 0: of none
  friend constexpr auto operator<=>(const FeatureHandle&, const FeatureHandle&) = default;
};

class Handles {
 public:
  // Of no mesh: open() first. Any other call before that is a programming error.
  Handles() noexcept = default;
  Handles(const Handles&) = delete;
  Handles& operator=(const Handles&) = delete;

  // How many numbers it keeps: one for each vertex and each feature there can be.
  [[nodiscard]] static constexpr std::size_t words(const MeshConfig& config) noexcept {
    return std::size_t{config.vertices_max} + config.features_max;
  }

  // Takes an open mesh and storage, which must outlive it; what is in the mesh has no handles yet.
  // Handles of an earlier open() stay stale where `given_out` is what that came to; with less they
  // must be dropped. Errors: storage_too_small. After open() of the mesh this must be opened anew.
  // O(words).
  Status open(Mesh& mesh, std::span<std::uint32_t> storage, std::uint32_t given_out = 0) noexcept;

  // How many numbers have been given.
  [[nodiscard]] std::uint32_t given_out() const noexcept { return given_out_; }

  // The id that a handle stands for. Errors: stale_handle. O(1).
  Status find(NodeHandle node, VertexId& id) const noexcept;
  Status find(FeatureHandle feature, FeatureId& id) const noexcept;

  // The handle of what stands, the same as long as it stands. Errors: unknown_vertex or
  // unknown_feature, and out_of_handles. O(1).
  Status handle_of(VertexId node, NodeHandle& handle) noexcept;
  Status handle_of(FeatureId feature, FeatureHandle& handle) noexcept;

  // As those of Mesh, and with their errors; but stale_handle in place of unknown_vertex and
  // unknown_feature, and besides out_of_handles where a handle comes out. These two are answered
  // first, and leave error_detail() and work_needed() as they are.
  Status join(Position position, NodeHandle& node, Work limit = Work::unlimited()) noexcept;
  Status leave(NodeHandle node, Work limit = Work::unlimited()) noexcept;
  Status move(NodeHandle node, Position position, Work limit = Work::unlimited()) noexcept;
  Status add_feature(NodeHandle from, NodeHandle to, FeatureHandle& feature,
                     Work limit = Work::unlimited()) noexcept;
  Status remove_feature(FeatureHandle feature, Work limit = Work::unlimited()) noexcept;

 private:
  [[nodiscard]] Mesh& mesh() const noexcept;
  [[nodiscard]] bool is_current() const noexcept;
  void renew() noexcept;
  [[nodiscard]] bool is_used_up() const noexcept;
  [[nodiscard]] std::uint32_t give_out(std::size_t word) noexcept;
  Status number_of(std::size_t word, std::uint32_t& number) noexcept;
  [[nodiscard]] bool is_fresh(std::size_t word, std::uint32_t number) const noexcept;
  [[nodiscard]] bool stands(VertexId node) const noexcept;
  [[nodiscard]] std::size_t word_of(VertexId node) const noexcept;
  [[nodiscard]] std::size_t word_of(FeatureId feature) const noexcept;

  Mesh* mesh_ = nullptr;
  std::span<std::uint32_t> numbers_;
  std::uint32_t given_out_ = 0;
  std::uint32_t stale_ = 0;  // all numbers up to here are
};

}  // namespace ETCM_IDS
}  // namespace etcm

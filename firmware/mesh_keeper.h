// Keeps the mesh to what the nodes say: they join, move and leave, and their features with them.
//
// What the mesh refuses goes into quarantine, with its reason in the log; the mesh stays as it was.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "etcm/mesh.h"
#include "etcm/port/log.h"
#include "feature_book.h"
#include "roster.h"

namespace etcm::firmware {

class MeshKeeper {
 public:
  // The mesh is open and empty. All arguments but `features` must outlive the keeper.
  MeshKeeper(Mesh& mesh, std::span<const FeatureSettings> features, Roster& roster,
             const port::Clock& clock, port::Log& log);

  // `generation` is what the log calls the result.
  void join(NodeRecord& node, std::uint32_t generation);
  void move(NodeRecord& node, std::uint32_t generation);
  // Also takes the node's features out; they come back with it. Where the mesh refuses, the node
  // stays in it without features.
  void leave(NodeRecord& node, const char* why, std::uint32_t generation);
  // The node no longer asks for what was refused.
  void forgive(NodeRecord& node);

  // Tries again what was refused, where the mesh has changed in a way that may help.
  void retry_refused(std::uint32_t generation);

  // Whether the mesh or the quarantine changed since the last call.
  bool take_changed() { return std::exchange(changed_, false); }

  const Mesh& mesh() const { return mesh_; }
  const FeatureBook& features() const { return features_; }
  // By vertex id; meaningful for nodes.
  std::span<const std::uint32_t> serials() const { return serials_; }
  // Whether something was refused for want of room or budget.
  bool is_short_of_room() const;

 private:
  struct Before {
    port::Instant at;
    std::uint32_t steiner_count;
    std::uint32_t features_active;
  };
  Before before() const;
  std::string difference(const Before& before) const;

  bool is_worth_a_try(const NodeRecord& node) const;
  void refuse(NodeRecord& node, const char* verb, Status status);
  void activate_features_of(const NodeRecord& node);
  void try_feature(std::uint32_t number);
  std::string trouble_text(Status status) const;

  Mesh& mesh_;
  Roster& roster_;
  const port::Clock& clock_;
  port::Log& log_;
  FeatureBook features_;
  std::vector<std::uint32_t> serials_;
  // Counts the changes that may make room for what was refused.
  std::uint32_t epoch_ = 0;
  std::uint32_t retried_epoch_ = 0;
  bool changed_ = false;
};

}  // namespace etcm::firmware

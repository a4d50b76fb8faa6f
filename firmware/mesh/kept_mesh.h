// The mesh of the gateway, and what its vertices and features stand for: nodes by serial, the
// anchors and the features of the site.
#pragma once

#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include "etcm/mesh.h"
#include "firmware/config/settings.h"
#include "firmware/records/anchor_table.h"
#include "firmware/records/feature_table.h"

namespace etcm::firmware {

class KeptMesh {
 public:
  // The mesh is open and empty, and must outlive this.
  KeptMesh(Mesh& mesh, const Settings& settings);

  Mesh& mesh() { return mesh_; }
  // What one change that a node or the site asks for may take.
  Work work_limit() const { return work_limit_; }
  const Mesh& mesh() const { return mesh_; }
  FeatureTable& features() { return features_; }
  const FeatureTable& features() const { return features_; }
  AnchorTable& anchors() { return anchors_; }
  const AnchorTable& anchors() const { return anchors_; }

  // Of a vertex that is a node; none: it is an anchor alone.
  Serial serial_of(VertexId vertex) const { return serials_[vertex.value]; }
  void set_serial(VertexId vertex, Serial serial) { serials_[vertex.value] = serial; }

  // Anchors alone are not counted.
  std::uint32_t node_count() const { return mesh_.node_count() - anchors_.vacant_count(); }

  // Nothing is in the mesh any more.
  void clear();

  // Makes the mesh the one that Mesh::build() makes of its nodes and features, so that what is
  // published does not depend on what was there before. An answer that is not ok leaves it as it
  // is: conforming, with Steiner vertices of its history.
  Status canonicalize();

  // Counts the changes that may make room for what was rejected.
  std::uint32_t epoch() const { return epoch_; }
  void begin_epoch() { ++epoch_; }

  // The mesh or the quarantine changed.
  void mark_changed() { changed_ = true; }
  // Whether they did since the last call.
  bool take_changed() { return std::exchange(changed_, false); }

 private:
  Mesh& mesh_;
  Work work_limit_;
  FeatureTable features_;
  AnchorTable anchors_;
  std::vector<Serial> serials_;  // by vertex id
  std::uint32_t epoch_ = 0;
  bool changed_ = false;
};

}  // namespace etcm::firmware

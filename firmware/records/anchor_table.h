// The anchors of the site, and which of them are in the mesh.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "etcm/mesh.h"
#include "etcm/port/clock.h"
#include "firmware/config/settings.h"
#include "firmware/site/rejection.h"

namespace etcm::firmware {

struct AnchorRecord {
  AnchorSettings settings;
  VertexId vertex;      // none: not in the mesh
  Rejection rejection;  // by the mesh; tried again where it has changed
  std::uint32_t rejected_epoch = 0;
  port::Instant rejected_since{};
  // Of an earlier configuration; still in the mesh only because that could not do without it.
  bool is_obsolete = false;
  // A node stands there: the vertex is that of both, and stays when the node leaves.
  bool is_taken = false;

  bool is_placed() const { return !vertex.is_none(); }
  bool is_vacant() const { return is_placed() && !is_taken; }
};

class AnchorTable {
 public:
  explicit AnchorTable(std::span<const AnchorSettings> anchors);

  // Takes another configuration over: anchors at the same places keep what is known of them; those
  // that are no longer wanted become obsolete where they are in the mesh, unless a node has taken
  // their place: that keeps the vertex.
  void replace(std::span<const AnchorSettings> anchors);
  // Forgets the obsolete ones that are not in the mesh.
  void tidy();

  std::span<AnchorRecord> records() { return records_; }
  std::span<const AnchorRecord> records() const { return records_; }
  // Null where there is none.
  AnchorRecord* find(Position position);
  const AnchorRecord* find(Position position) const;

  std::uint32_t vacant_count() const;

 private:
  std::vector<AnchorRecord> records_;  // sorted by place
};

// "the anchor at (100, 200) (site.geojson:12)".
std::string name_of(const AnchorRecord& anchor);

}  // namespace etcm::firmware

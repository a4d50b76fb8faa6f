// One generation of the mesh as others may see it; never changed once it is taken.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "etcm/mesh.h"
#include "firmware/polling/indices.h"
#include "firmware/protocol/serial.h"
#include "firmware/publish/mesh_analysis.h"
#include "firmware/records/feature_table.h"
#include "firmware/records/node_table.h"
#include "firmware/site/feature_end.h"
#include "firmware/site/rejection.h"

namespace etcm::firmware {

namespace snapshot_state {
inline constexpr std::uint16_t partial = 1u << 0;     // something is not in the mesh that should be
inline constexpr std::uint16_t stale = 1u << 1;       // the position of a node is not fresh
inline constexpr std::uint16_t budget_hit = 1u << 2;  // room or budget was too small for something
inline constexpr std::uint16_t missing = 1u << 3;     // a node fell silent and has not come back
inline constexpr std::uint16_t bus_silent = 1u << 4;  // no node of a bus answers
}  // namespace snapshot_state

// What a node stands so far from that a mistake is likelier than the place (far_nodes.h).
enum class FarFrom : std::uint8_t {
  nothing,
  site,     // of which the settings say where it is
  others,   // of which most are in one place
  another,  // and nobody can say which of them is wrong
};

// Row i is vertex id i + 1, so a node keeps its row for as long as it is in the mesh.
struct SnapshotVertex {
  VertexKind kind = VertexKind::none;
  bool stale = false;
  bool lacks_fix = false;     // stale although its node answers
  FarFrom far_from{};         // of a node
  bool is_anchor = false;     // a fixed point of the site; to the mesh it is a node
  Rejection rejection{};      // of a node: why the mesh does not have it where it is now
  Serial serial{};            // of a node that is no anchor
  UnitIndex unit_index{};     // that answers for a node; none: it is sought
  MemberIndex owner{};        // the gateway that hears a node; none: this one
  NameIndex name{};           // of a node, into Snapshot::names
  std::uint32_t feature = 0;  // a Steiner vertex stands on it; counted from 1 as configured
  Point point;
  std::uint32_t first_neighbour = 0;  // into Snapshot::neighbours
  std::uint16_t degree = 0;
};

struct SnapshotNeighbour {
  std::uint32_t row = 0;
  bool constrained = false;
  bool gabriel = false;  // see etcm/analysis.h; marked where a radio range is set
  bool urquhart = false;
};

// A node that is known and not in the mesh.
struct SnapshotUnplacedNode {
  Serial serial{};
  UnitIndex unit_index{};
  MemberIndex owner{};
  NameIndex name{};         // as above
  bool is_missing = false;  // its unit is then where it answered last
  bool is_absent = false;   // it was surveyed, and its unit has never answered (absent_units.h)
  bool has_left = false;    // it has said so
  bool has_position = false;
  Position position;
  Rejection rejection;  // none: it is missing, absent, has not told where it is, or asked to leave
};

// A configured feature that is not in the mesh.
struct SnapshotMissingFeature {
  std::uint32_t number = 0;  // from 1 as configured
  FeatureEnd from;
  FeatureEnd to;
  Rejection rejection;               // none: it waits for its ends
  std::optional<Blocker> blocker{};  // the one in its way
};

enum class QuarantineKind : std::uint8_t { none, node, feature, anchor, answer };

struct SnapshotQuarantined {
  QuarantineKind kind = QuarantineKind::none;
  std::uint16_t reason = 0;   // its code (quarantine_reason.h)
  Serial serial{};            // of a node, or of a conflicting answer
  std::uint32_t feature = 0;  // its number, from 1 as configured
  std::uint16_t bus = 0;      // of the unit that answers, from 1 as configured; 0: not known
  std::uint16_t address = 0;  // of that unit
  Position position{};        // where the node or the anchor cannot be
  std::uint32_t age_s = 0;    // since when it has been there, when this generation was made
};

struct Snapshot {
  std::uint32_t generation = 0;
  std::uint16_t state = 0;       // bits of snapshot_state; 0 is all well
  std::uint32_t node_count = 0;  // anchors are not counted
  std::uint32_t anchor_count = 0;
  std::uint32_t steiner_count = 0;
  std::uint32_t edge_count = 0;
  std::uint32_t triangle_count = 0;
  std::uint32_t features_active = 0;
  std::uint32_t features_configured = 0;
  std::uint32_t quarantined_count = 0;  // entries of the quarantine (quarantine.h)
  std::uint32_t stale_count = 0;
  std::uint32_t waiting_count = 0;  // nodes that answer and have not told where they are
  std::uint32_t missing_count = 0;  // nodes
  std::uint32_t far_count = 0;      // nodes that are far from something
  Position middle{};                // of the others, where nodes are far from these
  Position site_middle{};           // of the site, where nodes are far from that
  // Rows of the nodes at the left, right, bottom and top, where some are far from another.
  std::array<std::uint32_t, 4> outermost{};
  std::uint32_t absent_count = 0;  // units that the settings name and that have never answered
  std::uint32_t silent_bus_count = 0;
  std::uint32_t oldest_age_ms = 0;  // of the position of a node in the mesh, at this generation
  std::uint64_t mesh_hash = 0;
  std::vector<SnapshotVertex> vertices;
  std::vector<SnapshotNeighbour> neighbours;
  std::vector<SnapshotUnplacedNode> unplaced_nodes{};
  std::vector<SnapshotMissingFeature> missing_features{};
  std::vector<SnapshotQuarantined> quarantine{};
  std::vector<std::string> gateways{};  // the names of the other gateways, by `owner`
  // What people called things when it was taken.
  std::shared_ptr<const NameBook> names = std::make_shared<const NameBook>();
  MeshAnalysis analysis{};
};

// The name of a gateway that is not this one; empty where it is not known.
inline std::string_view gateway_name(const Snapshot& snapshot, MemberIndex owner) {
  return owner.value < snapshot.gateways.size() ? std::string_view(snapshot.gateways[owner.value])
                                                : std::string_view();
}

// Of the vertex in this row, counter-clockwise.
inline std::span<const SnapshotNeighbour> neighbours_of(const Snapshot& snapshot,
                                                        std::uint32_t row) {
  const SnapshotVertex& vertex = snapshot.vertices[row];
  return std::span(snapshot.neighbours).subspan(vertex.first_neighbour, vertex.degree);
}

// What follows the Steiner vertex `over` on its feature, seen from its neighbour `from`.
std::uint32_t next_on_feature(const Snapshot& snapshot, std::uint32_t from, std::uint32_t over);

}  // namespace etcm::firmware

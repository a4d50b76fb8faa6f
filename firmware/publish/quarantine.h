// What is kept out of the mesh, and why: one list for the page, the registers and others.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "etcm/port/clock.h"
#include "firmware/nodes/admission.h"
#include "firmware/records/anchor_table.h"
#include "firmware/records/feature_table.h"
#include "firmware/records/node_table.h"
#include "firmware/site/rejection.h"

namespace etcm::firmware {

struct QuarantineEntry {
  Serial serial{};                   // of a node; none: it is a feature or an anchor
  std::uint32_t feature = 0;         // its number, counted from 1 as configured; 0: it is none
  std::optional<Blocker> blocker{};  // of a feature: the one in its way
  UnitIndex unit_index{};            // where the node answers, if that is known
  Position position{};               // where the node or the anchor cannot be, if it is one
  Rejection rejection{};             // none: it did not come so far
  IdentityConflict conflict = IdentityConflict::none;  // about the node's identity
  port::Instant since{};
};

// One sentence for a person: what is wrong and what to do.
const char* explain(const QuarantineEntry& entry);

// The most entries there can be.
std::size_t quarantine_max(const NodeTable& nodes, const FeatureTable& features,
                           const AnchorTable& anchors, const Admission& admission);

// Replaces what is in `list`: nodes by record, then features and anchors, then units with a
// conflicting answer. Allocates nothing where the list has room for quarantine_max().
void list_quarantine(const NodeTable& nodes, const FeatureTable& features,
                     const AnchorTable& anchors, const Admission& admission,
                     std::vector<QuarantineEntry>& list);

}  // namespace etcm::firmware

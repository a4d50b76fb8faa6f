// What the systems of the paper share: our exact kernel, our Delaunay mesh and its ties, and a loop
// that takes the features in the order and direction in which they were given. What is ours alone
// they do not get: no canonical order of features, none that need no split brought forward, no
// pruning.
#pragma once

#include "compare/attempt.h"
#include "mesh_internal.h"

namespace etcm::compare {

struct RivalRule {
  // Where to split a missing piece.
  SplitPolicy policy;
  // Makes the sections that miss a piece unions of edges; the library's loop, unless the rule adds
  // several points at once.
  Status (*conform)(internal::MeshState& mesh) noexcept = internal::conform;
  // What comes when all features are in; may be null.
  Status (*finish)(internal::MeshState& mesh) noexcept = nullptr;
};

Attempt run_rival(const inputs::Graph& graph, const RivalRule& rule, Depth depth);

// Puts a Steiner vertex at a parameter of a section; the search for its place starts at `near`.
Status insert_on_section(internal::MeshState& mesh, internal::SectionId section,
                         Parameter parameter, internal::Edge near) noexcept;

// The parameters of a piece's ends on its section.
struct PieceEnds {
  Parameter head;
  Parameter tail;
};
PieceEnds ends_of_piece(const internal::MeshState& mesh, internal::SectionId section, VertexId head,
                        VertexId tail) noexcept;

// The middle of the piece: a policy.
Parameter split_middle(const SplitSite& site) noexcept;

}  // namespace etcm::compare

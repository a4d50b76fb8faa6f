// What the systems of the paper share: our exact kernel, our Delaunay mesh and its ties, and a loop
// that takes the features in the order and direction in which they were given. What is ours alone
// they do not get: no canonical order of features, none that need no split brought forward, no
// pruning.
#pragma once

#include <functional>
#include <vector>

#include "compare/systems/attempt.h"
#include "conforming/conform.h"
#include "conforming/features.h"
#include "conforming/transaction.h"
#include "etcm/split_site.h"
#include "triangulation/change.h"
#include "triangulation/hints.h"
#include "triangulation/insert.h"
#include "triangulation/locate.h"
#include "triangulation/march.h"
#include "triangulation/mesh_state.h"
#include "triangulation/segment_store.h"
#include "triangulation/ties.h"

namespace etcm::compare {

// A part of a feature that is no edge, seen from the endpoint that the user gave first: parameters
// count from there, and so `head` is the end of the subsegment that is nearer to it.
struct MissingSubsegment {
  const internal::MeshState* mesh = nullptr;
  internal::SegmentId segment{};
  bool is_forth = true;             // the segment's own grid runs the same way
  internal::Subsegment subsegment;  // from head to tail
  Parameter head = 0;
  Parameter tail = parameter_end;

  // The same as a split policy sees it, with Q1 and Q2 of the paper. Works them out at each call.
  SplitSite site() const noexcept;
  // The place of a parameter.
  Point at(Parameter t) const noexcept;
};

// Says where to split a missing subsegment: at one place or several, ascending. What is not
// strictly between its ends is moved there.
using SplitRule =
    std::function<void(const MissingSubsegment& missing, std::vector<Parameter>& places)>;

// Which of several broken features is mended first.
enum class BrokenFirst : std::uint8_t {
  canonical,  // the lexicographically least: geometry alone decides
  latest,     // a stack, as the paper's FS_remain
};

struct RivalRule {
  SplitRule split;
  BrokenFirst broken_first = BrokenFirst::canonical;
  // What comes when all features are in; may be null.
  Status (*finish)(internal::Change& change, const RivalRule& rule) = nullptr;
};

Attempt run_rival(const inputs::Graph& graph, const RivalRule& rule, Depth depth);

// Makes all segments that miss a subsegment unions of edges.
Status conform_by(internal::Change& change, const RivalRule& rule);

// Puts a Steiner vertex at a parameter of a segment; the search for its place starts at `near`.
// None: there is no room.
VertexId insert_on_segment(internal::Change& change, internal::SegmentId segment,
                           Parameter parameter, internal::Edge near) noexcept;

// The middle of two parameters; of two equally near ones the even one, which is the same place
// whichever end they count from.
Parameter middle_of(Parameter a, Parameter b) noexcept;

// A rule: the middle of the subsegment.
void split_in_the_middle(const MissingSubsegment& missing, std::vector<Parameter>& places);

}  // namespace etcm::compare

// Lists of segments, linked through their records.
//
// A record has one link for them (next_listed), so a segment is in one list at a time. Which lists
// there are, and what it means to be in one, the types below say:
//
//   DirtySegments    linked into the mesh, with missing subsegments
//   PendingSegments  linked into the mesh, but not laid: they have no marks and no Steiner vertices
//   PruneQueue       linked into the mesh, with Steiner vertices that may be needless; none is
//                    dirty meanwhile
//   FeatureList      roots of features that are not linked into the mesh
//
// So what a listed segment waits for can be told from the segment and from what is going on. Builds
// with ETCM_VERIFY check all of it.
#pragma once

#include "triangulation/mesh_state.h"

namespace etcm::internal {

class SegmentList {
 public:
  bool is_empty() const noexcept { return first_.is_none(); }
  std::uint32_t size() const noexcept { return size_; }
  SegmentId pop(MeshState& m) noexcept;  // none: it is empty
  void clear(MeshState& m) noexcept;

  // Goes along a list and may take entries out.
  class Cursor {
   public:
    Cursor(MeshState& m, SegmentList& list) noexcept
        : mesh_(m), slot_(&list.first_), size_(list.size_) {}
    SegmentId segment() const noexcept { return *slot_; }  // none: at the end
    void advance() noexcept { slot_ = &mesh_.segment(*slot_).next_listed; }
    // Takes the segment out, and goes on to the next.
    void take() noexcept;

   private:
    MeshState& mesh_;
    SegmentId* slot_;
    std::uint32_t& size_;
  };

 protected:
  void push(MeshState& m, SegmentId s) noexcept;
  // Where canonical order has it, unless it is listed.
  void add(MeshState& m, SegmentId s) noexcept;
  // Into canonical order.
  void sort(MeshState& m) noexcept;

  SegmentId first_{};
  std::uint32_t size_ = 0;
  SegmentId added_{};  // the last one to be added, while it is listed
};

// Kept in canonical order: in which order the mesh's triangles happened to break them must not show
// in the result. The list is short.
class DirtySegments : public SegmentList {
 public:
  void add(MeshState& m, SegmentId s) noexcept;
};

// In canonical order from sort() on.
class PruneQueue : public SegmentList {
 public:
  void push(MeshState& m, SegmentId s) noexcept;
  void add(MeshState& m, SegmentId s) noexcept;
  using SegmentList::sort;
};

class PendingSegments : public SegmentList {
 public:
  void push(MeshState& m, SegmentId s) noexcept;
  using SegmentList::sort;
};

class FeatureList : public SegmentList {
 public:
  void push(MeshState& m, SegmentId root) noexcept;
  // Puts the entries of another list, which is empty then, behind these.
  void append(MeshState& m, FeatureList& other) noexcept;
  using SegmentList::sort;
};

}  // namespace etcm::internal

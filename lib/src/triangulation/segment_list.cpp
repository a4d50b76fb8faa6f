#include "triangulation/segment_list.h"

#include "base/linked_sort.h"
#include "triangulation/mesh_state.h"
#include "triangulation/segment_store.h"

namespace etcm::internal {

SegmentId SegmentList::pop(MeshState& m) noexcept {
  const SegmentId s = first_;
  if (s.is_none()) return s;
  first_ = m.segment(s).next_listed;
  m.segment(s).next_listed = not_listed;
  --size_;
  if (s == added_) added_ = SegmentId::none();
  return s;
}

void SegmentList::clear(MeshState& m) noexcept {
  while (!pop(m).is_none()) {
  }
}

void SegmentList::Cursor::take() noexcept {
  SegmentId& next = mesh_.segment(*slot_).next_listed;
  *slot_ = next;
  next = not_listed;
  --size_;
}

void SegmentList::push(MeshState& m, SegmentId s) noexcept {
  ETCM_VERIFY_THAT(m.segment(s).next_listed == not_listed);
  m.segment(s).next_listed = first_;
  first_ = s;
  ++size_;
}

void SegmentList::add(MeshState& m, SegmentId s) noexcept {
  if (m.segment(s).next_listed != not_listed) return;
  SegmentId* slot = &first_;
  // Many often come one after the other.
  if (!added_.is_none() && precedes(m, added_, s)) slot = &m.segment(added_).next_listed;
  added_ = s;
  while (!slot->is_none() && precedes(m, *slot, s)) slot = &m.segment(*slot).next_listed;
  m.segment(s).next_listed = *slot;
  *slot = s;
  ++size_;
}

void SegmentList::sort(MeshState& m) noexcept {
  struct Links {
    MeshState& m;
    SegmentId next(SegmentId s) const noexcept { return m.segment(s).next_listed; }
    void link(SegmentId s, SegmentId next) const noexcept { m.segment(s).next_listed = next; }
    bool precedes(SegmentId a, SegmentId b) const noexcept { return internal::precedes(m, a, b); }
    void step() const noexcept { m.work.pass(1); }
  };
  first_ = sorted(first_, Links{m});
}

void DirtySegments::add(MeshState& m, SegmentId s) noexcept {
  ETCM_VERIFY_THAT(is_linked(m, s));
  SegmentList::add(m, s);
}

void PendingSegments::push(MeshState& m, SegmentId s) noexcept {
  ETCM_VERIFY_THAT(is_linked(m, s));
  SegmentList::push(m, s);
}

void PruneQueue::push(MeshState& m, SegmentId s) noexcept {
  ETCM_VERIFY_THAT(is_linked(m, s));
  SegmentList::push(m, s);
}

void PruneQueue::add(MeshState& m, SegmentId s) noexcept {
  ETCM_VERIFY_THAT(is_linked(m, s));
  SegmentList::add(m, s);
}

void FeatureList::push(MeshState& m, SegmentId root) noexcept {
  ETCM_VERIFY_THAT(!is_linked(m, root) && feature_of(m, root).value == root.value);
  SegmentList::push(m, root);
}

void FeatureList::append(MeshState& m, FeatureList& other) noexcept {
  SegmentId* end = &first_;
  while (!end->is_none()) end = &m.segment(*end).next_listed;
  *end = other.first_;
  size_ += other.size_;
  other.first_ = SegmentId::none();
  other.size_ = 0;
}

}  // namespace etcm::internal

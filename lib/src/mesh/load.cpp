// What save() has written, or what was forged to look like it: every word is looked at before it is
// used, and the mesh is made by what makes any other.
#include "base/checksum.h"
#include "conforming/canonical.h"
#include "conforming/conform_features.h"
#include "etcm/mesh.h"
#include "geometry/predicates_inline.h"
#include "mesh/saved.h"
#include "triangulation/change.h"
#include "triangulation/hilbert_order.h"
#include "triangulation/hints.h"
#include "triangulation/insert.h"
#include "triangulation/locate.h"
#include "triangulation/mesh_state.h"
#include "triangulation/pulse.h"
#include "triangulation/segment_store.h"

namespace etcm {
inline namespace ETCM_IDS {

using namespace internal;

namespace {

// Of a vertex or a segment, to read it and to put it in order.
constexpr Units work_of_record = 24;

std::uint32_t word_at(const std::byte* from) noexcept {
  std::uint32_t value = 0;
  for (int i = 0; i < 4; ++i) value |= static_cast<std::uint32_t>(from[i]) << (8 * i);
  return value;
}

std::uint64_t long_word_at(const std::byte* from) noexcept {
  return word_at(from) | (std::uint64_t{word_at(from + 4)} << 32);
}

class Loader {
 public:
  Loader(Change& change, std::span<const std::byte> saved) noexcept
      : change_(change), m_(change.mesh), saved_(saved.data()), size_(saved.size()) {}

  // Whether the bytes are those that were written, as far as they say so themselves.
  Status look_at_bytes() noexcept;
  // Whether there is room for them. O(1).
  Status look_at_room() const noexcept;
  // Into an empty mesh.
  Status enter() noexcept;
  [[nodiscard]] std::uint64_t hash() const noexcept { return head_.hash; }

 private:
  struct SavedSegment {
    std::uint32_t from, to, next, root;
    [[nodiscard]] bool is_free() const noexcept {
      return from == saved_nobody && to == saved_nobody && next == saved_nobody &&
             root == saved_nobody;
    }
  };
  [[nodiscard]] const std::byte* vertex_at(std::uint32_t id) const noexcept {
    return saved_ + saved_head_bytes + saved_vertex_bytes * (std::size_t{id} - 1);
  }
  [[nodiscard]] SavedSegment segment_at(std::uint32_t id) const noexcept {
    const std::byte* at = vertex_at(head_.vertex_end) + saved_segment_bytes * std::size_t{id};
    return {word_at(at), word_at(at + 4), word_at(at + 8), word_at(at + 12)};
  }
  Status enter_vertices() noexcept;
  Status enter_vertex(VertexId v) noexcept;
  Status insert_nodes() noexcept;
  Status enter_segments() noexcept;
  [[nodiscard]] bool take_segment(SegmentId s, const SavedSegment& saved) noexcept;
  Status link_chains() noexcept;
  [[nodiscard]] bool is_continued(const SegmentRecord& root, const SegmentRecord& r) const noexcept;
  Status insert_steiner(VertexId v) noexcept;
  Status constrain() noexcept;

  Change& change_;
  MeshState& m_;
  const std::byte* saved_;
  std::size_t size_;
  SavedHead head_;
  std::uint32_t steiner_ = 0;   // vertices that are to be inserted yet
  std::uint32_t segments_ = 0;  // in use
};

Status Loader::look_at_bytes() noexcept {
  if (size_ < sizeof(head_.magic)) return Status::damaged;
  if (long_word_at(saved_) != saved_magic) return Status::not_a_mesh;
  if (size_ < saved_head_bytes) return Status::damaged;
  if (word_at(saved_ + 8) != saved_version) return Status::wrong_version;
  head_.vertex_end = word_at(saved_ + 12);
  head_.segment_end = word_at(saved_ + 16);
  head_.node_count = word_at(saved_ + 20);
  head_.steiner_count = word_at(saved_ + 24);
  head_.feature_count = word_at(saved_ + 28);
  head_.hash = long_word_at(saved_ + 32);
  if (head_.vertex_end == 0) return Status::damaged;
  const std::uint64_t whole = saved_size(head_.vertex_end, head_.segment_end);
  if (whole > size_) return Status::damaged;
  const auto before = static_cast<std::size_t>(whole) - saved_tail_bytes;
  Checksum sum;
  Pulse pulse(m_);
  sum_up(sum, saved_, before, pulse);
  return sum.value() == long_word_at(saved_ + before) ? Status::ok : Status::damaged;
}

Status Loader::look_at_room() const noexcept {
  if (head_.vertex_end - 1 > m_.config.vertices_max) return Status::out_of_vertices;
  if (head_.segment_end > m_.config.features_max) return Status::out_of_features;
  const std::uint32_t budget = m_.config.steiner_max;
  return budget != 0 && head_.steiner_count > budget ? Status::steiner_budget : Status::ok;
}

// A Steiner vertex waits as one that is detached, until its segment is there.
Status Loader::enter_vertex(VertexId v) noexcept {
  const std::uint32_t first = word_at(vertex_at(v.value)), second = word_at(vertex_at(v.value) + 4);
  if (first == saved_nobody) return second == saved_nobody ? Status::ok : Status::damaged;
  if ((first & steiner_bit) != 0) {
    m_.owner(v) = Owner(Role::detached, SegmentId::none());
    ++steiner_;
    return Status::ok;
  }
  if (first > 2 * bias || second > 2 * bias) return Status::damaged;
  const auto coordinate = [](std::uint32_t word) noexcept {
    return static_cast<std::int32_t>(word) - position_max;
  };
  m_.points[v.value] = to_point({coordinate(first), coordinate(second)});
  m_.owner(v) = Owner(Role::node, SegmentId::none());
  ++m_.node_count;
  return Status::ok;
}

Status Loader::enter_vertices() noexcept {
  if (!m_.work.spend_whole(work_of_record * head_.vertex_end)) return Status::work_limit;
  m_.vertex_end = static_cast<IdValue>(head_.vertex_end);
  for (IdValue i = 1; i < m_.vertex_end; ++i) {
    m_.work.pass_entry(i);
    m_.owners[i] = Owner{};
    const Status status = enter_vertex(VertexId{i});
    if (status != Status::ok) return status;
  }
  // Last, for the list of the free ones lies in what is no point.
  for (IdValue i = 1; i < m_.vertex_end; ++i) {
    if (m_.owners[i].role() == Role::free) free_vertex(m_, VertexId{i});
  }
  const bool is_right = m_.node_count == head_.node_count && steiner_ == head_.steiner_count;
  return is_right ? Status::ok : Status::damaged;
}

Status Loader::insert_nodes() noexcept {
  if (m_.node_count == 0) return Status::ok;
  const OrderEntry* const order = hilbert_order(m_);
  for (std::size_t i = 0; i < head_.node_count; ++i) {
    const VertexId v{static_cast<IdValue>(order[i].vertex)};
    const Found found = find(m_, m_.at(v), m_.walk_start, m_.work.walk());
    if (!m_.work.spend(found.steps)) return Status::work_limit;
    if (found.type == LocateType::on_vertex) return Status::damaged;
    if (!insert_vertex(change_, v, found)) return Status::work_limit;
  }
  spread_hints(m_);
  return Status::ok;
}

bool Loader::take_segment(SegmentId s, const SavedSegment& saved) noexcept {
  const std::uint32_t root = saved.root & ~saved_reversed_bit;
  if (saved.from >= head_.vertex_end || saved.to >= head_.vertex_end || root >= head_.segment_end ||
      (saved.next != saved_none && saved.next >= head_.segment_end)) {
    return false;
  }
  const VertexId from{static_cast<IdValue>(saved.from)}, to{static_cast<IdValue>(saved.to)};
  if (from == infinite_vertex || to == infinite_vertex || !m_.is_node(from) || !m_.is_node(to) ||
      !(m_.at(from) < m_.at(to))) {
    return false;
  }
  SegmentRecord& r = m_.segment(s);
  r.from = from;
  r.to = to;
  r.next =
      saved.next == saved_none ? SegmentId::none() : SegmentId{static_cast<IdValue>(saved.next)};
  r.root = static_cast<IdValue>(root | (saved.root == root ? IdValue{0} : reversed_bit));
  return true;
}

Status Loader::enter_segments() noexcept {
  if (!m_.work.spend_whole(work_of_record * head_.segment_end)) return Status::work_limit;
  // The least free id comes first, so these come in order.
  for (std::uint32_t i = 0; i < head_.segment_end; ++i) {
    m_.work.pass_entry(i);
    const SegmentId s = allocate_segment(m_);
    const SavedSegment saved = segment_at(i);
    if (saved.is_free()) continue;
    if (!take_segment(s, saved)) return Status::damaged;
    ++segments_;
  }
  for (IdValue i = 0; i < m_.segment_end; ++i) {
    if (m_.segment(SegmentId{i}).from.is_none()) free_segment(m_, SegmentId{i});
  }
  return Status::ok;
}

// On the line of the feature, and in one direction: so a chain ends.
bool Loader::is_continued(const SegmentRecord& root, const SegmentRecord& r) const noexcept {
  const SegmentRecord& next = m_.segment(r.next);
  return !is_free(m_, r.next) && next.root == root.root && next.from == r.to &&
         orient2d_fast(m_.at(root.from), m_.at(root.to), m_.at(next.to)) == 0;
}

// Each segment is in the chain of its feature, once.
Status Loader::link_chains() noexcept {
  std::uint32_t linked = 0;
  for (IdValue i = 0; i < m_.segment_end; ++i) {
    m_.work.pass_entry(i);
    const SegmentId first{i};
    if (is_free(m_, first) || internal::feature_of(m_, first).value != i) continue;
    ++m_.feature_count;
    const SegmentRecord& root = m_.segment(first);
    for (SegmentId s = first; !s.is_none(); s = m_.segment(s).next) {
      const SegmentRecord& r = m_.segment(s);
      if (!r.next.is_none() && !is_continued(root, r)) return Status::damaged;
      if (++linked > segments_) return Status::damaged;
      link_segment(m_, s);
    }
  }
  const bool is_right = linked == segments_ && m_.feature_count == head_.feature_count;
  return is_right ? Status::ok : Status::damaged;
}

Status Loader::insert_steiner(VertexId v) noexcept {
  const std::uint32_t segment = word_at(vertex_at(v.value)) & ~steiner_bit;
  const std::uint32_t t = word_at(vertex_at(v.value) + 4);
  if (segment >= head_.segment_end || t == 0 || t >= parameter_end) return Status::damaged;
  const SegmentId s{static_cast<IdValue>(segment)};
  if (is_free(m_, s)) return Status::damaged;
  const Point p = point_at(m_, s, static_cast<Parameter>(t));
  const Found found = find(m_, p, edge_near(m_, p), m_.work.walk());
  if (!m_.work.spend(found.steps)) return Status::work_limit;
  if (found.type == LocateType::on_vertex) return Status::damaged;
  m_.points[v.value] = p;
  m_.owner(v) = Owner(Role::steiner, s);
  if (!insert_vertex(change_, v, found)) return Status::work_limit;
  ++m_.steiner_count;
  return Status::ok;
}

Status Loader::constrain() noexcept {
  for (IdValue i = 0; i < m_.segment_end; ++i) {
    if (is_free(m_, SegmentId{i})) continue;
    const Status status = constrain_segment(m_, SegmentId{i});
    if (status != Status::ok) return status == Status::work_limit ? status : Status::damaged;
  }
  return Status::ok;
}

Status Loader::enter() noexcept {
  Status status = enter_vertices();
  if (status == Status::ok) status = insert_nodes();
  if (status == Status::ok) status = enter_segments();
  if (status == Status::ok) status = link_chains();
  for (IdValue i = 1; i < m_.vertex_end && status == Status::ok; ++i) {
    if (m_.owners[i].role() == Role::detached) status = insert_steiner(VertexId{i});
  }
  return status == Status::ok ? constrain() : status;
}

}  // namespace

Status Mesh::load(std::span<const std::byte> saved, Work limit) noexcept {
  MeshState& m = about_to_change(*this, Call::load);
  m.work.start_anew(limit, keep_alive_);
  Change change(m);
  if (m.node_count != 0) return m.error_detail.status = Status::mesh_not_empty;
  Loader loader(change, saved);
  Status status = loader.look_at_bytes();
  if (status == Status::ok) status = loader.look_at_room();
  if (status != Status::ok) return m.error_detail.status = status;
  clear();  // ids begin anew, whoever had them
  status = loader.enter();
  // The vertices and segments alone say what the mesh is: another one was saved.
  if (status == Status::ok && hash_of(*this, m, &m.work) != loader.hash()) status = Status::damaged;
  if (status != Status::ok) {
    clear();
    return m.error_detail.status = status;
  }
  make_all_stale(m);
  m.error_detail = ErrorDetail{};
  return status;
}

}  // namespace ETCM_IDS
}  // namespace etcm

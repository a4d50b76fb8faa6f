#include "base/checksum.h"
#include "etcm/mesh.h"
#include "mesh/saved.h"
#include "triangulation/mesh_state.h"
#include "triangulation/pulse.h"
#include "triangulation/segment_store.h"

namespace etcm {
inline namespace ETCM_IDS {

using namespace internal;

namespace {

class Writer {
 public:
  explicit Writer(std::byte* out) noexcept : out_(out) {}
  void word(std::uint32_t value) noexcept {
    for (int i = 0; i < 4; ++i) *out_++ = static_cast<std::byte>(value >> (8 * i));
  }
  void long_word(std::uint64_t value) noexcept {
    word(static_cast<std::uint32_t>(value));
    word(static_cast<std::uint32_t>(value >> 32));
  }

 private:
  std::byte* out_;
};

std::uint32_t saved_coordinate(std::int64_t coordinate) noexcept {
  return static_cast<std::uint32_t>(coordinate / subunits_per_unit + position_max);
}

void write_vertex(Writer& to, const MeshState& m, VertexId v) noexcept {
  if (!m.is_vertex(v)) {
    to.word(saved_nobody);
    to.word(saved_nobody);
  } else if (m.is_node(v)) {
    to.word(saved_coordinate(m.at(v).x));
    to.word(saved_coordinate(m.at(v).y));
  } else {
    const SegmentId s = m.owner(v).segment();
    to.word(s.value | steiner_bit);
    to.word(static_cast<std::uint32_t>(parameter_of(m, s, v)));
  }
}

void write_segment(Writer& to, const MeshState& m, SegmentId s) noexcept {
  if (is_free(m, s)) {
    for (int i = 0; i < 4; ++i) to.word(saved_nobody);
    return;
  }
  const SegmentRecord& r = m.segment(s);
  to.word(r.from.value);
  to.word(r.to.value);
  to.word(r.next.is_none() ? saved_none : r.next.value);
  to.word(internal::feature_of(m, s).value |
          ((r.root & reversed_bit) != 0 ? saved_reversed_bit : 0));
}

}  // namespace

std::size_t Mesh::saved_bytes() const noexcept {
  const MeshState& m = opened(*this, Call::saved_bytes);
  return static_cast<std::size_t>(saved_size(m.vertex_end, m.segment_end));
}

Status Mesh::save(std::span<std::byte> out) const noexcept {
  const MeshState& m = opened(*this, Call::save);
  if (m.unresolved != 0) return Status::mesh_unresolved;
  const std::size_t size = saved_bytes();
  if (out.size() < size) return Status::buffer_too_small;
  Writer to(out.data());
  to.long_word(saved_magic);
  for (const std::uint32_t value :
       {saved_version, std::uint32_t{m.vertex_end}, std::uint32_t{m.segment_end}, m.node_count,
        m.steiner_count, m.feature_count}) {
    to.word(value);
  }
  to.long_word(hash());
  Pulse pulse(m);
  for (IdValue i = 1; i < m.vertex_end; ++i) {
    pulse.pass(1);
    write_vertex(to, m, VertexId{i});
  }
  for (IdValue i = 0; i < m.segment_end; ++i) {
    pulse.pass(1);
    write_segment(to, m, SegmentId{i});
  }
  Checksum sum;
  sum_up(sum, out.data(), size - saved_tail_bytes, pulse);
  to.long_word(sum.value());
  return Status::ok;
}

}  // namespace ETCM_IDS
}  // namespace etcm

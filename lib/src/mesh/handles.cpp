// The mesh remembers whose handles know all that is in it, and forgets it when something comes that
// they have not seen. Nothing else of the mesh has to know of handles.
#include "etcm/handles.h"

#include <limits>

#include "triangulation/mesh_state.h"

namespace etcm {
inline namespace ETCM_IDS {

using namespace internal;

Status Handles::open(Mesh& mesh, std::span<std::uint32_t> storage,
                     std::uint32_t given_out) noexcept {
  MeshState& m = opened(mesh, Call::handles);
  if (storage.size() < words(mesh.config())) return Status::storage_too_small;
  mesh_ = &mesh;
  numbers_ = storage.first(words(mesh.config()));
  for (std::uint32_t& number : numbers_) number = 0;
  given_out_ = stale_ = given_out;
  m.handles = this;
  return Status::ok;
}

Mesh& Handles::mesh() const noexcept {
  demand(mesh_ != nullptr, Call::handles, Fault::not_open);
  demand(numbers_.size() == words(mesh_->config()), Call::handles, Fault::bad_storage);
  return *mesh_;
}

bool Handles::is_current() const noexcept { return state_of(mesh()).handles == this; }

void Handles::renew() noexcept {
  if (is_current()) return;
  stale_ = given_out_;
  state_of(*mesh_).handles = this;
}

bool Handles::is_used_up() const noexcept {
  return given_out_ == std::numeric_limits<std::uint32_t>::max();
}

std::uint32_t Handles::give_out(std::size_t word) noexcept { return numbers_[word] = ++given_out_; }

Status Handles::number_of(std::size_t word, std::uint32_t& number) noexcept {
  number = numbers_[word];
  if (number > stale_) return Status::ok;
  if (is_used_up()) return Status::out_of_handles;
  number = give_out(word);
  return Status::ok;
}

bool Handles::is_fresh(std::size_t word, std::uint32_t number) const noexcept {
  return number > stale_ && numbers_[word] == number;
}

bool Handles::stands(VertexId node) const noexcept {
  return node != infinite_vertex && state_of(*mesh_).is_node(node);
}

std::size_t Handles::word_of(VertexId node) const noexcept { return node.value - std::size_t{1}; }

std::size_t Handles::word_of(FeatureId feature) const noexcept {
  return std::size_t{mesh_->config().vertices_max} + feature.value;
}

Status Handles::find(NodeHandle node, VertexId& id) const noexcept {
  if (!is_current() || !stands(node.id) || !is_fresh(word_of(node.id), node.number)) {
    return Status::stale_handle;
  }
  id = node.id;
  return Status::ok;
}

Status Handles::find(FeatureHandle feature, FeatureId& id) const noexcept {
  if (!is_current() || !mesh_->is_feature(feature.id) ||
      !is_fresh(word_of(feature.id), feature.number)) {
    return Status::stale_handle;
  }
  id = feature.id;
  return Status::ok;
}

Status Handles::handle_of(VertexId node, NodeHandle& handle) noexcept {
  renew();
  if (!stands(node)) return Status::unknown_vertex;
  std::uint32_t number = 0;
  const Status status = number_of(word_of(node), number);
  if (status == Status::ok) handle = {node, number};
  return status;
}

Status Handles::handle_of(FeatureId feature, FeatureHandle& handle) noexcept {
  renew();
  if (!mesh_->is_feature(feature)) return Status::unknown_feature;
  std::uint32_t number = 0;
  const Status status = number_of(word_of(feature), number);
  if (status == Status::ok) handle = {feature, number};
  return status;
}

Status Handles::join(Position position, NodeHandle& node, Work limit) noexcept {
  renew();
  if (is_used_up()) return Status::out_of_handles;
  VertexId id;
  const Status status = mesh_->join(position, id, limit);
  if (status != Status::ok) return status;
  state_of(*mesh_).handles = this;
  node = {id, give_out(word_of(id))};
  return status;
}

Status Handles::leave(NodeHandle node, Work limit) noexcept {
  VertexId id;
  const Status status = find(node, id);
  return status == Status::ok ? mesh_->leave(id, limit) : status;
}

Status Handles::move(NodeHandle node, Position position, Work limit) noexcept {
  VertexId id;
  const Status status = find(node, id);
  return status == Status::ok ? mesh_->move(id, position, limit) : status;
}

Status Handles::add_feature(NodeHandle from, NodeHandle to, FeatureHandle& feature,
                            Work limit) noexcept {
  FeatureEnds ends;
  Status status = find(from, ends.from);
  if (status == Status::ok) status = find(to, ends.to);
  if (status != Status::ok) return status;
  if (is_used_up()) return Status::out_of_handles;
  FeatureId id;
  status = mesh_->add_feature(ends, id, limit);
  if (status != Status::ok) return status;
  state_of(*mesh_).handles = this;
  feature = {id, give_out(word_of(id))};
  return status;
}

Status Handles::remove_feature(FeatureHandle feature, Work limit) noexcept {
  FeatureId id;
  const Status status = find(feature, id);
  return status == Status::ok ? mesh_->remove_feature(id, limit) : status;
}

}  // namespace ETCM_IDS
}  // namespace etcm

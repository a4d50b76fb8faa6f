#include "etcm/c/bytes.h"

#include "c/policy.h"
#include "c/same.h"
#include "etcm/storage.h"

using namespace etcm;
using namespace etcm::c;

static_assert(is_same_memory<MeshReader, etcm_reader_t>);

namespace {

std::span<std::byte> span_of(void* storage, size_t bytes) noexcept {
  return {static_cast<std::byte*>(storage), bytes};
}
std::span<const std::byte> span_of(const void* storage, size_t bytes) noexcept {
  return {static_cast<const std::byte*>(storage), bytes};
}

MeshReader& reader_of(etcm_reader_t* reader) noexcept {
  return *reinterpret_cast<MeshReader*>(reader);
}

MeshConfig with_policy(const etcm_split_policy_t* policy) noexcept {
  MeshConfig config;
  if (policy != nullptr) set_policy(config, *policy);
  return config;
}

}  // namespace

void etcm_seal(etcm_mesh_t* mesh) { seal(mesh_of(mesh)); }

etcm_status_t etcm_attach(etcm_mesh_t* mesh, void* storage, size_t bytes,
                          const struct etcm_split_policy* policy) {
  const MeshConfig config = with_policy(policy);
  return number(
      attach(mesh_of(mesh), span_of(storage, bytes), config.policy, config.policy_context));
}

etcm_status_t etcm_attach_copy(etcm_mesh_t* mesh, void* storage, size_t bytes,
                               const struct etcm_split_policy* policy) {
  const MeshConfig config = with_policy(policy);
  return number(
      attach_copy(mesh_of(mesh), span_of(storage, bytes), config.policy, config.policy_context));
}

etcm_status_t etcm_reader_attach(etcm_reader_t* reader, const void* storage, size_t bytes) {
  return number(reader_of(reader).attach(span_of(storage, bytes)));
}

etcm_status_t etcm_reader_attach_copy(etcm_reader_t* reader, const void* storage, size_t bytes) {
  return number(reader_of(reader).attach_copy(span_of(storage, bytes)));
}

const etcm_mesh_t* etcm_reader_mesh(const etcm_reader_t* reader) { return &reader->mesh; }

size_t etcm_saved_bytes(const etcm_mesh_t* mesh) { return mesh_of(mesh).saved_bytes(); }

etcm_status_t etcm_save(const etcm_mesh_t* mesh, void* out, size_t bytes) {
  return number(mesh_of(mesh).save(span_of(out, bytes)));
}

etcm_status_t etcm_load(etcm_mesh_t* mesh, const void* saved, size_t bytes, uint64_t limit) {
  return number(mesh_of(mesh).load(span_of(saved, bytes), Work{limit}));
}

// Dry runs: whether a change would succeed, and how many Steiner vertices it would need.
//
//   const etcm::Outcome outcome = etcm::DryRun(mesh).join({480, 90});
//   if (outcome.status == etcm::Status::ok && outcome.steiner <= 3) ...
//
// The change is made and taken back, as one that is refused at the very end: so the answer is that
// of the change itself, and the mesh is as it was (mesh.h), with error_detail(), work_used(),
// work_needed(), is_canonical() and what canonicalize() would do. Only its storage is arranged
// otherwise: seal its bytes again (storage.h); and later calls may take a little more or less work.
// It takes up to three times as long as the change.
#pragma once

#include <cstdint>

#include "etcm/mesh.h"

namespace etcm {
inline namespace ETCM_IDS {

struct Outcome {
  Status status = Status::ok;  // what the change would answer
  ErrorDetail detail{};        // what error_detail() would tell
  std::int32_t steiner = 0;    // Steiner vertices that would come, less those that would go
  // What work_needed() would tell. The dry run rearranges the storage, so the change made after it
  // may need a little more: a quarter more has always been enough (docs/work.md).
  Work work{};
};

class DryRun {
 public:
  // The mesh must outlive it.
  explicit DryRun(Mesh& mesh) noexcept : mesh_(mesh) {}

  // Each as the change of this name, which must not be made by another thread meanwhile; nor may
  // the mesh be read. The limit holds for the change and for taking it back.
  [[nodiscard]] Outcome join(Position position, Work limit = Work::unlimited()) noexcept;
  [[nodiscard]] Outcome leave(VertexId node, Work limit = Work::unlimited()) noexcept;
  [[nodiscard]] Outcome move(VertexId node, Position position,
                             Work limit = Work::unlimited()) noexcept;
  [[nodiscard]] Outcome add_feature(FeatureEnds ends, Work limit = Work::unlimited()) noexcept;
  [[nodiscard]] Outcome remove_feature(FeatureId feature, Work limit = Work::unlimited()) noexcept;

 private:
  Mesh& mesh_;
};

}  // namespace ETCM_IDS
}  // namespace etcm

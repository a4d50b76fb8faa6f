#include "firmware/mesh/kept_mesh.h"

#include "firmware/records/node_table.h"

namespace etcm::firmware {

KeptMesh::KeptMesh(Mesh& mesh, const Settings& settings)
    : mesh_(mesh),
      work_limit_(settings.work_max == 0 ? Work::unlimited() : Work{settings.work_max}),
      features_(settings.features, mesh.config().features_max),
      anchors_(settings.anchors),
      serials_(mesh.config().vertices_max + 1, Serial::none()) {}

void KeptMesh::clear() {
  mesh_.clear();
  for (AnchorRecord& anchor : anchors_.records()) {
    anchor.vertex = VertexId::none();
    anchor.is_taken = false;
    anchor.rejection = {};
  }
  for (std::uint32_t number = 0; number < features_.records().size(); ++number) {
    features_.deactivate(number);
  }
}

Status KeptMesh::canonicalize() {
  const std::uint32_t before = mesh_.steiner_count();
  const Status status = mesh_.canonicalize();
  if (mesh_.steiner_count() < before) begin_epoch();
  return status;
}

}  // namespace etcm::firmware

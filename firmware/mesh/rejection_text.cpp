#include "firmware/mesh/rejection_text.h"

namespace etcm::firmware {

void write_rejection(TextLine& text, const KeptMesh& kept, const NodeTable& nodes,
                     const Rejection& rejection) {
  text << explain(rejection);
  if (rejection.mesh == Status::ok) return;
  const ErrorDetail& detail = kept.mesh().error_detail();
  if (!detail.other.is_none()) {
    text << " [with " << kept.features().name(kept.features().number_of(detail.other)) << "]";
  }
  if (!detail.vertex.is_none() && kept.mesh().kind(detail.vertex) == VertexKind::node) {
    const Serial serial = kept.serial_of(detail.vertex);
    const AnchorRecord* const anchor = kept.anchors().find(kept.mesh().position(detail.vertex));
    if (!serial.is_none()) {
      text << " [" << nodes.called(serial) << "]";
    } else if (anchor != nullptr) {
      text << " [" << name_of(*anchor) << "]";
    }
  }
}

}  // namespace etcm::firmware

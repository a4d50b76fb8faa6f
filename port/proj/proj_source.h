// Projections by PROJ.
#pragma once

#include <memory>
#include <string>

#include "etcm/port/projection.h"

namespace etcm::port {

// PROJ is loaded when the first projection is asked for: it brings a database and half a dozen
// libraries, and most gateways count in their plane alone. A coordinate reference system is any
// text that PROJ knows; no grid is fetched from anywhere.
class ProjSource final : public ProjectionSource {
 public:
  std::shared_ptr<const Projection> of_crs(const std::string& crs, std::string& why) override;
  std::shared_ptr<const Projection> about(EarthPoint center, std::string& why) override;
};

}  // namespace etcm::port

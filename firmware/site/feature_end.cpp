#include "firmware/site/feature_end.h"

namespace etcm::firmware {

std::string to_string(const FeatureEnd& end) {
  if (!end.is_anchor) return std::to_string(end.serial.value);
  return "(" + std::to_string(end.position.x) + ", " + std::to_string(end.position.y) + ")";
}

}  // namespace etcm::firmware

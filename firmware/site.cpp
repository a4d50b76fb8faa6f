#include "site.h"

#include "etcm/files/constraint_graph.h"

namespace etcm::firmware {

std::vector<FeatureSettings> read_site(const std::string& path) {
  const files::ConstraintGraph graph = files::read_graph(path);
  std::vector<FeatureSettings> features;
  features.reserve(graph.features.size());
  for (const files::GraphFeature& feature : graph.features) {
    features.push_back({.from = static_cast<std::uint32_t>(graph.node_number(feature.from)),
                        .to = static_cast<std::uint32_t>(graph.node_number(feature.to)),
                        .place = path + ":" + std::to_string(feature.line)});
  }
  return features;
}

}  // namespace etcm::firmware

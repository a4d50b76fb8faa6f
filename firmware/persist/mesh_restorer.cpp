#include "firmware/persist/mesh_restorer.h"

#include <algorithm>
#include <map>
#include <utility>

namespace etcm::firmware {

bool MeshRestorer::restore(const SavedState& saved, std::span<NodeRecord* const> nodes) {
  if (std::find(nodes.begin(), nodes.end(), nullptr) != nodes.end()) return false;
  if (!find_positions(saved) || !find_features(saved)) return false;
  kept_.clear();
  if (make_mesh(saved) != Status::ok) {
    kept_.clear();
    site_.place_anchors();
    return false;
  }
  const bool is_same = kept_.mesh().hash() == saved.mesh_hash;
  assign_vertices(saved, nodes);
  // What has been configured since then.
  site_.place_anchors();
  site_.features().settle_all();
  kept_.mark_changed();
  return is_same;
}

// A mesh that is not as it was saved is a good one all the same.
Status MeshRestorer::make_mesh(const SavedState& saved) {
  return saved.is_canonical ? kept_.mesh().build(positions_, ends_)
                            : kept_.mesh().restore(positions_, ends_, saved.steiner);
}

bool MeshRestorer::find_positions(const SavedState& saved) {
  for (const SavedNode& node : saved.nodes) {
    // The domain may have changed since then.
    if (domain_.place_of(node.position) != DomainPlace::inside) return false;
    positions_.push_back(node.position);
    keys_.push_back({FeatureEnd(node.serial).key(), FeatureEnd::anchor(node.position).key()});
  }
  for (const Position anchor : saved.anchors) {
    if (kept_.anchors().find(anchor) == nullptr) return false;
    positions_.push_back(anchor);
    keys_.push_back({FeatureEnd::anchor(anchor).key(), FeatureEnd::anchor(anchor).key()});
  }
  return true;
}

bool MeshRestorer::find_features(const SavedState& saved) {
  const auto records = kept_.features().records();
  std::map<std::pair<std::uint64_t, std::uint64_t>, std::uint32_t> number_of;
  for (std::uint32_t number = 0; number < records.size(); ++number) {
    const FeatureSettings& feature = records[number].settings;
    number_of.emplace(std::minmax({feature.from.key(), feature.to.key()}), number);
  }
  for (const SavedFeature& feature : saved.features) {
    auto found = number_of.end();
    for (const std::uint64_t from : keys_[feature.from]) {
      for (const std::uint64_t to : keys_[feature.to]) {
        if (found == number_of.end()) found = number_of.find(std::minmax({from, to}));
      }
    }
    if (found == number_of.end()) return false;
    numbers_.push_back(found->second);
    ends_.push_back({VertexId{static_cast<IdValue>(feature.from + 1)},
                     VertexId{static_cast<IdValue>(feature.to + 1)}});
  }
  return true;
}

void MeshRestorer::assign_vertices(const SavedState& saved, std::span<NodeRecord* const> nodes) {
  for (std::size_t i = 0; i < nodes.size(); ++i) {
    const VertexId id{static_cast<IdValue>(i + 1)};
    nodes[i]->vertex = id;
    nodes[i]->placed = nodes[i]->position;
    kept_.set_serial(id, nodes[i]->serial);
    if (AnchorRecord* const anchor = kept_.anchors().find(nodes[i]->placed); anchor != nullptr) {
      anchor->vertex = id;
      anchor->is_taken = true;
    }
  }
  for (std::size_t i = 0; i < saved.anchors.size(); ++i) {
    const VertexId id{static_cast<IdValue>(nodes.size() + i + 1)};
    kept_.anchors().find(saved.anchors[i])->vertex = id;
    kept_.set_serial(id, Serial::none());
  }
  for (std::size_t i = 0; i < numbers_.size(); ++i) {
    kept_.features().activate(numbers_[i], FeatureId{static_cast<IdValue>(i)});
  }
}

}  // namespace etcm::firmware

// The part of the keeper that makes the mesh of an earlier run again.
#include <algorithm>
#include <array>
#include <map>
#include <utility>

#include "firmware/mesh/mesh_keeper.h"
#include "firmware/persist/saved_state.h"

namespace etcm::firmware {

bool MeshKeeper::restore(const SavedState& saved, std::span<NodeRecord* const> nodes) {
  if (std::find(nodes.begin(), nodes.end(), nullptr) != nodes.end()) return false;
  std::map<std::pair<std::uint64_t, std::uint64_t>, std::uint32_t> number_of;
  for (std::uint32_t number = 0; number < features_.records().size(); ++number) {
    const FeatureSettings& feature = features_.records()[number].settings;
    number_of.emplace(std::minmax({feature.from.key(), feature.to.key()}), number);
  }
  std::vector<Position> places;
  std::vector<std::array<std::uint64_t, 2>> keys;  // by place: of a node, and of an anchor it is on
  for (const SavedNode& node : saved.nodes) {
    // The domain may have changed since then.
    if (place_of(node.position) != DomainPlace::inside) return false;
    places.push_back(node.position);
    keys.push_back({FeatureEnd(node.serial).key(), FeatureEnd::anchor(node.position).key()});
  }
  for (const Position anchor : saved.anchors) {
    if (anchors_.find(anchor) == nullptr) return false;
    places.push_back(anchor);
    keys.push_back({FeatureEnd::anchor(anchor).key(), FeatureEnd::anchor(anchor).key()});
  }
  std::vector<FeatureEnds> ends;
  std::vector<std::uint32_t> numbers;
  for (const SavedFeature& feature : saved.features) {
    auto found = number_of.end();
    for (const std::uint64_t from : keys[feature.from]) {
      for (const std::uint64_t to : keys[feature.to]) {
        if (found == number_of.end()) found = number_of.find(std::minmax({from, to}));
      }
    }
    if (found == number_of.end()) return false;
    numbers.push_back(found->second);
    ends.push_back({VertexId{static_cast<IdValue>(feature.from + 1)},
                    VertexId{static_cast<IdValue>(feature.to + 1)}});
  }
  clear_mesh();
  if (mesh_.restore(places, ends, saved.steiner) != Status::ok || mesh_.hash() != saved.mesh_hash) {
    clear_mesh();
    update_anchors();
    return false;
  }
  for (std::size_t i = 0; i < nodes.size(); ++i) {
    const VertexId id{static_cast<IdValue>(i + 1)};
    nodes[i]->vertex = id;
    nodes[i]->placed = nodes[i]->position;
    serials_[id.value] = nodes[i]->serial;
    if (AnchorRecord* const anchor = anchors_.find(nodes[i]->placed); anchor != nullptr) {
      anchor->vertex = id;
      anchor->is_taken = true;
    }
  }
  for (std::size_t i = 0; i < saved.anchors.size(); ++i) {
    const VertexId id{static_cast<IdValue>(nodes.size() + i + 1)};
    anchors_.find(saved.anchors[i])->vertex = id;
    serials_[id.value] = no_serial;
  }
  for (std::size_t i = 0; i < numbers.size(); ++i) {
    features_.activate(numbers[i], FeatureId{static_cast<IdValue>(i)});
  }
  // What has been configured since then.
  update_anchors();
  for (std::uint32_t number = 0; number < features_.records().size(); ++number) {
    try_feature(number);
  }
  changed_ = true;
  return true;
}

// Neither anchors nor features are in it any more.
void MeshKeeper::clear_mesh() {
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

}  // namespace etcm::firmware

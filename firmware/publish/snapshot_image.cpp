#include "firmware/publish/snapshot_image.h"

#include <algorithm>
#include <array>
#include <string>

#include "firmware/config/names.h"

namespace etcm::firmware {

namespace {

bool is_steiner(const Snapshot& snapshot, std::uint32_t row) {
  return snapshot.vertices[row].kind == VertexKind::steiner;
}

// The node at the other end of the segment that leaves `node` by this edge.
std::uint32_t end_of_segment(const Snapshot& snapshot, std::uint32_t node, std::uint32_t over) {
  while (over != no_row && is_steiner(snapshot, over)) {
    over = next_on_feature(snapshot, std::exchange(node, over), over);
  }
  return over;
}

}  // namespace

SnapshotImager::SnapshotImager(const Settings& settings)
    : image_(std::make_shared<files::MeshImage>()), domain_(settings.mesh) {
  const std::size_t vertices = settings.mesh.vertices_max;
  image_->name.reserve(name_bytes_max);
  image_->vertices.reserve(vertices);
  image_->triangles.reserve(2 * vertices);
  image_->edges.reserve(3 * vertices);
  image_->subsegments.reserve(vertices + settings.mesh.features_max);
  image_->attributes.reserve(vertices);
  image_->degrees.reserve(vertices);
  image_->attribute_count = 1;
  ReadingSnapshot readings;
  reserve(readings, settings);
  take_names(readings);
  image_->values.reserve(readings.readings.capacity() + vertices);
  index_of_.reserve(vertices);
  row_of_.reserve(vertices);
  segments_.reserve(vertices);
}

std::shared_ptr<const files::MeshImage> SnapshotImager::make(const Snapshot& snapshot,
                                                             const ReadingSnapshot& readings,
                                                             const SitePlane& plane) {
  image_->name = snapshot.names->site();
  image_->metres_per_unit = metres_per_unit(plane);
  image_->mesh_hash = snapshot.mesh_hash;
  image_->vertices.clear();
  image_->triangles.clear();
  image_->edges.clear();
  image_->subsegments.clear();
  image_->attributes.clear();
  row_of_.clear();
  if (serial_name_ != readings.properties.size()) take_names(readings);
  index_of_.assign(snapshot.vertices.size(), no_row);
  for (std::uint32_t row = 0; row < snapshot.vertices.size(); ++row) {
    if (snapshot.vertices[row].kind == VertexKind::node) add_vertex(snapshot, row);
  }
  image_->node_count = static_cast<std::uint32_t>(image_->vertices.size());
  add_values(snapshot, readings);
  image_->feature_count = snapshot.features_active;
  for (std::uint32_t node = 0; node < image_->node_count; ++node) add_segments(snapshot, node);
  add_degrees(plane);
  domain_.label(snapshot);
  for (std::uint32_t i = 0; i < image_->vertices.size(); ++i) add_edges_and_triangles(snapshot, i);
  return image_;
}

void SnapshotImager::take_names(const ReadingSnapshot& readings) {
  image_->value_names = readings.properties;
  serial_name_ = static_cast<std::uint32_t>(image_->value_names.size());
  image_->value_names.emplace_back("serial");
}

void SnapshotImager::add_vertex(const Snapshot& snapshot, std::uint32_t row) {
  const SnapshotVertex& vertex = snapshot.vertices[row];
  const bool is_node = vertex.kind == VertexKind::node;
  index_of_[row] = static_cast<std::uint32_t>(row_of_.size());
  row_of_.push_back(row);
  image_->vertices.push_back({vertex.point, !is_node, is_node ? 0 : -1});
  // Neither text is too long for a string without memory of its own.
  const bool has_serial = is_node && !vertex.is_anchor;
  image_->attributes.push_back(has_serial ? std::to_string(vertex.serial.value) : "-1");
}

void SnapshotImager::add_values(const Snapshot& snapshot, const ReadingSnapshot& readings) {
  image_->values.clear();
  for (std::uint32_t node = 0; node < image_->node_count; ++node) {
    const Serial serial = snapshot.vertices[row_of_[node]].serial;
    if (serial.is_none()) continue;  // an anchor
    image_->values.push_back(
        {.vertex = node, .name = serial_name_, .nano = serial.value * nano_per_one});
    for (const PublishedReading& reading : readings_of(readings, serial)) {
      image_->values.push_back(
          {.vertex = node, .name = property_of(reading), .nano = reading.nano});
    }
  }
}

// None where one of them is nowhere on the earth: files are in degrees, or in the plane.
void SnapshotImager::add_degrees(const SitePlane& plane) {
  image_->degrees.clear();
  if (plane.projection == nullptr) return;
  for (const files::ImageVertex& vertex : image_->vertices) {
    const std::optional<port::EarthPoint> place = earth_point(plane, vertex.point);
    if (!place) return image_->degrees.clear();
    image_->degrees.push_back({.longitude = place->longitude, .latitude = place->latitude});
  }
}

// Those to nodes with a higher index, and their Steiner vertices.
void SnapshotImager::add_segments(const Snapshot& snapshot, std::uint32_t node) {
  const std::uint32_t row = row_of_[node];
  segments_.clear();
  for (const SnapshotNeighbour& neighbour : neighbours_of(snapshot, row)) {
    if (!neighbour.constrained) continue;
    const std::uint32_t end = end_of_segment(snapshot, row, neighbour.row);
    if (end != no_row && index_of_[end] > node) {
      segments_.emplace_back(index_of_[end], neighbour.row);
    }
  }
  std::sort(segments_.begin(), segments_.end());
  for (const auto& [end, first] : segments_) {
    std::uint32_t from = row;
    for (std::uint32_t at = first; at != no_row;) {
      if (is_steiner(snapshot, at)) add_vertex(snapshot, at);
      image_->subsegments.push_back({.from = index_of_[from], .to = index_of_[at]});
      if (index_of_[at] == end) break;
      at = next_on_feature(snapshot, std::exchange(from, at), at);
    }
  }
}

// Those of the domain whose lowest index this is, sorted.
void SnapshotImager::add_edges_and_triangles(const Snapshot& snapshot, std::uint32_t index) {
  const auto neighbours = neighbours_of(snapshot, row_of_[index]);
  const auto first_edge = static_cast<std::ptrdiff_t>(image_->edges.size());
  const auto first_triangle = static_cast<std::ptrdiff_t>(image_->triangles.size());
  const bool is_flat = snapshot.triangle_count == 0;
  const std::size_t first_around = snapshot.vertices[row_of_[index]].first_neighbour;
  for (std::size_t i = 0; i < neighbours.size(); ++i) {
    const SnapshotNeighbour& left = neighbours[i];
    const std::size_t right = (i + neighbours.size() - 1) % neighbours.size();
    const bool has_left = domain_.has_on_left(first_around + i);
    const SnapshotNeighbour& next = neighbours[(i + 1) % neighbours.size()];
    const std::uint32_t other = index_of_[left.row];
    if (other < index) continue;
    if (left.constrained || is_flat || has_left || domain_.has_on_left(first_around + right)) {
      image_->edges.push_back({.from = index,
                               .to = other,
                               .is_constrained = left.constrained,
                               .marker = left.constrained});
    }
    if (has_left && index_of_[next.row] > index) {
      image_->triangles.push_back({index, other, index_of_[next.row]});
    }
  }
  std::sort(image_->edges.begin() + first_edge, image_->edges.end(),
            [](const auto& a, const auto& b) { return a.to < b.to; });
  std::sort(image_->triangles.begin() + first_triangle, image_->triangles.end());
}

}  // namespace etcm::firmware

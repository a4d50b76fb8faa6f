#include "picture_map.h"

#include <algorithm>
#include <cmath>
#include <tuple>
#include <utility>

namespace etcm::files {

namespace {

constexpr double map_width_max = page_width - 2 * margin;
constexpr double map_height_max = 1100;

std::pair<std::int64_t, std::int64_t> extent_without_outliers(std::vector<std::int64_t>& values) {
  if (values.empty()) return {0, 0};
  std::sort(values.begin(), values.end());
  const std::size_t few = values.size() / 100;
  std::size_t first = 0;
  std::size_t last = values.size() - 1;
  const std::int64_t gap = (values[last] - values[first]) / 3;
  for (std::size_t i = 0; i < few; ++i) {
    if (values[i + 1] - values[i] > gap) first = i + 1;
    const std::size_t j = values.size() - 1 - i;
    if (values[j] - values[j - 1] > gap) last = j - 1;
  }
  return {values[first], values[last]};
}

}  // namespace

PictureMap::PictureMap(const MeshImage& image, std::vector<std::int64_t>& coordinates) {
  coordinates.clear();
  for (const ImageVertex& vertex : image.vertices) coordinates.push_back(vertex.point.x);
  std::tie(low_.x, high_.x) = extent_without_outliers(coordinates);
  coordinates.clear();
  for (const ImageVertex& vertex : image.vertices) coordinates.push_back(vertex.point.y);
  std::tie(low_.y, high_.y) = extent_without_outliers(coordinates);
  for (const ImageVertex& vertex : image.vertices) outside_count_ += !shows(vertex.point);
  const double width = static_cast<double>(high_.x - low_.x);
  const double height = static_cast<double>(high_.y - low_.y);
  if (width > 0 || height > 0) {
    px_per_subunit_ = std::min(width > 0 ? map_width_max / width : map_height_max / height,
                               height > 0 ? map_height_max / height : map_width_max / width);
  }
  height_px_ = std::max(map_height_min, height * px_per_subunit_);
  left_ = (page_width - width * px_per_subunit_) / 2;
  bottom_ = header_height + (height_px_ + height * px_per_subunit_) / 2;
}

PictureSpot PictureMap::spot(const Point& point) const {
  const double x = left_ + static_cast<double>(point.x - low_.x) * px_per_subunit_;
  const double y = bottom_ - static_cast<double>(point.y - low_.y) * px_per_subunit_;
  return {std::llround(x * 100), std::llround(y * 100)};
}

}  // namespace etcm::files

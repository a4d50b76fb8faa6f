// Where on the page of a picture a point of the plane is.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "etcm/files/mesh_image.h"
#include "etcm/files/picture.h"

namespace etcm::files {

// Pixels.
inline constexpr double page_width = 1200;
inline constexpr double margin = 48;
inline constexpr double header_height = 104;
inline constexpr double footer_height = 84;
inline constexpr double map_height_min = 120;

// The frame around the vertices, between header and footer. A handful of these that stands so far
// off that the rest would shrink to a corner is left out: less than 1 % of all, beyond a gap of a
// third of the extent.
class PictureMap {
 public:
  // `coordinates` is room to work in.
  PictureMap(const MeshImage& image, std::vector<std::int64_t>& coordinates);

  double height_px() const { return height_px_; }
  // Vertices that the frame leaves out.
  std::size_t outside_count() const { return outside_count_; }
  double page_height() const { return header_height + height_px_ + footer_height; }
  double px_per_unit() const { return px_per_subunit_ * static_cast<double>(subunits_per_unit); }

  PictureSpot spot(const Point& point) const;

  bool shows(const Point& point) const {
    return low_.x <= point.x && point.x <= high_.x && low_.y <= point.y && point.y <= high_.y;
  }

 private:
  std::size_t outside_count_ = 0;
  Point low_;
  Point high_;
  double px_per_subunit_ = 0;
  double height_px_ = map_height_min;
  double left_ = page_width / 2;
  double bottom_ = header_height;
};

}  // namespace etcm::files

// The plan of the site: a picture that is drawn below the mesh, and a world file that says where it
// lies.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "firmware/config/settings.h"
#include "firmware/site/site_plane.h"

namespace etcm::firmware {

// The picture is kept in memory, so it is bounded: what is larger makes no better map.
inline constexpr std::size_t plan_bytes_max = std::size_t{8} * 1024 * 1024;
inline constexpr std::uint32_t plan_side_max = 8192;  // pixels

// Reads what `plan` in [site] names, and adds it to the settings; without `plan` nothing happens.
// Its world file counts in what `plan_in` says; without that in what the plane counts in where the
// site has no degrees or a corner can be none, and else that is a mistake: nobody can tell.
// Each mistake adds one line "file: what; the cure" to `mistakes`. After read_site().
void read_plan(Settings& settings, std::vector<std::string>& mistakes);

struct PlanPlace {
  double x = 0;  // in units of the mesh
  double y = 0;
};
// The upper left, upper right and lower left corner of the picture in the mesh. None where a corner
// is beyond the plane of the mesh, and of a plan in degrees as long as nobody knows where the plane
// is on the earth.
std::optional<std::array<PlanPlace, 3>> plan_corners(const SitePlan& plan, const SitePlane& plane);

}  // namespace etcm::firmware

#include "firmware/config/site_plan.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <string_view>
#include <system_error>
#include <utility>

#include "firmware/fleet/fleet_hash.h"

namespace etcm::firmware {

namespace {

namespace fs = std::filesystem;

// A big-endian number of so many bytes. REQUIRES: they are there.
std::uint32_t number_at(std::string_view bytes, std::size_t at, std::size_t count) {
  std::uint32_t value = 0;
  for (std::size_t i = 0; i < count; ++i) {
    value = value << 8 | static_cast<unsigned char>(bytes[at + i]);
  }
  return value;
}

struct PictureSize {
  const char* media_type = nullptr;
  std::uint32_t width = 0;
  std::uint32_t height = 0;
};

std::optional<PictureSize> size_of_png(std::string_view bytes) {
  constexpr std::string_view head("\x89PNG\r\n\x1a\n\0\0\0\rIHDR", 16);
  if (!bytes.starts_with(head) || bytes.size() < head.size() + 8) return std::nullopt;
  return PictureSize{"image/png", number_at(bytes, 16, 4), number_at(bytes, 20, 4)};
}

// The size stands in the frame header, behind segments of other kinds.
std::optional<PictureSize> size_of_jpeg(std::string_view bytes) {
  if (!bytes.starts_with("\xff\xd8")) return std::nullopt;
  std::size_t at = 2;
  while (at + 9 <= bytes.size()) {
    if (number_at(bytes, at, 1) != 0xff) return std::nullopt;
    const std::uint32_t kind = number_at(bytes, at + 1, 1);
    if (kind == 0xff) {  // to fill up
      ++at;
      continue;
    }
    // Start of frame; these three among them are tables.
    if (kind >= 0xc0 && kind <= 0xcf && kind != 0xc4 && kind != 0xc8 && kind != 0xcc) {
      return PictureSize{"image/jpeg", number_at(bytes, at + 7, 2), number_at(bytes, at + 5, 2)};
    }
    at += 2 + number_at(bytes, at + 2, 2);
  }
  return std::nullopt;
}

// Names of the world file of a picture, as map programs give them: the first and the last letter of
// the extension with a "w", the whole with one, or "wld".
std::vector<fs::path> world_files(const fs::path& picture) {
  std::vector<fs::path> paths;
  const std::string extension = picture.extension().string();  // with its dot
  if (extension.size() > 2) {
    const std::string short_form{'.', extension[1], extension.back(), 'w'};
    for (const std::string& other : {short_form, extension + "w", std::string(".wld")}) {
      paths.push_back(fs::path(picture).replace_extension(other));
    }
  } else {
    paths.push_back(fs::path(picture).replace_extension(".wld"));
  }
  return paths;
}

// Six numbers, and nothing else.
std::optional<std::array<double, 6>> read_world(std::string_view text) {
  std::array<double, 6> numbers{};
  std::istringstream words{std::string(text)};
  std::string word;
  std::size_t count = 0;
  while (words >> word) {
    if (count == numbers.size()) return std::nullopt;
    const char* const first = word.data() + (word.starts_with('+') ? 1 : 0);
    const auto [end, error] = std::from_chars(first, word.data() + word.size(), numbers[count]);
    if (error != std::errc{} || end != word.data() + word.size()) return std::nullopt;
    if (!std::isfinite(numbers[count])) return std::nullopt;
    ++count;
  }
  if (count != numbers.size()) return std::nullopt;
  return numbers;
}

// Not more than a byte above `most`, so that what is too large is not read.
std::string read_at_most(const fs::path& path, std::size_t most) {
  std::ifstream file(path, std::ios::binary);
  std::string bytes(most + 1, '\0');
  file.read(bytes.data(), static_cast<std::streamsize>(bytes.size()));
  bytes.resize(static_cast<std::size_t>(file.gcount()));
  return bytes;
}

// What is wrong with it, or an empty text; then `plan` has the picture.
std::string take_picture(const std::string& path, SitePlan& plan) {
  plan.bytes = read_at_most(path, plan_bytes_max);
  if (plan.bytes.empty()) return path + ": cannot be read; let the gateway's user read it";
  if (plan.bytes.size() > plan_bytes_max) {
    return path + ": has more than " + std::to_string(plan_bytes_max) +
           " bytes, the most for a plan; save it smaller or coarser";
  }
  std::optional<PictureSize> size = size_of_png(plan.bytes);
  if (!size) size = size_of_jpeg(plan.bytes);
  if (!size || size->width == 0 || size->height == 0) {
    return path + ": is neither a PNG nor a JPEG; save the plan as one of these";
  }
  if (size->width > plan_side_max || size->height > plan_side_max) {
    return path + ": has " + std::to_string(size->width) + " x " + std::to_string(size->height) +
           " pixels, and a plan has " + std::to_string(plan_side_max) +
           " at the most on each side; save it coarser";
  }
  plan.media_type = size->media_type;
  plan.width = size->width;
  plan.height = size->height;
  plan.version = fnv_hash(plan.bytes) | 1;
  return {};
}

std::string take_world(const std::string& path, SitePlan& plan) {
  const std::vector<fs::path> names = world_files(path);
  std::error_code ignored;
  const auto found = std::find_if(names.begin(), names.end(), [&](const fs::path& name) {
    return fs::is_regular_file(name, ignored);
  });
  if (found == names.end()) {
    std::string all;
    for (const fs::path& name : names) {
      all += (all.empty() ? "" : ", ") + name.filename().string();
    }
    return path + ": a world file that says where it lies is missing; put one beside it (" + all +
           ")";
  }
  constexpr std::size_t world_bytes_max = 4096;
  const auto numbers = read_world(read_at_most(*found, world_bytes_max));
  if (!numbers) {
    return found->string() +
           ": is no world file; it has six numbers, a line each: width of a pixel, two turns (0), "
           "height of a pixel (below 0), x and y of the middle of the upper left pixel";
  }
  plan.world = *numbers;
  const auto& [across_x, across_y, down_x, down_y, x, y] = plan.world;
  if (across_x * down_y - down_x * across_y == 0) {
    return found->string() + ": its pixels have no area; correct the first and the fourth number";
  }
  return {};
}

struct PlanPoint {
  double x = 0;
  double y = 0;
};

// A corner as the world file counts, by parts of the width and of the height.
PlanPoint corner_of(const SitePlan& plan, double across, double down) {
  const auto& [across_x, across_y, down_x, down_y, x, y] = plan.world;
  const double column = across * plan.width - 0.5;  // the numbers are of the middle of a pixel
  const double row = down * plan.height - 0.5;
  return {across_x * column + down_x * row + x, across_y * column + down_y * row + y};
}

bool can_be_degrees(const SitePlan& plan) {
  for (const auto& [across, down] : {std::pair{0, 0}, {0, 1}, {1, 0}, {1, 1}}) {
    const PlanPoint corner = corner_of(plan, across, down);
    if (std::abs(corner.x) > 180 || std::abs(corner.y) > 90) return false;
  }
  return true;
}

// The plane of a gateway without a site of its own may come from another one of its fleet.
bool may_have_degrees(const Settings& settings) {
  const SiteSettings& site = settings.site;
  return site.projection != nullptr || (settings.mqtt && site.path.empty());
}

// What is wrong with what it counts in, or an empty text; then `plan` knows what that is.
std::string take_frame(const Settings& settings, const std::string& path, SitePlan& plan) {
  const bool has_degrees = may_have_degrees(settings);
  const bool can_be = can_be_degrees(plan);
  switch (settings.site.plan_in) {
    case PlanIn::plane:
      return {};
    case PlanIn::degrees:
      plan.is_in_degrees = true;
      if (!can_be) {
        return path +
               ": its world file leads beyond the degrees of the earth; correct it, or write "
               "plan_in = \"plane\" in [site]";
      }
      if (has_degrees) return {};
      return path +
             ": its world file is said to be in degrees, and the site has none; take plan_in out "
             "of [site], or say where the site is by 'crs' or 'origin'";
    case PlanIn::unsaid:
      break;
  }
  if (!has_degrees || !can_be) return {};
  return path +
         ": its world file can be in degrees, or in what the plane of the site counts in; say "
         "which in [site]: plan_in = \"degrees\" or plan_in = \"plane\"";
}

}  // namespace

std::optional<std::array<PlanPlace, 3>> plan_corners(const SitePlan& plan, const SitePlane& plane) {
  constexpr double scale = static_cast<double>(site_nano);
  std::array<PlanPoint, 3> corners{corner_of(plan, 0, 0), corner_of(plan, 1, 0),
                                   corner_of(plan, 0, 1)};
  if (plan.is_in_degrees && plane.projection == nullptr) return std::nullopt;
  std::array<PlanPlace, 3> places;
  for (std::size_t i = 0; i < corners.size(); ++i) {
    PlanPoint at{corners[i].x * scale, corners[i].y * scale};
    if (plan.is_in_degrees) {
      const auto projected = plane.projection->to_plane(
          {.longitude = std::llround(at.x), .latitude = std::llround(at.y)});
      if (!projected) return std::nullopt;
      at = {static_cast<double>(projected->x), static_cast<double>(projected->y)};
    }
    const auto unit = static_cast<double>(plane.unit_length);
    places[i] = {(at.x - static_cast<double>(plane.origin_x)) / unit,
                 (at.y - static_cast<double>(plane.origin_y)) / unit};
    if (std::abs(places[i].x) > 2.0 * position_max || std::abs(places[i].y) > 2.0 * position_max) {
      return std::nullopt;
    }
  }
  return places;
}

void read_plan(Settings& settings, std::vector<std::string>& mistakes) {
  settings.site.plan = nullptr;
  const std::string& path = settings.site.plan_path;
  if (path.empty()) return;
  std::error_code ignored;
  if (!fs::is_regular_file(path, ignored)) {
    mistakes.push_back(settings.site.source + ": the plan " + path +
                       " is not there; correct 'plan'");
    return;
  }
  auto plan = std::make_shared<SitePlan>();
  std::string wrong = take_picture(path, *plan);
  if (wrong.empty()) wrong = take_world(path, *plan);
  // Where the site itself is wrong nobody knows which plane it has.
  if (wrong.empty() && mistakes.empty()) wrong = take_frame(settings, path, *plan);
  const bool is_to_come = plan->is_in_degrees && settings.site.projection == nullptr;
  if (wrong.empty() && mistakes.empty() && !is_to_come &&
      !plan_corners(*plan, settings.site.plane())) {
    wrong = path +
            ": lies beyond the plane of the mesh; let its world file count as the site does, or in "
            "degrees where the site has them";
  }
  if (!wrong.empty()) {
    mistakes.push_back(wrong);
    return;
  }
  settings.site.plan = std::move(plan);
}

}  // namespace etcm::firmware

#include "proj/proj_projection.h"

#include <proj.h>

#include <cmath>
#include <cstdio>
#include <utility>

namespace etcm::port {

namespace {

constexpr double nano = 1e9;

// None where it does not fit; as NaN does not.
std::optional<std::int64_t> to_nano(double value) {
  const double scaled = std::nearbyint(value * nano);
  if (!(scaled > -9.2e18 && scaled < 9.2e18)) return std::nullopt;
  return static_cast<std::int64_t>(scaled);
}

struct DestroyContext {
  void operator()(PJ_CONTEXT* context) const { proj_context_destroy(context); }
};
struct Destroy {
  void operator()(PJ* transformation) const { proj_destroy(transformation); }
};

class ProjProjection final : public Projection {
 public:
  ProjProjection(std::unique_ptr<PJ_CONTEXT, DestroyContext> context,
                 std::unique_ptr<PJ, Destroy> transformation)
      : context_(std::move(context)), transformation_(std::move(transformation)) {}

  std::optional<PlanePoint> to_plane(EarthPoint point) const override {
    const auto found = go(PJ_FWD, point.longitude, point.latitude);
    if (!found) return std::nullopt;
    return PlanePoint{.x = found->first, .y = found->second};
  }

  std::optional<EarthPoint> to_earth(PlanePoint point) const override {
    const auto found = go(PJ_INV, point.x, point.y);
    if (!found) return std::nullopt;
    return EarthPoint{.longitude = found->first, .latitude = found->second};
  }

 private:
  std::optional<std::pair<std::int64_t, std::int64_t>> go(PJ_DIRECTION direction, std::int64_t x,
                                                          std::int64_t y) const {
    const PJ_COORD from =
        proj_coord(static_cast<double>(x) / nano, static_cast<double>(y) / nano, 0, HUGE_VAL);
    const PJ_COORD to = proj_trans(transformation_.get(), direction, from);
    const auto first = to_nano(to.xy.x);
    const auto second = to_nano(to.xy.y);
    proj_errno_reset(transformation_.get());
    if (!first || !second) return std::nullopt;
    return std::pair(*first, *second);
  }

  std::unique_ptr<PJ_CONTEXT, DestroyContext> context_;  // outlives the transformation
  std::unique_ptr<PJ, Destroy> transformation_;
};

}  // namespace

std::unique_ptr<const Projection> make_projection(const std::string& crs, std::string& why) {
  std::unique_ptr<PJ_CONTEXT, DestroyContext> context(proj_context_create());
  // What is wrong is said in `why`; and no grid is fetched from anywhere.
  proj_log_level(context.get(), PJ_LOG_NONE);
  proj_context_set_enable_network(context.get(), 0);
  std::unique_ptr<PJ, Destroy> made(
      proj_create_crs_to_crs(context.get(), "OGC:CRS84", crs.c_str(), nullptr));
  // East before north, whatever the system says.
  std::unique_ptr<PJ, Destroy> usual(
      made == nullptr ? nullptr : proj_normalize_for_visualization(context.get(), made.get()));
  if (usual == nullptr) {
    const int error = proj_context_errno(context.get());
    const char* const text = error == 0 ? nullptr : proj_context_errno_string(context.get(), error);
    why = text != nullptr ? text : "PROJ does not know it";
    return nullptr;
  }
  return std::make_unique<ProjProjection>(std::move(context), std::move(usual));
}

std::unique_ptr<const Projection> make_local_projection(EarthPoint center, std::string& why) {
  char crs[160];
  std::snprintf(crs, sizeof crs,
                "+proj=tmerc +lat_0=%.9f +lon_0=%.9f +k=1 +x_0=0 +y_0=0 +datum=WGS84 +units=m "
                "+no_defs +type=crs",
                static_cast<double>(center.latitude) / nano,
                static_cast<double>(center.longitude) / nano);
  return make_projection(crs, why);
}

}  // namespace etcm::port

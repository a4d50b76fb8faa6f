#include "proj/proj_source.h"

#include <cmath>
#include <cstdio>
#include <mutex>
#include <utility>

#include "proj/proj_library.h"

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
  const ProjLibrary* proj;
  void operator()(PJ_CONTEXT* context) const { proj->context_destroy(context); }
};
struct Destroy {
  const ProjLibrary* proj;
  void operator()(PJ* made) const { proj->destroy(made); }
};
using Context = std::unique_ptr<PJ_CONTEXT, DestroyContext>;
using Made = std::unique_ptr<PJ, Destroy>;

bool is_geographic(PJ_TYPE type) {
  return type == PJ_TYPE_GEOGRAPHIC_2D_CRS || type == PJ_TYPE_GEOGRAPHIC_3D_CRS;
}

class ProjProjection final : public Projection {
 public:
  ProjProjection(const ProjLibrary& proj, Context context, Made transformation, bool in_degrees,
                 double metres)
      : proj_(proj),
        context_(std::move(context)),
        transformation_(std::move(transformation)),
        in_degrees_(in_degrees),
        metres_(metres) {}

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

  bool counts_in_degrees() const override { return in_degrees_; }
  double metres() const override { return metres_; }

 private:
  std::optional<std::pair<std::int64_t, std::int64_t>> go(PJ_DIRECTION direction, std::int64_t x,
                                                          std::int64_t y) const {
    PJ_COORD from{};
    from.v[0] = static_cast<double>(x) / nano;
    from.v[1] = static_cast<double>(y) / nano;
    from.v[3] = HUGE_VAL;  // no time
    const std::lock_guard lock(mutex_);
    const PJ_COORD to = proj_.trans(transformation_.get(), direction, from);
    proj_.errno_reset(transformation_.get());
    const auto first = to_nano(to.v[0]);
    const auto second = to_nano(to.v[1]);
    if (!first || !second) return std::nullopt;
    return std::pair(*first, *second);
  }

  const ProjLibrary& proj_;
  mutable std::mutex mutex_;
  Context context_;  // outlives the transformation
  Made transformation_;
  bool in_degrees_;
  double metres_;
};

// Of the first axis; 0 where PROJ does not say.
double metres_of(const ProjLibrary& proj, PJ_CONTEXT* context, const PJ* plane) {
  const Made axes(proj.crs_get_coordinate_system(context, plane), Destroy{&proj});
  double metres = 0;
  if (axes == nullptr || proj.cs_get_axis_info(context, axes.get(), 0, nullptr, nullptr, nullptr,
                                               &metres, nullptr, nullptr, nullptr) == 0) {
    return 0;
  }
  return metres;
}

}  // namespace

std::shared_ptr<const Projection> ProjSource::of_crs(const std::string& crs, std::string& why) {
  const ProjLibrary* const proj = load_proj(why);
  if (proj == nullptr) return nullptr;
  Context context(proj->context_create(), DestroyContext{proj});
  // What is wrong is said in `why`.
  proj->log_level(context.get(), PJ_LOG_NONE);
  proj->context_set_enable_network(context.get(), 0);
  const auto keep = [&](PJ* made) { return Made(made, Destroy{proj}); };
  const Made earth = keep(proj->create(context.get(), "OGC:CRS84"));
  const Made plane = keep(proj->create(context.get(), crs.c_str()));
  if (earth == nullptr) {
    why = "PROJ finds no database of coordinate systems (apt-get install proj-data)";
    return nullptr;
  }
  if (plane == nullptr) {
    why = "PROJ does not know it";
    return nullptr;
  }
  const Made between = keep(
      proj->create_crs_to_crs_from_pj(context.get(), earth.get(), plane.get(), nullptr, nullptr));
  // East before north, whatever the system says.
  Made usual =
      keep(between == nullptr ? nullptr
                              : proj->normalize_for_visualization(context.get(), between.get()));
  if (usual == nullptr) {
    why = "PROJ knows no way to it from WGS 84";
    return nullptr;
  }
  const bool in_degrees = is_geographic(proj->get_type(plane.get()));
  const double metres = in_degrees ? 0 : metres_of(*proj, context.get(), plane.get());
  return std::make_shared<ProjProjection>(*proj, std::move(context), std::move(usual), in_degrees,
                                          metres);
}

std::shared_ptr<const Projection> ProjSource::about(EarthPoint center, std::string& why) {
  char crs[160];
  std::snprintf(crs, sizeof crs,
                "+proj=tmerc +lat_0=%.9f +lon_0=%.9f +k=1 +x_0=0 +y_0=0 +datum=WGS84 +units=m "
                "+no_defs +type=crs",
                static_cast<double>(center.latitude) / nano,
                static_cast<double>(center.longitude) / nano);
  return of_crs(crs, why);
}

}  // namespace etcm::port

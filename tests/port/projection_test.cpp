// Degrees and the plane, by PROJ.
#include "etcm/port/projection.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>

#include "proj/proj_source.h"

namespace etcm::port {
namespace {

constexpr std::int64_t nano = 1'000'000'000;

EarthPoint degrees(double longitude, double latitude) {
  return {.longitude = std::llround(longitude * 1e9), .latitude = std::llround(latitude * 1e9)};
}

std::shared_ptr<const Projection> about(EarthPoint center) {
  std::string why;
  auto made = ProjSource().about(center, why);
  EXPECT_NE(made, nullptr) << why;
  return made;
}

// The geodetic length of so many degrees of latitude, or of longitude there, of the ellipsoid of
// WGS 84: the radii of curvature, written down here.
double meridian_radius(double latitude) {
  const double a = 6378137, e2 = 0.00669437999014;
  const double s = std::sin(latitude);
  return a * (1 - e2) / std::pow(1 - e2 * s * s, 1.5);
}
double parallel_radius(double latitude) {
  const double a = 6378137, e2 = 0.00669437999014;
  const double s = std::sin(latitude);
  return a / std::sqrt(1 - e2 * s * s) * std::cos(latitude);
}

constexpr double radian = 3.14159265358979323846 / 180;

struct Site {
  const char* name;
  double longitude, latitude;
};

class LocalProjection : public testing::TestWithParam<Site> {};

TEST_P(LocalProjection, CountsInMetresAboutItsCenter) {
  const Site& site = GetParam();
  const auto plane = about(degrees(site.longitude, site.latitude));
  const auto center = plane->to_plane(degrees(site.longitude, site.latitude));
  ASSERT_TRUE(center);
  EXPECT_LE(std::abs(center->x), 1000);
  EXPECT_LE(std::abs(center->y), 1000);
  const double step = 0.001;
  const auto east = plane->to_plane(degrees(site.longitude + step, site.latitude));
  const auto north = plane->to_plane(degrees(site.longitude, site.latitude + step));
  ASSERT_TRUE(east && north);
  EXPECT_NEAR(static_cast<double>(east->x) / 1e9,
              step * radian * parallel_radius(site.latitude * radian), 0.001);
  EXPECT_NEAR(static_cast<double>(north->y) / 1e9,
              step * radian * meridian_radius(site.latitude * radian), 0.001);
}

TEST(ProjectionUnit, IsThatOfTheSystem) {
  std::string why;
  EXPECT_EQ(about(degrees(10, 60))->metres(), 1);
  EXPECT_EQ(ProjSource().of_crs("EPSG:25832", why)->metres(), 1);
  EXPECT_NEAR(ProjSource().of_crs("EPSG:2263", why)->metres(), 1200.0 / 3937, 1e-9) << "US feet";
  EXPECT_EQ(ProjSource().of_crs("EPSG:4326", why)->metres(), 0) << "degrees";
}

TEST_P(LocalProjection, RoundTripsWithinATenthOfAMillimetre) {
  const Site& site = GetParam();
  const auto plane = about(degrees(site.longitude, site.latitude));
  for (double dx = -0.2; dx <= 0.2; dx += 0.05) {
    for (double dy = -0.1; dy <= 0.1; dy += 0.05) {
      double longitude = site.longitude + dx;
      if (longitude > 180) longitude -= 360;
      if (longitude < -180) longitude += 360;
      const EarthPoint point = degrees(longitude, site.latitude + dy);
      const auto there = plane->to_plane(point);
      ASSERT_TRUE(there);
      const auto back = plane->to_earth(*there);
      ASSERT_TRUE(back);
      // 10^-9 degrees are a tenth of a millimetre.
      EXPECT_LE(std::abs(back->latitude - point.latitude), 1);
      const std::int64_t off = std::abs(back->longitude - point.longitude);
      EXPECT_LE(std::min(off, std::abs(off - 360 * nano)), 2);
      const auto again = plane->to_plane(*back);
      ASSERT_TRUE(again);
      EXPECT_LE(std::abs(again->x - there->x), nano / 5000);
      EXPECT_LE(std::abs(again->y - there->y), nano / 5000);
    }
  }
}

// Within 20 km a site over the date line has no jump in it.
TEST_P(LocalProjection, HasNeighboursBesideEachOther) {
  const Site& site = GetParam();
  const auto plane = about(degrees(site.longitude, site.latitude));
  std::optional<PlanePoint> before;
  for (double dx = -0.2; dx <= 0.2; dx += 0.01) {
    double longitude = site.longitude + dx;
    if (longitude > 180) longitude -= 360;
    const auto point = plane->to_plane(degrees(longitude, site.latitude));
    ASSERT_TRUE(point);
    if (before) {
      EXPECT_NEAR(static_cast<double>(point->x - before->x) / 1e9,
                  0.01 * radian * parallel_radius(site.latitude * radian), 0.1);
    }
    before = point;
  }
}

INSTANTIATE_TEST_SUITE_P(
    Sites, LocalProjection,
    testing::Values(Site{"trondheim", 10.3951, 63.4305}, Site{"between_zones", 12.0, 63.4},
                    Site{"longyearbyen_and_north", 15.6, 80.0}, Site{"equator", -79.9, 0.0},
                    Site{"fiji_at_the_date_line", 179.95, -16.8}, Site{"south", -68.3, -54.8}),
    [](const auto& row) { return row.param.name; });

TEST(NamedProjection, IsThatOfItsAuthority) {
  std::string why;
  const auto utm = ProjSource().of_crs("EPSG:25832", why);
  ASSERT_NE(utm, nullptr) << why;
  // The central meridian of zone 32 at the equator: 500 km east by definition.
  const auto point = utm->to_plane(degrees(9, 0));
  ASSERT_TRUE(point);
  EXPECT_NEAR(static_cast<double>(point->x) / 1e9, 500'000, 0.001);
  EXPECT_NEAR(static_cast<double>(point->y) / 1e9, 0, 0.001);
}

TEST(NamedProjection, ThatIsUnknownSaysSo) {
  for (const char* crs : {"EPSG:999999", "nonsense", "", "+proj=none"}) {
    std::string why;
    EXPECT_EQ(ProjSource().of_crs(crs, why), nullptr) << crs;
    EXPECT_FALSE(why.empty()) << crs;
  }
}

TEST(NamedProjection, WhatItCannotShowIsNone) {
  std::string why;
  const auto plane = ProjSource().about({}, why);
  ASSERT_NE(plane, nullptr) << why;
  EXPECT_FALSE(plane->to_earth({.x = 9'000'000'000 * nano, .y = 9'000'000'000 * nano}));
}

}  // namespace
}  // namespace etcm::port

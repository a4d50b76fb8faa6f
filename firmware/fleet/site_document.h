// What all members of a site must have the same beside the nodes: plane, features, anchors, domain.
#pragma once

#include <compare>
#include <cstdint>
#include <string>
#include <vector>

#include "firmware/site/feature_end.h"
#include "firmware/site/site_domain.h"

namespace etcm::firmware {

struct SiteFeature {
  FeatureEnd from;
  FeatureEnd to;
  std::string name{};  // at most site_name_max bytes
  friend bool operator==(const SiteFeature&, const SiteFeature&) = default;
};

inline constexpr std::size_t site_name_max = 64;
inline constexpr std::size_t site_crs_max = 128;
// From one document to the next the number rises by no more.
inline constexpr std::uint32_t site_leap_max = 1'000'000;

// Where the plane of the site is. Lengths are in 10^-9 of what the plane counts in.
struct DocumentPlane {
  std::string crs{};  // its coordinate system; empty: metres about a place, or a drawing
  // The plane is metres about `x` and `y`, a longitude and a latitude in 10^-9 of a degree. Else
  // these are the mesh's (0, 0).
  bool is_about_place = false;
  std::int64_t unit = 0;  // of the mesh; greater than 0
  std::int64_t x = 0;
  std::int64_t y = 0;
  friend bool operator==(const DocumentPlane&, const DocumentPlane&) = default;
};

// The greater one is newer.
struct SiteVersion {
  std::uint32_t number = 0;  // 0: there is no document
  std::uint64_t hash = 0;    // of the content
  friend auto operator<=>(const SiteVersion&, const SiteVersion&) = default;
};

struct SiteDocument {
  std::uint32_t number = 0;  // at least 1, at most fleet_number_max
  std::string gateway{};     // whose site file it is from
  // The content.
  DocumentPlane plane{};
  std::vector<SiteFeature> features{};
  std::vector<Position> anchors{};
  // Of the domain; between whole units.
  std::vector<DomainEdge> outline{};
  std::vector<DomainEdge> holes{};

  // Its hash is that of the content, in the order given. O(size).
  SiteVersion version() const;
  // "the site of gateway 'north', number 4,"
  std::string name() const;
  friend bool operator==(const SiteDocument&, const SiteDocument&) = default;
};

}  // namespace etcm::firmware

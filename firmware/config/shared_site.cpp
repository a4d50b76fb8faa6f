#include "firmware/config/shared_site.h"

#include <algorithm>
#include <map>
#include <set>
#include <span>
#include <utility>
#include <vector>

#include "etcm/port/utf8.h"
#include "firmware/config/configuration.h"
#include "firmware/config/site_projection.h"
#include "firmware/logging/nano_text.h"

namespace etcm::firmware {

namespace {

// As it is written in [site].
std::string plane_text(const DocumentPlane& plane) {
  std::string text = "unit = \"" + nano_text(plane.unit) + "\", origin = [\"" + nano_text(plane.x) +
                     "\", \"" + nano_text(plane.y) + "\"]";
  if (plane.is_about_place) text += " (degrees)";
  if (!plane.crs.empty()) text += ", crs = \"" + plane.crs + "\"";
  return text;
}

// The operator has said which plane it is.
bool has_own_plane(const Settings& settings) {
  const SiteSettings& site = settings.site;
  const bool is_set =
      !site.crs.empty() || site.unit_length != site_nano || site.origin != SiteOrigin{};
  return is_set || has_own_site(settings) ||
         std::any_of(settings.nodes.begin(), settings.nodes.end(),
                     [](const NodeSettings& node) { return node.x.has_value(); });
}

std::string take_plane(const DocumentPlane& plane, port::ProjectionSource* projections,
                       Settings& settings) {
  SiteSettings& site = settings.site;
  if (plane_of(site) == plane) return "";
  if (has_own_plane(settings)) {
    return "it is in another plane, with " + plane_text(plane) + ", and this gateway has " +
           plane_text(plane_of(site)) +
           "; set these in [site] as they are there, or take them out where this gateway has no "
           "site file";
  }
  std::string why;
  const std::optional<SitePlane> taken = site_plane_of(plane, projections, why);
  if (!taken) return "its plane, " + plane_text(plane) + ", cannot be had: " + why;
  if (taken->projection != nullptr && taken->projection->counts_in_degrees()) {
    return "its plane, " + plane.crs +
           ", counts in degrees; name a projected one at the "
           "gateway that has the site file";
  }
  site.unit_length = plane.unit;
  site.projection = taken->projection;
  site.projected_crs = plane.crs;
  site.center.reset();
  site.has_origin_in_degrees = plane.is_about_place;
  site.origin = {.x = plane.x, .y = plane.y};
  if (plane.is_about_place) site.center = {.longitude = plane.x, .latitude = plane.y};
  std::vector<std::string> mistakes;
  place_nodes(settings, mistakes);
  return mistakes.empty() ? "" : mistakes.front();
}

// What a site file cannot have by the way it is read.
std::string check_form(const SiteDocument& document) {
  std::set<std::uint64_t> anchors;
  for (const Position anchor : document.anchors) {
    const FeatureEnd end = FeatureEnd::anchor(anchor);
    if (!anchors.insert(end.key()).second) return "the anchor at " + to_string(end) + " repeats";
  }
  for (const SiteFeature& feature : document.features) {
    for (const FeatureEnd& end : {feature.from, feature.to}) {
      if (end.is_anchor && !anchors.contains(end.key())) {
        return "a feature ends at " + to_string(end) + ", where no anchor is";
      }
    }
    if (feature.from == feature.to)
      return "a feature ends where it begins, " + to_string(feature.to);
  }
  return "";
}

bool are_rings(std::span<const DomainEdge> edges) {
  std::map<std::pair<std::int64_t, std::int64_t>, std::uint32_t> ends_at;
  for (const DomainEdge& edge : edges) {
    if (edge.from == edge.to) return false;
    ++ends_at[{edge.from.x, edge.from.y}];
    ++ends_at[{edge.to.x, edge.to.y}];
  }
  return std::all_of(ends_at.begin(), ends_at.end(),
                     [](const auto& corner) { return corner.second % 2 == 0; });
}

}  // namespace

DocumentPlane plane_of(const SiteSettings& site) {
  if (site.center) {
    return {.is_about_place = true,
            .unit = site.unit_length,
            .x = site.center->longitude,
            .y = site.center->latitude};
  }
  return {.crs = site.projection != nullptr ? site.projected_crs : "",
          .unit = site.unit_length,
          .x = site.origin.x,
          .y = site.origin.y};
}

std::optional<SitePlane> site_plane_of(const DocumentPlane& plane,
                                       port::ProjectionSource* projections, std::string& why) {
  std::shared_ptr<const port::Projection> projection;
  why = "this gateway was built without PROJ";
  if (plane.is_about_place && projections != nullptr) {
    projection = projections->about({.longitude = plane.x, .latitude = plane.y}, why);
  } else if (!plane.crs.empty() && projections != nullptr) {
    projection = projections->of_crs(plane.crs, why);
  }
  const bool is_on_earth = plane.is_about_place || !plane.crs.empty();
  if (is_on_earth && projection == nullptr) return std::nullopt;
  return SitePlane{.unit_length = plane.unit,
                   .origin_x = plane.is_about_place ? 0 : plane.x,
                   .origin_y = plane.is_about_place ? 0 : plane.y,
                   .projection = std::move(projection)};
}

bool has_own_site(const Settings& settings) {
  return !settings.site.path.empty() || !settings.features.empty() || !settings.anchors.empty();
}

SiteDocument document_of(const Settings& settings) {
  SiteDocument document{.plane = plane_of(settings.site)};
  for (const FeatureSettings& feature : settings.features) {
    document.features.push_back({.from = feature.from,
                                 .to = feature.to,
                                 .name = std::string(port::cut_utf8(feature.name, site_name_max))});
  }
  for (const AnchorSettings& anchor : settings.anchors) document.anchors.push_back(anchor.position);
  const std::span<const DomainEdge> outline = settings.domain.outline();
  const std::span<const DomainEdge> holes = settings.domain.holes();
  document.outline.assign(outline.begin(), outline.end());
  document.holes.assign(holes.begin(), holes.end());
  return document;
}

std::optional<Settings> with_site(const Settings& settings, const SiteDocument& document,
                                  port::ProjectionSource* projections, std::string& wrong) {
  Settings next = settings;
  wrong = take_plane(document.plane, projections, next);
  if (wrong.empty()) wrong = check_form(document);
  if (wrong.empty() && !(are_rings(document.outline) && are_rings(document.holes))) {
    wrong = "its outline or its holes are no closed rings";
  }
  if (!wrong.empty()) return std::nullopt;
  const std::string source = "site of " + document.gateway;
  next.features.clear();
  next.anchors.clear();
  for (const SiteFeature& feature : document.features) {
    next.features.push_back(
        {.from = feature.from, .to = feature.to, .name = feature.name, .source = source});
  }
  for (const Position anchor : document.anchors) {
    next.anchors.push_back({.position = anchor, .source = source});
  }
  next.domain = SiteDomain(document.outline, document.holes);
  next.site.path = source;
  std::vector<std::string> mistakes;
  check_site(source, next, mistakes);
  next.site.path = settings.site.path;
  if (mistakes.empty()) return next;
  wrong = mistakes.front();
  if (mistakes.size() > 1) wrong += " (and " + std::to_string(mistakes.size() - 1) + " more)";
  return std::nullopt;
}

}  // namespace etcm::firmware

#include "firmware/config/configuration.h"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <map>
#include <span>
#include <utility>

#include "etcm/mesh.h"
#include "firmware/config/site.h"
#include "firmware/config/site_plan.h"
#include "firmware/config/site_scale.h"
#include "firmware/site/coverage_domain.h"
#include "firmware/site/feature_meeting.h"
#include "firmware/toml/toml_table.h"

namespace etcm::firmware {

namespace {

std::string text_of(const FeatureSettings& feature) {
  if (!feature.name.empty()) return "'" + feature.name + "'";
  return "the line from " + to_string(feature.from) + " to " + to_string(feature.to);
}

// In millionths, without zeros at the end.
std::string decimal_of(double value) {
  std::string text = std::to_string(value);
  text.resize(text.find_last_not_of('0') + 1);
  if (text.ends_with('.')) text.pop_back();
  return text == "-0" ? "0" : text;
}

// Where two lines between anchors cross, as their file has coordinates: " at (10.3951, 63.4305)";
// empty where they do not.
std::string meeting_text(const Settings& settings, const FeatureSettings& one,
                         const FeatureSettings& other) {
  const auto line_of = [](const FeatureSettings& feature) {
    return FeatureLine{.from = feature.from.position, .to = feature.to.position};
  };
  const auto there = meeting_of(line_of(one), line_of(other)).near_crossing;
  if (!there) return {};
  const SitePlane plane = settings.site.plane();
  const auto nano = [](double value) { return decimal_of(value / 1e9); };
  if (const auto degrees = earth_point(plane, to_point(*there))) {
    return " at longitude " + nano(static_cast<double>(degrees->longitude)) + ", latitude " +
           nano(static_cast<double>(degrees->latitude));
  }
  const auto coordinate = [&](std::int64_t origin, std::int32_t units) {
    return nano(static_cast<double>(origin) + static_cast<double>(plane.unit_length) * units);
  };
  return " at (" + coordinate(plane.origin_x, there->x) + ", " +
         coordinate(plane.origin_y, there->y) + ")";
}

void check_repeated(const Settings& settings, std::vector<std::string>& mistakes) {
  std::map<std::pair<std::uint64_t, std::uint64_t>, const FeatureSettings*> seen;
  for (const FeatureSettings& feature : settings.features) {
    const auto [entry, is_new] =
        seen.emplace(std::minmax(feature.from.key(), feature.to.key()), &feature);
    if (!is_new) {
      const FeatureSettings& before = *entry->second;
      const bool is_mixed = is_drawn(feature) != is_drawn(before);
      const std::string& listed = is_drawn(feature) ? before.source : feature.source;
      mistakes.push_back(feature.source + ": " + text_of(feature) + " repeats " + before.source +
                         (is_mixed ? "; take the [[feature]] of " + listed +
                                         " out, the site file has its line already"
                                   : "; take one of them out"));
    }
  }
}

void check_room(const std::string& path, const Settings& settings,
                std::vector<std::string>& mistakes) {
  if (settings.features.size() > settings.mesh.features_max) {
    mistakes.push_back(path + ": the site has " + std::to_string(settings.features.size()) +
                       " segments of features, and features_max in [mesh] is " +
                       std::to_string(settings.mesh.features_max) +
                       "; set features_max to twice as many");
  }
  if (settings.anchors.size() >= settings.mesh.vertices_max) {
    mistakes.push_back(path + ": the site has " + std::to_string(settings.anchors.size()) +
                       " anchors, and vertices_max in [mesh] is " +
                       std::to_string(settings.mesh.vertices_max) +
                       "; set vertices_max to three times as many, and twice the nodes");
  }
}

void check_domain(const Settings& settings, std::vector<std::string>& mistakes) {
  if (settings.analysis.sensing_range == 0) return;
  const Status status = CoverageDomain(0).take(settings.domain);
  if (status == Status::ok) return;
  mistakes.push_back(settings.site.path +
                     ": the outline and the holes of the domain: " + explain(status));
}

// The anchors, and the features between anchors: the part of the mesh that is known before any node
// has answered.
class AnchoredPart {
 public:
  explicit AnchoredPart(const Settings& settings) : settings_(settings) {
    std::map<std::uint64_t, VertexId> vertex_at;
    for (const AnchorSettings& anchor : settings.anchors) {
      positions_.push_back(anchor.position);
      vertex_at.emplace(FeatureEnd::anchor(anchor.position).key(),
                        VertexId(static_cast<IdValue>(positions_.size())));
    }
    for (const FeatureSettings& feature : settings.features) {
      if (!feature.from.is_anchor || !feature.to.is_anchor) continue;
      ends_.push_back(
          {.from = vertex_at.at(feature.from.key()), .to = vertex_at.at(feature.to.key())});
      features_.push_back(&feature);
    }
  }

  void check(const std::string& path, std::vector<std::string>& mistakes) const {
    if (positions_.empty()) return;
    const MeshConfig& config = settings_.mesh;
    std::vector<std::byte> memory(storage_bytes(config));
    Mesh mesh;
    Status status = mesh.open(memory, config);
    if (status == Status::ok) status = mesh.build(positions_, ends_);
    if (status == Status::ok) return;
    const ErrorDetail& error_detail = mesh.error_detail();
    const auto feature_of = [&](FeatureId id) {
      return id.is_none() || id.value >= features_.size() ? nullptr : features_[id.value];
    };
    const FeatureSettings* feature = feature_of(error_detail.feature);
    const FeatureSettings* other = feature_of(error_detail.other);
    // Of two that conflict the later one is reported.
    if (feature != nullptr && other != nullptr && error_detail.other > error_detail.feature) {
      std::swap(feature, other);
    }
    const std::string what = feature != nullptr ? feature->source + ": " + text_of(*feature) : path;
    if (feature != nullptr && other != nullptr) {
      mistakes.push_back(
          what + (status == Status::crossing_features ? " crosses " : " runs along ") +
          text_of(*other) + " (" + other->source + ")" + meeting_text(settings_, *feature, *other) +
          "; draw a vertex on both where they meet");
    } else {
      mistakes.push_back(what + ": " + explain(status));
    }
  }

 private:
  const Settings& settings_;
  std::vector<Position> positions_;
  std::vector<FeatureEnds> ends_;
  std::vector<const FeatureSettings*> features_;  // of ends_
};

// A device that neither tells a place nor was surveyed would wait for one for ever.
void check_unsurveyed(Settings& settings) {
  for (const BusSettings& bus : settings.buses) {
    for (const DeviceSettings& device : bus.devices) {
      const Profile* const profile = find_profile(settings, device.profile);
      if (profile == nullptr || profile->positioning != Profile::Positioning::surveyed) continue;
      for (const UnitRange range : device.units) {
        for (const ModbusAddress unit : range) {
          const NodeSettings* const node = node_at(settings, bus, unit);
          if (node != nullptr && node->position) continue;
          settings.warnings.push_back(
              device.source + ": unit " + std::to_string(unit.value) + " of " + bus.name +
              " does not tell where it stands, and nobody says it; add a [[node]] with its place, "
              "or a Point with \"unit\" to the site file");
        }
      }
    }
  }
}

// A serial that is made of bus and unit is made alike in each gateway.
void check_fleet_serials(Settings& settings) {
  if (!settings.mqtt) return;
  for (const BusSettings& bus : settings.buses) {
    for (const DeviceSettings& device : bus.devices) {
      const Profile* const profile = find_profile(settings, device.profile);
      if (profile == nullptr || profile->serial) continue;
      for (const UnitRange range : device.units) {
        for (const ModbusAddress unit : range) {
          const NodeSettings* const node = node_at(settings, bus, unit);
          if (node != nullptr && node->serial) continue;
          settings.warnings.push_back(
              device.source + ": unit " + std::to_string(unit.value) + " of " + bus.name +
              " tells no serial, and the one that is made up for it may be another gateway's too; "
              "add a [[node]] with a serial of its own");
        }
      }
    }
  }
}

// Whoever is surveyed outside of the domain was probably not: its coordinates are swapped.
void check_surveyed(Settings& settings) {
  for (const NodeSettings& node : settings.nodes) {
    if (!node.position || settings.domain.place_of(*node.position) == DomainPlace::inside) continue;
    settings.warnings.push_back(node.source + ": unit " + std::to_string(node.address) + " of " +
                                node.bus + " stands outside the domain of the site" +
                                (node.longitude ? "; are longitude and latitude swapped?"
                                                : "; correct its place, or the outline"));
  }
}

}  // namespace

Settings read_configuration(const std::string& path, port::ProjectionSource* projections,
                            std::vector<std::string>& mistakes) {
  Settings settings = read_settings(path, mistakes);
  // Without good settings the site cannot be placed in a mesh.
  if (validate(settings.mesh) == Status::ok) read_site(settings, projections, mistakes);
  read_plan(settings, mistakes);
  const std::size_t told = settings.site.lacks_center ? 1 : 0;
  if (mistakes.size() == told) check_site(path, settings, mistakes);
  if (mistakes.empty()) {
    check_unsurveyed(settings);
    check_fleet_serials(settings);
    check_surveyed(settings);
    check_scale(settings);
  }
  keep_to_lines(mistakes);
  keep_to_lines(settings.warnings);
  return settings;
}

void check_site(const std::string& path, const Settings& settings,
                std::vector<std::string>& mistakes) {
  const std::size_t before = mistakes.size();
  check_repeated(settings, mistakes);
  check_room(path, settings, mistakes);
  if (mistakes.size() == before) AnchoredPart(settings).check(path, mistakes);
  if (mistakes.size() == before) check_domain(settings, mistakes);
}

}  // namespace etcm::firmware

#include "firmware/config/reload.h"

#include <algorithm>
#include <cstddef>
#include <exception>
#include <string_view>

#include "firmware/config/configuration.h"
#include "firmware/config/settings_keys.h"

namespace etcm::firmware {

namespace {

// Takes over what can change at once, and adds what cannot to `fixed`.
void take_over_table(const KeyTable& table, Settings& current, Settings& next,
                     std::vector<std::string>& fixed) {
  if (table.is_there != nullptr && table.is_there(current) != table.is_there(next)) {
    fixed.push_back(heading_of(table));
    return;
  }
  if (table.is_there != nullptr && !table.is_there(current)) return;
  for (const Key& key : table.keys) {
    if (is_same_value(key.type, &current, &next)) continue;
    if (key.effect == Effect::at_once) {
      copy_value(key.type, &next, &current);
    } else {
      fixed.push_back(path_of(table, key));
    }
  }
}

// Whether the file of `b` says anything else for the key than that of `a`.
bool is_changed(const Key& key, BusSettings& a, BusSettings& b) {
  if (!is_key_of(key, kind_of(b))) return false;
  // Of a link of another kind the link alone is told, not what only such a link has.
  if (!is_key_of(key, kind_of(a))) return key.standard.kind == Standard::Kind::conditional;
  // Nor is a name that only follows the link.
  const bool has_names = a.name != link_name(a) || b.name != link_name(b);
  return !is_same_value(key.type, &a, &b) && (has_names || std::string_view(key.name) != "name");
}

// The same for each [[bus.device]] of a bus. One more or less is another list of units.
bool is_same_device(const Key& key, BusSettings& a, BusSettings& b) {
  if (a.devices.size() != b.devices.size()) return std::string_view(key.name) != "units";
  for (std::size_t i = 0; i < a.devices.size(); ++i) {
    if (!is_same_value(key.type, &a.devices[i], &b.devices[i])) return false;
  }
  return true;
}

// The buses are taken over together: where one of them has to wait for a restart, all do.
void take_over_buses(Settings& current, Settings& next, std::vector<std::string>& fixed) {
  const KeyTable& table = key_table("bus");
  if (current.buses.size() != next.buses.size()) {
    fixed.push_back(heading_of(table));
    return;
  }
  bool must_wait = false;
  std::vector<std::string> changed;
  for (const Key& key : table.keys) {
    bool is_same = true;
    for (std::size_t i = 0; i < next.buses.size(); ++i) {
      is_same = is_same && !is_changed(key, current.buses[i], next.buses[i]);
    }
    if (is_same) continue;
    changed.push_back(path_of(table, key));
    must_wait = must_wait || key.effect == Effect::restart;
  }
  const KeyTable& devices = key_table("bus.device");
  for (const Key& key : devices.keys) {
    bool is_same = true;
    for (std::size_t i = 0; i < next.buses.size(); ++i) {
      is_same = is_same && is_same_device(key, current.buses[i], next.buses[i]);
    }
    if (is_same) continue;
    changed.push_back(path_of(devices, key));
    must_wait = must_wait || key.effect == Effect::restart;
  }
  if (must_wait) {
    fixed.insert(fixed.end(), changed.begin(), changed.end());
    return;
  }
  for (std::size_t i = 0; i < next.buses.size(); ++i) {
    for (const Key& key : table.keys) {
      if (key.effect == Effect::at_once && is_key_of(key, kind_of(next.buses[i]))) {
        copy_value(key.type, &next.buses[i], &current.buses[i]);
      }
    }
    current.buses[i].devices = next.buses[i].devices;
  }
}

void tell(const std::vector<std::string>& lines, const char* kind, port::Level level,
          const std::string& path, port::Log& log) {
  const std::size_t told = std::min(lines.size(), reload_mistakes_max);
  for (std::size_t i = 0; i < told; ++i) log.write(level, lines[i]);
  if (told == lines.size()) return;
  log.write(level, path + ": " + std::to_string(lines.size() - told) + " more " + kind +
                       "; --check-config tells them all");
}

}  // namespace

std::vector<std::string> take_over(Settings& settings, const Settings& next) {
  std::vector<std::string> fixed;
  Settings taken = next;
  for (const KeyTable& table : key_tables()) {
    if (table.kind != KeyTable::Kind::list) take_over_table(table, settings, taken, fixed);
  }
  take_over_buses(settings, taken, fixed);
  if (settings.device_profiles != next.device_profiles) fixed.push_back("[[profile]]");
  const auto is_same_node = [](NodeSettings a, NodeSettings b) {
    const auto keys = key_table("node").keys;
    return std::all_of(keys.begin(), keys.end(),
                       [&](const Key& key) { return is_same_value(key.type, &a, &b); });
  };
  if (!std::equal(settings.nodes.begin(), settings.nodes.end(), next.nodes.begin(),
                  next.nodes.end(), is_same_node)) {
    fixed.push_back(heading_of(key_table("node")));
  } else {
    settings.nodes = next.nodes;  // in another plane they stand elsewhere
  }
  settings.site.source = next.site.source;
  settings.site.projection = next.site.projection;
  settings.site.has_origin_in_degrees = next.site.has_origin_in_degrees;
  settings.features = next.features;
  settings.anchors = next.anchors;
  settings.domain = next.domain;
  return fixed;
}

std::shared_ptr<const Settings> reload(const std::string& path, const Settings& current,
                                       port::ProjectionSource* projections, port::Log& log) {
  std::vector<std::string> mistakes;
  Settings next;
  try {
    next = read_configuration(path, projections, mistakes);
    // The site must fit the mesh there is, not one there might be after a restart.
    if (mistakes.empty()) {
      Settings fitted = next;
      fitted.mesh = current.mesh;
      fitted.analysis = current.analysis;
      check_site(path, fitted, mistakes);
    }
  } catch (const std::exception& error) {
    mistakes.push_back(path + ": " + error.what());
  }
  if (!mistakes.empty()) {
    tell(mistakes, "mistakes", port::Level::error, path, log);
    log.write(port::Level::error,
              "the configuration is not taken over, the old one stays; correct "
              "it and send SIGHUP again");
    return nullptr;
  }
  tell(next.warnings, "warnings", port::Level::warning, path, log);
  auto settings = std::make_shared<Settings>(current);
  for (const std::string& key : take_over(*settings, next)) {
    log.write(port::Level::warning, path + ": needs a restart: " + key);
  }
  log.write(port::Level::info,
            path + " is read again: " + std::to_string(settings->features.size()) +
                " segments of features, " + std::to_string(settings->anchors.size()) + " anchors");
  return settings;
}

}  // namespace etcm::firmware

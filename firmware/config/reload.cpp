#include "firmware/config/reload.h"

#include <algorithm>
#include <cstddef>
#include <exception>
#include <utility>

#include "etcm/port/utf8.h"
#include "firmware/config/bus_reload.h"
#include "firmware/config/configuration.h"
#include "firmware/config/settings_keys.h"
#include "firmware/config/site_projection.h"
#include "firmware/config/unit_count.h"
#include "firmware/logging/counted.h"

namespace etcm::firmware {

namespace {

// Health and page have so much room for it.
constexpr std::size_t refusal_mistake_bytes_max = 300;

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

void tell(const std::vector<std::string>& lines, const char* kind, port::Level level,
          const std::string& path, port::Log& log) {
  const std::size_t told = std::min(lines.size(), reload_mistakes_max);
  for (std::size_t i = 0; i < told; ++i) log.write(level, lines[i]);
  if (told == lines.size()) return;
  log.write(level, path + ": " + std::to_string(lines.size() - told) + " more " + kind +
                       "; --check-config tells them all");
}

std::string refusal_of(const std::vector<std::string>& mistakes) {
  if (mistakes.empty()) return {};
  std::string text = "the configuration was changed and is refused: " +
                     std::string(port::cut_utf8(mistakes.front(), refusal_mistake_bytes_max));
  if (mistakes.size() > 1) text += " (and " + std::to_string(mistakes.size() - 1) + " more)";
  return text + "; the old one holds until that is corrected and reloaded";
}

// The plane changes at once, and what a [[node]] says may wait for the restart: until then its
// device stands where it did, in the new plane.
void place_waiting_nodes(const std::string& path, Settings& settings,
                         std::vector<std::string>& mistakes) {
  std::vector<std::string> beyond;
  place_nodes(settings, beyond);
  if (beyond.empty()) return;
  mistakes.push_back(path +
                     ": a [[node]] that waits for a restart has no place in the new plane of the "
                     "site; restart the gateway, or leave [site] as it is until then");
}

}  // namespace

std::vector<std::string> take_over(Settings& settings, const Settings& next) {
  std::vector<std::string> fixed;
  Settings taken = next;
  for (const KeyTable& table : key_tables()) {
    if (table.kind != KeyTable::Kind::list) take_over_table(table, settings, taken, fixed);
  }
  take_over_buses(settings, taken, fixed);
  settings.site.source = next.site.source;
  settings.site.projection = next.site.projection;
  settings.site.plan = next.site.plan;
  settings.site.has_origin_in_degrees = next.site.has_origin_in_degrees;
  settings.site.projected_crs = next.site.projected_crs;
  settings.site.center = next.site.center;
  settings.node_names = next.node_names;
  if (settings.http && next.http) settings.http->allow_place = next.http->allow_place;
  settings.features = next.features;
  settings.anchors = next.anchors;
  settings.domain = next.domain;
  return fixed;
}

std::shared_ptr<const Settings> reload(const std::string& path, const Settings& current,
                                       port::ProjectionSource* projections, port::Log& log,
                                       std::string& refusal, std::vector<std::string>* waiting) {
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
  auto settings = std::make_shared<Settings>(current);
  std::vector<std::string> fixed;
  if (mistakes.empty()) {
    fixed = take_over(*settings, next);
    place_waiting_nodes(path, *settings, mistakes);
  }
  refusal = refusal_of(mistakes);
  if (!mistakes.empty()) {
    tell(mistakes, "mistakes", port::Level::error, path, log);
    log.write(port::Level::error,
              "the configuration is not taken over, the old one stays; correct "
              "it and send SIGHUP again");
    return nullptr;
  }
  tell(next.warnings, "warnings", port::Level::warning, path, log);
  for (const std::string& key : fixed) {
    log.write(port::Level::warning, path + ": needs a restart: " + key);
  }
  if (waiting != nullptr) *waiting = std::move(fixed);
  const std::uint32_t added = count_units(*settings) - count_units(current);
  log.write(
      port::Level::info,
      path + " is read again: " +
          to_string(Counted{settings->features.size(), "segment", "segments"}) + " of features, " +
          to_string(Counted{settings->anchors.size(), "anchor", "anchors"}) +
          (added == 0 ? ""
                      : ", " + to_string(Counted{added, "unit", "units"}) + " more than before"));
  return settings;
}

}  // namespace etcm::firmware

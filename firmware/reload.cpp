#include "reload.h"

#include <algorithm>
#include <cstddef>
#include <exception>
#include <type_traits>
#include <variant>

#include "configuration.h"

namespace etcm::firmware {

namespace {

bool is_same(const std::optional<LineSettings>& a, const std::optional<LineSettings>& b) {
  if (!a || !b) return a.has_value() == b.has_value();
  return a->place == b->place && a->is_active_low == b->is_active_low;
}

bool is_same(const UnitRange& a, const UnitRange& b) {
  return a.first == b.first && a.last == b.last;
}

bool is_same(const std::vector<UnitRange>& a, const std::vector<UnitRange>& b) {
  return std::equal(a.begin(), a.end(), b.begin(), b.end(),
                    [](const UnitRange& x, const UnitRange& y) { return is_same(x, y); });
}

bool is_same(const port::SocketAddress& a, const port::SocketAddress& b) {
  return a.host == b.host && a.port == b.port;
}

bool is_same(const port::SerialLine& a, const port::SerialLine& b) {
  return a.path == b.path && a.baud == b.baud && a.parity == b.parity &&
         a.stop_bits == b.stop_bits && a.direction == b.direction;
}

// But for the timeouts, which can change.
bool is_same(const BusSettings& a, const BusSettings& b) {
  const bool is_same_link = std::visit(
      [](const auto& left, const auto& right) {
        if constexpr (std::is_same_v<decltype(left), decltype(right)>) return is_same(left, right);
        return false;
      },
      a.link, b.link);
  return is_same_link && a.name == b.name && a.word_order == b.word_order && a.quiet == b.quiet &&
         a.outstanding_max == b.outstanding_max && is_same(a.send_enable, b.send_enable) &&
         is_same(a.units, b.units) && is_same(a.assign, b.assign) && is_same(a.scan, b.scan) &&
         a.scan_budget == b.scan_budget;
}

bool is_same_buses(const Settings& a, const Settings& b) {
  return std::equal(a.buses.begin(), a.buses.end(), b.buses.begin(), b.buses.end(),
                    [](const BusSettings& x, const BusSettings& y) { return is_same(x, y); });
}

// What is decided once, when the gateway starts.
struct FixedKey {
  const char* name;
  bool (*is_same)(const Settings& a, const Settings& b);
};

constexpr FixedKey fixed_keys[] = {
    {"[mesh] vertices_max",
     [](const Settings& a, const Settings& b) {
       return a.mesh.vertices_max == b.mesh.vertices_max;
     }},
    {"[mesh] features_max",
     [](const Settings& a, const Settings& b) {
       return a.mesh.features_max == b.mesh.features_max;
     }},
    {"[mesh] steiner_max",
     [](const Settings& a, const Settings& b) { return a.mesh.steiner_max == b.mesh.steiner_max; }},
    {"[mesh] steps_max",
     [](const Settings& a, const Settings& b) { return a.mesh.steps_max == b.mesh.steps_max; }},
    {"[mesh] policy",
     [](const Settings& a, const Settings& b) { return a.mesh.policy == b.mesh.policy; }},
    {"[[bus]], but for its timeouts", is_same_buses},
    {"[server] listen",
     [](const Settings& a, const Settings& b) {
       return is_same(a.server.listen, b.server.listen);
     }},
    {"[server] clients_max",
     [](const Settings& a, const Settings& b) {
       return a.server.clients_max == b.server.clients_max;
     }},
    {"[http], but for allow",
     [](const Settings& a, const Settings& b) {
       if (!a.http || !b.http) return a.http.has_value() == b.http.has_value();
       return is_same(a.http->listen, b.http->listen) && a.http->clients_max == b.http->clients_max;
     }},
    {"[files] folder and name",
     [](const Settings& a, const Settings& b) {
       if (!a.files || !b.files) return a.files.has_value() == b.files.has_value();
       return a.files->folder == b.files->folder && a.files->name == b.files->name;
     }},
    {"[state]",
     [](const Settings& a, const Settings& b) {
       if (!a.state || !b.state) return a.state.has_value() == b.state.has_value();
       return a.state->folder == b.state->folder && a.state->interval == b.state->interval;
     }},
    {"[write_back]",
     [](const Settings& a, const Settings& b) {
       return a.write_back.is_enabled == b.write_back.is_enabled;
     }},
    {"[gpio]",
     [](const Settings& a, const Settings& b) {
       return is_same(a.gpio.alert, b.gpio.alert) &&
              is_same(a.gpio.join_button, b.gpio.join_button) &&
              is_same(a.gpio.status_led, b.gpio.status_led) &&
              is_same(a.gpio.watchdog, b.gpio.watchdog) && a.gpio.debounce == b.gpio.debounce;
     }},
    {"[analysis]",
     [](const Settings& a, const Settings& b) {
       return a.analysis.radio_range == b.analysis.radio_range &&
              a.analysis.sensing_range == b.analysis.sensing_range;
     }},
};

void tell(const std::vector<std::string>& mistakes, const std::string& path, port::Log& log) {
  const std::size_t told = std::min(mistakes.size(), reload_mistakes_max);
  for (std::size_t i = 0; i < told; ++i) log.write(port::Level::error, mistakes[i]);
  if (told == mistakes.size()) return;
  log.write(port::Level::error, path + ": " + std::to_string(mistakes.size() - told) +
                                    " more mistakes; --check-config tells them all");
}

}  // namespace

std::vector<std::string> take_over(Settings& current, const Settings& next) {
  std::vector<std::string> fixed;
  for (const FixedKey& key : fixed_keys) {
    if (!key.is_same(current, next)) fixed.emplace_back(key.name);
  }
  current.poll = next.poll;
  if (is_same_buses(current, next)) {
    for (std::size_t i = 0; i < next.buses.size(); ++i) {
      current.buses[i].timeout = next.buses[i].timeout;
      current.buses[i].unit_timeouts = next.buses[i].unit_timeouts;
    }
  }
  if (current.files && next.files) current.files->interval = next.files->interval;
  current.server.allow = next.server.allow;
  if (current.http && next.http) current.http->allow = next.http->allow;
  current.site = next.site;
  current.features = next.features;
  current.anchors = next.anchors;
  current.domain = next.domain;
  return fixed;
}

bool reload(const std::string& path, Settings& current, port::Log& log) {
  std::vector<std::string> mistakes;
  Settings next;
  try {
    next = read_configuration(path, mistakes);
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
    tell(mistakes, path, log);
    log.write(port::Level::error,
              "the configuration is not taken over, the old one stays; correct "
              "it and send SIGHUP again");
    return false;
  }
  for (const std::string& key : take_over(current, next)) {
    log.write(port::Level::warning, path + ": needs a restart: " + key);
  }
  log.write(port::Level::info, path + " is read again: " + std::to_string(current.features.size()) +
                                   " stretches of features, " +
                                   std::to_string(current.anchors.size()) + " anchors");
  return true;
}

}  // namespace etcm::firmware

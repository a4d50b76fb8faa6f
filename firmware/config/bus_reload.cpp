#include "firmware/config/bus_reload.h"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <string_view>

#include "firmware/config/settings_keys.h"
#include "firmware/config/unit_count.h"

namespace etcm::firmware {

namespace {

template <class Holds>
bool hold_at_each_unit(const Holds& holds) {
  for (const ModbusAddress unit : UnitRange{.first = 1, .last = unit_max}) {
    if (!holds(unit)) return false;
  }
  return true;
}

class BusReload {
 public:
  BusReload(Settings& current, Settings& next) : current_(current), next_(next) {}

  // What differs, and whether all of it can be taken over.
  void compare() {
    if (next_.buses.size() < current_.buses.size()) {
      wait_for(heading_of(key_table("bus")));
    } else {
      for (const Key& key : key_table("bus").keys) compare_key(key);
      for (const Key& key : key_table("bus.device").keys) compare_device_key(key);
      compare_added();
    }
    compare_profiles();
    if (!keeps_nodes()) wait_for(heading_of(key_table("node")));
  }

  bool must_wait() const { return must_wait_; }
  const std::vector<std::string>& changed() const { return changed_; }

  void take_over() {
    for (std::size_t i = 0; i < current_.buses.size(); ++i) {
      BusSettings& bus = current_.buses[i];
      for (const Key& key : key_table("bus").keys) {
        if (key.effect != Effect::restart && is_key_of(key, kind_of(bus))) {
          copy_value(key.type, &next_.buses[i], &bus);
        }
      }
      bus.devices = next_.buses[i].devices;
    }
    current_.buses.insert(current_.buses.end(),
                          next_.buses.begin() + static_cast<std::ptrdiff_t>(current_.buses.size()),
                          next_.buses.end());
    current_.nodes = next_.nodes;
    current_.device_profiles = next_.device_profiles;
  }

 private:
  void wait_for(std::string what) {
    must_wait_ = true;
    changed_.push_back(std::move(what));
  }

  // `buses` have it otherwise, by their number: the first is named.
  void note(const KeyTable& table, const Key& key, bool is_waiting,
            const std::vector<std::size_t>& buses) {
    std::string what = path_of(table, key);
    if (!buses.empty()) what += " of '" + name_of(buses.front()) + "'";
    if (buses.size() > 1) what += " and " + std::to_string(buses.size() - 1) + " more";
    changed_.push_back(std::move(what));
    must_wait_ = must_wait_ || is_waiting;
  }

  const std::string& name_of(std::size_t bus) const {
    return (bus < current_.buses.size() ? current_ : next_).buses[bus].name;
  }

  // Those of the buses there are for which it does not hold.
  template <class Same>
  std::vector<std::size_t> buses_without(const Same& same) const {
    std::vector<std::size_t> found;
    for (std::size_t i = 0; i < current_.buses.size(); ++i) {
      if (!same(current_.buses[i], next_.buses[i])) found.push_back(i);
    }
    return found;
  }

  void compare_key(const Key& key) {
    const std::vector<std::size_t> changed = buses_without(
        [&](BusSettings& now, BusSettings& then) { return !is_changed(key, now, then); });
    if (changed.empty()) return;
    const bool is_more = buses_without([&](BusSettings& now, BusSettings& then) {
                           return only_adds_units(key, now, then);
                         }).empty();
    note(key_table("bus"), key,
         key.effect == Effect::restart || (key.effect == Effect::additions && !is_more), changed);
  }

  // Whether the file of `then` says anything else for the key than that of `now`.
  static bool is_changed(const Key& key, BusSettings& now, BusSettings& then) {
    if (!is_key_of(key, kind_of(then))) return false;
    // Of a link of another kind the link alone is told, not what only such a link has.
    if (!is_key_of(key, kind_of(now))) return key.standard.kind == Standard::Kind::conditional;
    // Nor is a name that only follows the link.
    const bool has_names = now.name != link_name(now) || then.name != link_name(then);
    return !is_same_value(key.type, &now, &then) &&
           (has_names || std::string_view(key.name) != "name");
  }

  // The key is a list of units: none is gone, and what is new was asked in no other way before.
  static bool only_adds_units(const Key& key, BusSettings& now, BusSettings& then) {
    const auto* const type = std::get_if<UnitsType>(&key.type);
    if (type == nullptr) return true;
    const std::vector<UnitRange> before = type->field.get(&now), after = type->field.get(&then);
    return hold_at_each_unit([&](ModbusAddress unit) {
      if (contain(before, unit)) return contain(after, unit);
      return !contain(after, unit) || !asks(now, unit) || asked(now, unit) == asked(then, unit);
    });
  }

  // Devices at units that were asked before are compared, whichever [[bus.device]] has them.
  void compare_device_key(const Key& key) {
    const auto changed = buses_without([&](const BusSettings& now, const BusSettings& then) {
      return hold_at_each_unit([&](ModbusAddress unit) {
        return !asks(now, unit) || !asks(then, unit) ||
               is_same_device(key.name, device_at(now, unit), device_at(then, unit));
      });
    });
    if (changed.empty()) return;
    note(key_table("bus.device"), key, key.effect != Effect::at_once, changed);
  }

  // One that comes or goes without being anything else but a node was there for its timeout.
  static bool is_same_device(std::string_view key, const DeviceSettings* now,
                             const DeviceSettings* then) {
    static const DeviceSettings none{.units = {}, .profile = node_profile};
    const DeviceSettings& before = now == nullptr ? none : *now;
    const DeviceSettings& after = then == nullptr ? none : *then;
    const bool is_moved = (now == nullptr) != (then == nullptr);
    if (key == "units") {
      return !is_moved || (before.profile == after.profile && before.pause == after.pause &&
                           before.speed_max_nano == after.speed_max_nano);
    }
    if (is_moved) return true;
    if (key == "profile") return before.profile == after.profile;
    if (key == "speed_max") return before.speed_max_nano == after.speed_max_nano;
    return key == "pause" ? before.pause == after.pause : before.timeout == after.timeout;
  }

  void compare_added() {
    const std::size_t known = current_.buses.size();
    for (std::size_t i = known; i < next_.buses.size(); ++i) {
      // The lines of the board are taken at the start.
      if (next_.buses[i].send_enable) {
        note(key_table("bus"), key_of(key_table("bus"), "rs485_line"), true, {i});
      }
    }
    if (next_.buses.size() > current_.room.buses) {
      wait_for("[[bus]] (there is room for " + std::to_string(current_.room.buses) + ")");
    }
    const std::uint32_t units = count_units(next_);
    if (units > current_.room.units && units > count_units(current_)) {
      wait_for("[[bus]] units (they are " + std::to_string(units) + ", and there is room for " +
               std::to_string(current_.room.units) + "; raise vertices_max in [mesh])");
    }
    if (must_wait_ && next_.buses.size() > known) changed_.push_back(heading_of(key_table("bus")));
  }

  // Those that no device has may change.
  void compare_profiles() {
    for (const Profile& profile : current_.device_profiles) {
      const Profile* const then = find_profile(next_, profile.name);
      if (then != nullptr && *then == profile) continue;
      const bool is_used =
          std::any_of(current_.buses.begin(), current_.buses.end(), [&](const BusSettings& bus) {
            return std::any_of(
                bus.devices.begin(), bus.devices.end(),
                [&](const DeviceSettings& device) { return device.profile == profile.name; });
          });
      if (is_used) wait_for("[[profile]] name = \"" + profile.name + "\"");
    }
  }

  // Whether it is written in the file of `next` as it is.
  bool is_kept(NodeSettings now) const {
    const auto keys = key_table("node").keys;
    return std::any_of(next_.nodes.begin(), next_.nodes.end(), [&](NodeSettings then) {
      return std::all_of(keys.begin(), keys.end(),
                         [&](const Key& key) { return is_same_value(key.type, &now, &then); });
    });
  }

  // Surveyed places and serials that there are stay; by a serial of its own a device that is asked
  // already would become another node.
  bool keeps_nodes() const {
    const auto is_welcome = [&](const NodeSettings& then) {
      const auto bus = std::find_if(current_.buses.begin(), current_.buses.end(),
                                    [&](const BusSettings& on) { return on.name == then.bus; });
      const ModbusAddress unit{static_cast<std::uint8_t>(then.address)};
      return !then.serial || bus == current_.buses.end() || !asks(*bus, unit) ||
             node_at(current_, *bus, unit) != nullptr;
    };
    return std::all_of(current_.nodes.begin(), current_.nodes.end(),
                       [&](const NodeSettings& now) { return is_kept(now); }) &&
           std::all_of(next_.nodes.begin(), next_.nodes.end(), is_welcome);
  }

  Settings& current_;
  Settings& next_;
  bool must_wait_ = false;
  std::vector<std::string> changed_;
};

}  // namespace

void take_over_buses(Settings& current, Settings& next, std::vector<std::string>& fixed) {
  BusReload reload(current, next);
  reload.compare();
  if (!reload.must_wait()) return reload.take_over();
  fixed.insert(fixed.end(), reload.changed().begin(), reload.changed().end());
}

}  // namespace etcm::firmware

#include "firmware/nodes/absent_units.h"

#include <algorithm>
#include <utility>

namespace etcm::firmware {

bool is_named(const Settings& settings, const Poller& poller, UnitIndex unit) {
  const BusSettings& line = poller.bus(poller.bus_of(unit));
  const ModbusAddress address = poller.address_of(unit);
  const auto is_its_name = [&](const NodeName& node) {
    return node.serial.is_none() && node.bus == line.name && node.address == address.value;
  };
  return device_at(line, address) != nullptr || node_at(settings, line, address) != nullptr ||
         std::any_of(settings.node_names.begin(), settings.node_names.end(), is_its_name);
}

bool AbsentUnits::look(const Settings& settings, const Poller& poller, const Presence& presence,
                       const NodeTable& nodes, port::Log& log, port::Instant now) {
  since_.resize(poller.unit_count(), now);
  std::swap(absent_, before_);
  absent_.clear();
  for (BusIndex bus{0}; bus.value < poller.bus_count(); ++bus.value) {
    if (presence.is_silent(bus)) continue;
    const BusSettings& line = poller.bus(bus);
    for (const DeviceSettings& device : line.devices) {
      for (const UnitRange& range : device.units) {
        for (std::uint32_t address = range.first; address <= range.last; ++address) {
          look_at_unit(settings, poller, nodes, bus, address, now);
        }
      }
    }
    for (const NodeSettings& node : settings.nodes) {
      if (node.bus == line.name) look_at_unit(settings, poller, nodes, bus, node.address, now);
    }
    for (const NodeName& node : settings.node_names) {
      const bool is_of_this_bus = node.serial.is_none() && node.bus == line.name;
      if (is_of_this_bus) look_at_unit(settings, poller, nodes, bus, node.address, now);
    }
  }
  // Named twice, as a device and as a node, it is one unit.
  std::sort(absent_.begin(), absent_.end(),
            [](const AbsentUnit& a, const AbsentUnit& b) { return a.unit.value < b.unit.value; });
  const auto is_same = [](const AbsentUnit& a, const AbsentUnit& b) { return a.unit == b.unit; };
  absent_.erase(std::unique(absent_.begin(), absent_.end(), is_same), absent_.end());
  tell(poller, log);
  return absent_ != before_;
}

// One that was told, and is behind a bus that fell silent since, is no news.
void AbsentUnits::tell(const Poller& poller, port::Log& log) {
  for (const AbsentUnit& absent : absent_) {
    const auto at = std::lower_bound(told_.begin(), told_.end(), absent.unit);
    if (at != told_.end() && *at == absent.unit) continue;
    told_.insert(at, absent.unit);
    log.write(port::Level::warning,
              TextLine() << poller.name(absent.unit) << absent.what() << "; " << absent_cure);
  }
}

void AbsentUnits::look_at_unit(const Settings& settings, const Poller& poller,
                               const NodeTable& nodes, BusIndex bus, std::uint32_t address,
                               port::Instant now) {
  const ModbusAddress at{static_cast<std::uint8_t>(address)};
  const UnitIndex unit = poller.unit_at(bus, at);
  if (unit.is_none() || poller.counters(unit).has_answered()) return;
  const port::Instant since = since_[unit.value];
  if (now - since <= settings.poll.leave_after) return;
  const Serial serial = device_serial(settings, bus.value, at);
  if (nodes.find(serial) != nullptr) return;
  const NodeSettings* const node = node_at(settings, poller.bus(bus), at);
  absent_.push_back({.unit = unit,
                     .serial = serial,
                     .position = node != nullptr ? node->position : std::nullopt,
                     .since = since == since_.front() ? port::Instant{} : since});
}

}  // namespace etcm::firmware

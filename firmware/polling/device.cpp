#include "firmware/polling/device.h"

#include <algorithm>

#include "firmware/profile/fingerprint.h"
#include "firmware/site/site_plane.h"

namespace etcm::firmware {

Device::Device(Profile profile, Serial serial, const DeviceSettings& settings,
               const std::vector<Quantity>& quantities)
    : profile_(std::move(profile)),
      blocks_(blocks_of(profile_)),
      serial_(serial),
      pause_(settings.pause),
      speed_max_nano_(settings.speed_max_nano.value_or(profile_.speed_max_nano)) {
  for (const RegisterSpan block : blocks_) register_count_ += block.count;
  for (const Profile::Reading& reading : profile_.readings) {
    quantities_.push_back(index_of(reading, quantities));
    definitions_.push_back(fingerprint(profile_, reading));
  }
}

void Device::set_site(const SitePlane& plane, std::optional<Position> surveyed) {
  plane_ = plane;
  surveyed_ = surveyed;
}

std::optional<double> Device::speed_max() const {
  if (speed_max_nano_ == 0 || surveyed_) return std::nullopt;
  return static_cast<double>(speed_max_nano_) / static_cast<double>(plane_.unit_length);
}

std::optional<Position> Device::position_in(const Sweep& sweep, ReadingFault& fault,
                                            DevicePosition::State& told) const {
  const DevicePosition found = position_of(profile_, sweep);
  told = found.state;
  if (found.is_exchanged()) fault = ReadingFault::other_axis;
  if (!found.is_value()) return std::nullopt;
  const auto position =
      profile_.positioning == Profile::Positioning::degrees
          ? nearest_position(plane_, {.longitude = found.east_nano, .latitude = found.north_nano})
          : nearest_position(plane_, found.east_nano, found.north_nano);
  if (!position) fault = ReadingFault::off_the_plane;
  return position;
}

ReadingFault Device::decode(std::span<const std::uint16_t> registers, NodeReading& reading,
                            DevicePosition::State& told) const {
  told = DevicePosition::State::value;
  const Sweep sweep(blocks_, registers);
  NodeReading found;
  found.serial = serial_;
  if (profile_.serial) {
    const std::optional<std::uint32_t> serial = serial_of(profile_, sweep);
    if (!serial) return ReadingFault::no_serial;
    found.serial = Serial{*serial};
  }
  ReadingFault fault = ReadingFault::none;
  const std::optional<Position> position = surveyed_ ? surveyed_ : position_in(sweep, fault, told);
  if (fault != ReadingFault::none) return fault;
  if (position) {
    found.position = *position;
    found.status = node_status::fix_valid;
  }
  reading = found;
  return ReadingFault::none;
}

void Device::measure(std::span<const std::uint16_t> registers,
                     std::vector<Measurement>& out) const {
  const Sweep sweep(blocks_, registers);
  out.clear();
  for (std::size_t i = 0; i < quantities_.size(); ++i) {
    const FieldValue found = reading_of(profile_.readings[i], sweep);
    out.push_back({.quantity = quantities_[i],
                   .nano = found.is_value() ? std::optional(found.nano) : std::nullopt});
  }
}

DeviceTable::DeviceTable(const Settings& settings) { update_settings(settings); }

void DeviceTable::add_devices(const Settings& settings) {
  add_quantities(settings, quantities_);
  for (BusIndex bus{0}; bus.value < settings.buses.size(); ++bus.value) {
    const BusSettings& on = settings.buses[bus.value];
    for (const ModbusAddress address : UnitRange{.first = 1, .last = unit_max}) {
      const DeviceSettings* const device = device_at(on, address);
      const Profile* const profile =
          device == nullptr ? nullptr : find_profile(settings, device->profile);
      if (profile == nullptr) continue;
      devices_.try_emplace({bus.value, address.value}, *profile,
                           device_serial(settings, bus.value, address), *device, quantities_);
    }
  }
}

void DeviceTable::update_settings(const Settings& settings) {
  add_devices(settings);
  for (auto& [where, device] : devices_) {
    const NodeSettings* const node =
        node_at(settings, settings.buses[where.first], ModbusAddress{where.second});
    device.set_site(settings.site.plane(), node != nullptr ? node->position : std::nullopt);
  }
}

const Device* DeviceTable::at(BusIndex bus, ModbusAddress address) const {
  const auto found = devices_.find({bus.value, address.value});
  return found != devices_.end() ? &found->second : nullptr;
}

}  // namespace etcm::firmware

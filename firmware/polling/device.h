// Devices that somebody else made: which registers of them are read, and what these say of a node.
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <span>
#include <string_view>
#include <utility>
#include <vector>

#include "etcm/port/clock.h"
#include "etcm/port/node_bus.h"
#include "firmware/config/settings.h"
#include "firmware/polling/indices.h"
#include "firmware/polling/quantity.h"
#include "firmware/profile/profile.h"
#include "firmware/protocol/modbus_address.h"
#include "firmware/protocol/node_registers.h"
#include "firmware/site/site_plane.h"

namespace etcm::firmware {

// One at a unit. What it reports is read in blocks, one after the other: a sweep. Position, serial
// and readings come from one complete sweep.
class Device {
 public:
  // `quantities` has those that it measures.
  Device(Profile profile, Serial serial, const DeviceSettings& settings,
         const std::vector<Quantity>& quantities);

  // The plane of the site, and where in it the device was surveyed.
  void set_site(const SitePlane& plane, std::optional<Position> surveyed);

  std::span<const RegisterSpan> blocks() const { return blocks_; }
  std::uint32_t register_count() const { return register_count_; }
  std::string_view profile_name() const { return profile_.name; }
  // Where it stands the settings say, and not the device.
  bool is_surveyed() const { return surveyed_.has_value(); }
  port::RegisterKind kind() const {
    return profile_.function == 3 ? port::RegisterKind::holding : port::RegisterKind::input;
  }
  port::Duration pause() const { return pause_; }  // of the bus, after each answer

  // How far it moves in a second at the most, in units of the mesh; none where nobody has said, and
  // of a device that was surveyed.
  std::optional<double> speed_max() const;

  // `registers` are those of blocks(). Sets `reading` only when there is no fault. A device that
  // does not know where it stands has no fix. `told` is why, where no serial is missing.
  ReadingFault decode(std::span<const std::uint16_t> registers, NodeReading& reading,
                      DevicePosition::State& told) const;

  // The quantity of each reading, in the order of the profile.
  std::span<const QuantityIndex> quantities() const { return quantities_; }
  // What each of them is by the profile (profile/fingerprint.h).
  std::span<const std::uint64_t> definitions() const { return definitions_; }
  // What its readings are in these registers. Takes no memory where `out` has room for all.
  void measure(std::span<const std::uint16_t> registers, std::vector<Measurement>& out) const;

 private:
  // None where the device tells no place, as `told` says, or one that cannot be: then there is a
  // fault.
  std::optional<Position> position_in(const Sweep& sweep, ReadingFault& fault,
                                      DevicePosition::State& told) const;

  Profile profile_;
  std::vector<RegisterSpan> blocks_;
  std::vector<QuantityIndex> quantities_;
  std::vector<std::uint64_t> definitions_;
  std::uint32_t register_count_ = 0;
  Serial serial_;  // of a device that tells none
  SitePlane plane_;
  std::optional<Position> surveyed_;
  port::Duration pause_;
  std::int64_t speed_max_nano_;  // 0: nobody has said
};

// Those of a configuration.
class DeviceTable {
 public:
  explicit DeviceTable(const Settings& settings);

  // The site may have another plane, and there may be more devices; those that there are stay.
  void update_settings(const Settings& settings);

  // Null: a node of our own. Good as long as the table.
  const Device* at(BusIndex bus, ModbusAddress address) const;
  // What they measure. More devices may add to it, behind those there are.
  const std::vector<Quantity>& quantities() const { return quantities_; }

 private:
  void add_devices(const Settings& settings);

  std::vector<Quantity> quantities_;
  std::map<std::pair<std::uint32_t, std::uint8_t>, Device> devices_;
};

}  // namespace etcm::firmware

#include "site_world.h"

#include <algorithm>
#include <utility>

namespace etcm::simulation {

using namespace std::chrono_literals;

namespace {

constexpr std::int32_t side = 3000;
constexpr Duration replaced_within = 10s;

}  // namespace

SiteWorld::SiteWorld(inputs::Random& chance, bool with_other_makes, Instant now)
    : random(chance),
      for_later(chance),
      has_other_makes(with_other_makes),
      disk(chance),
      disk_of_alarms(for_later) {
  const std::size_t bus_count = 1 + random.index(3);
  std::uint32_t unit_count = 0;
  buses.resize(bus_count);
  for (std::size_t number = 0; number < bus_count; ++number) {
    const auto nodes = static_cast<std::uint8_t>(2 + random.below(6));
    // One that is expected and never was.
    const auto units = static_cast<std::uint8_t>(nodes + random.below(2));
    const Make make = number % 2 == 0 ? Make::in_blocks : Make::checked;
    open_bus(number, units, has_other_makes ? make : Make::ours);
    for (std::uint8_t unit = 1; unit <= nodes; ++unit) add(number, unit, now);
    unit_count += units;
  }
  is_small = random.below(5) == 0;
  whole.vertices_max = is_small ? unit_count + 1 : 10 * unit_count + 40;
  whole.work_max = random.below(5) == 0 ? 20'000 : 0;
  draw_times(whole);
  draw_features(whole);
  file = whole;
  pass_to(now);
}

void SiteWorld::open_bus(std::size_t number, std::uint8_t units, Make first_make) {
  BusText text{.units = units, .first_make = first_make};
  // Drawn aside, so that lives are what they were before there were such lines.
  inputs::Random aside = random;
  text.kind = random.below(3) != 0 ? LinkKind::serial : LinkKind::converter;
  if (text.kind == LinkKind::serial && aside.below(9) == 4) text.kind = LinkKind::serial_over_tcp;
  BusWorld& bus = buses[number];
  if (text.kind != LinkKind::converter) {
    text.baud = random.below(2) == 0 ? 9600 : 19200;
    port::SerialLine line;
    line.baud = text.baud;
    const Duration network_max = text.kind == LinkKind::serial ? Duration{} : Duration(20ms);
    bus.line = std::make_unique<RtuWorld>(line, network_max, unit_timeout, bus.devices, random);
  } else {
    text.outstanding = static_cast<std::uint32_t>(1 + random.below(4));
    const ConverterHabits habits{.hold = random.below(2) == 0 ? Duration(300ms) : Duration(1s),
                                 .says_nobody = random.below(2) == 0,
                                 .keeps_queue = random.below(2) == 0};
    bus.converter = std::make_unique<ConverterWorld>(habits, unit_timeout, bus.devices, random);
  }
  whole.buses.push_back(text);
}

void SiteWorld::draw_times(SiteFile& of) {
  std::int64_t unit_count = 0;
  for (const BusText& bus : whole.buses) unit_count += bus.unit_count();
  of.interval = 2s + random.below(18) * 1s;
  const Duration round = 3 * of.interval + unit_count * 2s + 20s;
  of.absent_interval = 30s;
  of.stale_after = round;
  of.leave_after = 2 * round + 60s;
}

// No device of another make is where ours may be, in any plane but the one that counts in units of
// the mesh, so that no two meet at one place that stand at two.
void SiteWorld::draw_plane(SiteFile& of) {
  of.plane = {};
  const std::size_t which = random.index(4);
  if (which == 0) return;
  of.plane.units = std::int32_t{1} << (which - 1);
  of.plane.origin = 4 * side * random.between(1, 3);
}

Position SiteWorld::in_mesh(const Device& device, Position said) const {
  if (device.make == Make::ours) return said;
  const auto& [units, origin] = running.plane;
  return {(said.x - origin) * units, (said.y + origin) * units};
}

std::optional<Position> SiteWorld::said_for(const Device& device, Position in_mesh) const {
  if (device.make == Make::ours) return in_mesh;
  const auto& [units, origin] = running.plane;
  if (in_mesh.x % units != 0 || in_mesh.y % units != 0) return std::nullopt;
  return Position{in_mesh.x / units + origin, in_mesh.y / units - origin};
}

void SiteWorld::draw_features(SiteFile& of) {
  of.features.clear();
  const std::size_t count = random.index(4);
  for (std::size_t i = 0; i < count; ++i) {
    std::uint32_t from = devices[random.index(devices.size())]->serial;
    std::uint32_t to = devices[random.index(devices.size())]->serial;
    if (from > to) std::swap(from, to);
    const bool is_there =
        std::find(of.features.begin(), of.features.end(), std::pair(from, to)) != of.features.end();
    if (from != to && !is_there) of.features.emplace_back(from, to);
  }
}

Duration SiteWorld::found_again_within(std::size_t bus) const {
  const std::int64_t units{whole.buses[bus].unit_count()};
  const Duration forgotten_within = buses[bus].line ? Duration{} : Duration(10min);
  const Duration within =
      running.stale_after + running.absent_interval + 15s + units * 130s + forgotten_within;
  return whole.buses[bus].is_shared ? within + within / 2 : within;
}

Position SiteWorld::free_place() {
  for (;;) {
    const Position place{random.between(-side, side), random.between(-side, side)};
    if (std::find(places_.begin(), places_.end(), place) != places_.end()) continue;
    places_.push_back(place);
    if (places_.size() > 10'000) places_.erase(places_.begin());
    return place;
  }
}

Device& SiteWorld::add(std::size_t bus, std::uint8_t unit, Instant now) {
  const Make make = unit == 1 ? whole.buses[bus].first_make : Make::ours;
  devices.push_back(std::make_unique<Device>(next_serial_++, bus, unit, make, free_place(), now));
  buses[bus].devices.push_back(devices.back().get());
  return *devices.back();
}

Device& SiteWorld::replace(Device& device, Instant now) {
  device.is_replaced = true;
  Device& other = add(device.bus, device.unit, now);
  // No hands are so fast that one tells the first block and the other the second.
  if (other.make != Make::ours) {
    other.silent_until = now + replaced_within;
    other.disturb(other.silent_until);
  }
  return other;
}

Device& SiteWorld::add_twin(Device& device, Instant now) {
  Device& twin = add(device.bus, device.unit, now);
  twins.push_back(&twin);
  return twin;
}

bool SiteWorld::is_doubled(const Device& device) const {
  const std::vector<Device*>& there = buses[device.bus].devices;
  return std::ranges::count_if(there, [&](const Device* other) {
           return !other->is_replaced && other->unit == device.unit;
         }) > 1;
}

void SiteWorld::remove_twins(Instant now) {
  for (Device* const twin : twins) {
    twin->is_replaced = true;
    for (const auto& device : devices) {
      if (device->unit == twin->unit && device->bus == twin->bus) {
        // The gateway takes the one for gone before it believes the other.
        device->had_twin = true;
        device->disturb(now + running.leave_after);
      }
    }
  }
  twins.clear();
}

Device* SiteWorld::find(std::uint32_t serial) const {
  const std::uint32_t index = serial - first_serial;  // they come in order
  return index < devices.size() ? devices[index].get() : nullptr;
}

void SiteWorld::pass_to(Instant now) {
  for (BusWorld& bus : buses) bus.pass_to(now);
  disk.pass_to(now);
  disk_of_alarms.pass_to(now);
}

Instant SiteWorld::next() const {
  Instant next = disk.next();
  for (const BusWorld& bus : buses) next = std::min(next, bus.next());
  return next;
}

}  // namespace etcm::simulation

#include "site_world.h"

#include <algorithm>
#include <string>

namespace etcm::simulation {

using namespace std::chrono_literals;

namespace {

constexpr std::int32_t side = 3000;
constexpr Duration timeout = 200ms;

firmware::BusSettings bus_settings(std::size_t number, bool is_serial, std::uint8_t units,
                                   inputs::Random& random) {
  firmware::BusSettings bus;
  bus.name = std::string("bus-") + static_cast<char>('a' + number);
  bus.units = {{.first = 1, .last = units}};
  bus.timeout = timeout;
  bus.quiet = 50ms;
  bus.scan_budget = 10ms;
  if (is_serial) {
    port::SerialLine line;
    line.path = "/dev/simulated" + std::to_string(number);
    line.baud = random.below(2) == 0 ? 9600 : 19200;
    bus.link = line;
    bus.outstanding_max = 1;
  } else {
    bus.link = port::Endpoint{};
    bus.outstanding_max = static_cast<std::uint32_t>(1 + random.below(4));
  }
  return bus;
}

}  // namespace

SiteWorld::SiteWorld(inputs::Random& chance, Instant now) : random(chance), disk(chance) {
  const std::size_t bus_count = 1 + random.index(3);
  std::uint32_t unit_count = 0;
  buses.resize(bus_count);
  for (std::size_t number = 0; number < bus_count; ++number) {
    const auto nodes = static_cast<std::uint8_t>(2 + random.below(6));
    // One that is expected and never was.
    const auto units = static_cast<std::uint8_t>(nodes + random.below(2));
    const bool is_serial = random.below(3) != 0;
    settings.buses.push_back(bus_settings(number, is_serial, units, random));
    BusWorld& bus = buses[number];
    if (is_serial) {
      bus.line = std::make_unique<RtuWorld>(std::get<port::SerialLine>(settings.buses[number].link),
                                            timeout, bus.devices, random);
    } else {
      const ConverterHabits habits{.hold = random.below(2) == 0 ? Duration(300ms) : Duration(1s),
                                   .says_nobody = random.below(2) == 0,
                                   .keeps_queue = random.below(2) == 0};
      bus.converter = std::make_unique<ConverterWorld>(habits, timeout, bus.devices, random);
    }
    for (std::uint8_t unit = 1; unit <= nodes; ++unit) add(number, unit, now);
    unit_count += units;
  }
  const Duration interval = 2s + random.below(18) * 1s;
  const Duration round = 3 * interval + unit_count * 2s + 20s;
  settings.poll = {.interval = interval,
                   .timeout = timeout,
                   .outstanding_max = 4,
                   .absent_interval = 30s,
                   .stale_after = round,
                   .leave_after = 2 * round + 60s};
  // Some sites have no room for all.
  const bool is_small = random.below(5) == 0;
  settings.mesh = {.vertices_max = is_small ? unit_count + 1 : 10 * unit_count + 40,
                   .features_max = 40};
  settings.state = firmware::StateSettings{.folder = "/state", .interval = 10s};
  settings.files = firmware::FileSettings{.folder = "/files", .name = "mesh", .interval = 5s};
  settings.work_max = random.below(5) == 0 ? 20'000 : 0;
  const std::size_t feature_count = random.index(4);
  for (std::size_t i = 0; i < feature_count; ++i) {
    const std::uint32_t from = devices[random.index(devices.size())]->serial;
    const std::uint32_t to = devices[random.index(devices.size())]->serial;
    if (from == to) continue;
    settings.features.push_back({.from = firmware::Serial{from},
                                 .to = firmware::Serial{to},
                                 .name = {},
                                 .source = "site.toml:" + std::to_string(i + 1)});
  }
}

Duration SiteWorld::found_again_within(std::size_t bus) const {
  const auto units = static_cast<std::int64_t>(settings.buses[bus].units[0].last);
  return settings.poll.stale_after + settings.poll.absent_interval + 15s + units * 130s;
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
  devices.push_back(std::make_unique<Device>(next_serial_++, unit, free_place(), now));
  buses[bus].devices.push_back(devices.back().get());
  return *devices.back();
}

std::size_t SiteWorld::bus_of(const Device& device) const {
  for (std::size_t number = 0; number < buses.size(); ++number) {
    const auto& on_it = buses[number].devices;
    if (std::find(on_it.begin(), on_it.end(), &device) != on_it.end()) return number;
  }
  return buses.size();
}

Device& SiteWorld::replace(Device& device, Instant now) {
  device.is_replaced = true;
  const std::size_t bus = bus_of(device);
  return add(bus, device.unit, now);
}

Device& SiteWorld::add_twin(Device& device, Instant now) {
  Device& twin = add(bus_of(device), device.unit, now);
  twins.push_back(&twin);
  return twin;
}

bool SiteWorld::is_doubled(const Device& device) const {
  return std::any_of(twins.begin(), twins.end(), [&](const Device* twin) {
    return twin->unit == device.unit && bus_of(*twin) == bus_of(device);
  });
}

void SiteWorld::remove_twins(Instant now) {
  for (Device* const twin : twins) {
    twin->is_replaced = true;
    for (const auto& device : devices) {
      if (device->unit == twin->unit && bus_of(*device) == bus_of(*twin)) {
        // The gateway takes the one for gone before it believes the other.
        device->disturb(now + settings.poll.leave_after);
      }
    }
  }
  twins.clear();
}

Device* SiteWorld::find(std::uint32_t serial) const {
  for (const auto& device : devices) {
    if (device->serial == serial) return device.get();
  }
  return nullptr;
}

void SiteWorld::pass_to(Instant now) {
  for (BusWorld& bus : buses) bus.pass_to(now);
  disk.pass_to(now);
}

Instant SiteWorld::next() const {
  Instant next = disk.next();
  for (const BusWorld& bus : buses) next = std::min(next, bus.next());
  return next;
}

}  // namespace etcm::simulation

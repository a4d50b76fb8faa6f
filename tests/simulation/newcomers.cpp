#include "newcomers.h"

#include <algorithm>
#include <array>
#include <utility>

namespace etcm::simulation {

using namespace std::chrono_literals;

namespace {

constexpr std::uint64_t of_their_own = 0xd1b54a32d192ed03;
constexpr std::size_t devices_max = 60;
constexpr Duration heard_for = 15s;

}  // namespace

Newcomers::Newcomers(SiteWorld& site, std::uint64_t seed, Instant now)
    : site_(site), random_(seed ^ of_their_own) {
  pause_ = std::array{20s, 120s, 600s}[random_.index(3)];
  happens_at_ = now + 10s;
  // A site that is too small for its units says so, and is not started.
  if (site.is_small) return;
  for (std::size_t bus = 0; bus < site.whole.buses.size(); ++bus) {
    if (bus > 0 && random_.below(2) == 0) continue;
    site.whole.buses[bus].assigned = static_cast<std::uint8_t>(2 + random_.below(4));
  }
  site.draw_times(site.whole);
  site.file = site.whole;
}

std::string Newcomers::step(Instant now) {
  std::string wrong;
  while (!is_at_rest_ && happens_at_ <= now) {
    happen(now);
    happens_at_ = now + 1s + random_.below(2 * static_cast<std::uint64_t>(pause_ / 1s)) * 1s;
  }
  if (parted_at_ <= now) {
    part();
    parted_at_ = port::never;
  }
  for (std::size_t i = units_.size(); i < site_.devices.size(); ++i) {
    units_.push_back(site_.devices[i]->unit);
  }
  for (std::size_t i = 0; i < units_.size(); ++i) {
    const Device& device = *site_.devices[i];
    const std::uint8_t before = std::exchange(units_[i], device.unit);
    if (before == device.unit) continue;
    const Device* const other =
        device.unit == newcomers_unit ? nullptr : answers_beside(device, now);
    if (other != nullptr) {
      wrong = "node " + std::to_string(device.serial) + " is given unit " +
              std::to_string(device.unit) + ", where node " + std::to_string(other->serial) +
              " answers";
    }
    given_ += before == newcomers_unit;
    disturb(device.bus, before, now);
    disturb(device.bus, device.unit, now);
  }
  return wrong;
}

const Device* Newcomers::answers_beside(const Device& device, Instant now) const {
  const BusWorld& bus = site_.buses[device.bus];
  if (bus.is_out_of_order() || bus.undisturbed_since + heard_for > now) return nullptr;
  const Device* there = nullptr;
  for (const Device* const other : bus.devices) {
    if (other == &device || other->unit != device.unit || other->is_replaced) continue;
    // Two that talk over one another are silence to who looks.
    if (there != nullptr) return nullptr;
    there = other;
  }
  const bool answers = there != nullptr && there->is_plugged_in &&
                       there->ailment == Ailment::none &&
                       there->undisturbed_since + heard_for <= now;
  return answers ? there : nullptr;
}

void Newcomers::happen(Instant now) {
  const std::uint64_t what = random_.below(8);
  const std::vector<Device*> there = all();
  if (there.empty() || what < 4) {
    const std::size_t bus = random_.index(site_.buses.size());
    const std::size_t count = 1 + random_.index(2);
    for (std::size_t i = 0; i < count; ++i) come(bus, now);
    return;
  }
  Device& device = *there[random_.index(there.size())];
  if (what < 6) {
    device.unit = newcomers_unit;
  } else if (what == 6) {
    device.keeps_unit = !device.keeps_unit;
  } else {
    take_away(device, now);
  }
}

void Newcomers::take_away(Device& device, Instant now) {
  // Who is gone, and talked with another one until then, was heard last when it is hard to say.
  if (site_.is_doubled(device)) disturb(device.bus, device.unit, now);
  device.is_replaced = true;
  disturb(device.bus, device.unit, now);
}

void Newcomers::come(std::size_t bus, Instant now) {
  // One more than there are units: it stays where it is.
  if (count_on(bus) > site_.whole.buses[bus].assigned || site_.whole.buses[bus].assigned == 0)
    return;
  if (site_.devices.size() >= devices_max) return;
  site_.add(bus, newcomers_unit, now);
  disturb(bus, newcomers_unit, now);
}

std::vector<Device*> Newcomers::all() const {
  std::vector<Device*> there;
  for (const auto& device : site_.devices) {
    if (!device->is_replaced && device->unit >= first_assigned) there.push_back(device.get());
  }
  return there;
}

std::size_t Newcomers::count_on(std::size_t bus) const {
  const std::vector<Device*>& there = site_.buses[bus].devices;
  return static_cast<std::size_t>(std::ranges::count_if(there, [](const Device* device) {
    return !device->is_replaced && device->unit >= first_assigned;
  }));
}

void Newcomers::disturb(std::size_t bus, std::uint8_t unit, Instant now) {
  for (Device* const device : site_.buses[bus].devices) {
    if (device->unit != unit || device->is_replaced) continue;
    // The gateway takes the one for gone before it believes the other.
    device->had_twin = true;
    device->disturb(now + site_.running.leave_after);
  }
  site_.buses[bus].undisturbed_since = std::max(site_.buses[bus].undisturbed_since, now);
}

void Newcomers::end_faults(Instant now) {
  is_at_rest_ = true;
  parted_at_ = now + 1min;
  for (Device* const device : all()) device->keeps_unit = false;
  part();
  // Twins that became nodes of their own wait too. Two for whom there is never a unit would talk
  // over one another for ever.
  for (Device* const device : all()) {
    const bool is_one_too_many =
        count_on(device->bus) > site_.whole.buses[device->bus].assigned + 1U;
    if (is_one_too_many && device->unit == newcomers_unit) take_away(*device, now);
  }
  // Only hands have put anybody anywhere since the last step.
  static_cast<void>(step(now));
}

void Newcomers::part() {
  for (Device* const device : all()) {
    if (site_.is_doubled(*device)) device->unit = newcomers_unit;
  }
}

// Behind a converter several at one unit are mostly nobody, and such are asked now and then.
Duration Newcomers::heard_within() const {
  Duration within = 40min;  // who is parted from another later
  for (const Device* const device : all()) {
    const bool is_waiting = device->unit == newcomers_unit;
    if (is_waiting) within += site_.buses[device->bus].line ? 5min : 40min;
  }
  return within;
}

bool Newcomers::has_waiting() const {
  return std::ranges::any_of(all(),
                             [](const Device* device) { return device->unit == newcomers_unit; });
}

std::string Newcomers::look_at_rest() const {
  for (std::size_t bus = 0; bus < site_.buses.size(); ++bus) {
    std::size_t waiting = 0;
    for (const Device* const device : site_.buses[bus].devices) {
      if (device->is_replaced || device->unit < first_assigned) continue;
      if (site_.is_doubled(*device)) {
        return "at rest, two nodes answer at unit " + std::to_string(device->unit);
      }
      waiting += device->unit == newcomers_unit;
    }
    const std::size_t assigned = site_.whole.buses[bus].assigned;
    if (waiting > 0 && count_on(bus) <= assigned) {
      return "at rest, a node has no unit, and of " + std::to_string(assigned) + " one is free";
    }
  }
  return {};
}

}  // namespace etcm::simulation

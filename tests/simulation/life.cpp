#include "life.h"

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <optional>
#include <utility>

#include "gateway_run.h"
#include "judge.h"
#include "newcomers.h"
#include "others.h"
#include "site_world.h"
#include "told_neighbours.h"

namespace etcm::simulation {

using namespace std::chrono_literals;

namespace {

constexpr std::int64_t nano = 1'000'000'000;  // of what the plane counts in

class Life {
 public:
  Life(std::uint64_t seed, Company company)
      : random_(seed),
        clock_(),
        wall_clock_(clock_),
        site_(random_, company == Company::others_and_makes, clock_.now()),
        judge_(site_),
        told_(site_) {
    for (std::uint32_t& weight : weights_) weight = static_cast<std::uint32_t>(random_.below(4));
    // What mends is never rarer than what breaks.
    for (const Event event : {Event::get_well, Event::plug_in, Event::mend_bus, Event::mend_disk}) {
      weights_[static_cast<std::size_t>(event)] += 3;
    }
    pause_ = std::array{3s, 20s, 120s, 600s}[random_.index(4)];
    const bool has_newcomers = company == Company::others_and_newcomers;
    if (has_newcomers) newcomers_ = std::make_unique<Newcomers>(site_, seed, clock_.now());
    if (company != Company::nobody) {
      others_ = std::make_unique<Others>(site_, seed, has_newcomers, clock_.now());
      judge_.set_others(others_.get());
    }
    start();
  }

  Outcome run(Duration faults) {
    const Instant begin = clock_.now();
    happens_at_ = begin + 30s;
    run_until(begin + faults, true);
    if (outcome_.wrong.empty()) end_faults();
    Duration rest{};
    for (std::size_t bus = 0; bus < site_.buses.size(); ++bus) {
      const Duration pause = site_.buses[bus].undisturbed_since - clock_.now();
      rest = std::max(rest, site_.found_again_within(bus) + std::max(pause, Duration{}));
    }
    rest += site_.running.leave_after + 1min;
    if (newcomers_) rest += newcomers_->heard_within();
    if (outcome_.wrong.empty()) run_until(clock_.now() + rest, false);
    if (outcome_.wrong.empty()) run_->gateway().dismiss_all(clock_.now());
    // Then units of missing nodes are free, for those that wait for one.
    const bool has_waiting = newcomers_ && newcomers_->has_waiting();
    const Duration given_within = 1min + (has_waiting ? newcomers_->heard_within() : Duration{});
    if (outcome_.wrong.empty()) run_until(clock_.now() + given_within, false);
    look_at_rest();
    if (outcome_.wrong.empty()) ebb();
    tell_devices();
    outcome_.lived = clock_.now() - begin;
    outcome_.positions = judge_.positions;
    outcome_.positions_of_others = judge_.positions_of_others;
    outcome_.generations = judge_.generations;
    outcome_.rebuilt = judge_.rebuilt;
    if (newcomers_) outcome_.given = newcomers_->given();
    if (others_) outcome_.births = others_->births();
    outcome_.lists = told_.lists();
    if (others_) outcome_.requests = others_->requests();
    return outcome_;
  }

 private:
  // All leave that say so, one comes back, then all.
  void ebb() {
    std::size_t there = site_.devices.size();
    const auto silent = static_cast<std::size_t>(
        std::ranges::count_if(site_.devices, [](const std::unique_ptr<Device>& device) {
          return device->make != Make::ours && !device->is_replaced;
        }));
    for (const std::size_t staying : {std::size_t{0}, std::size_t{1}, there}) {
      there = 0;
      for (const auto& device : site_.devices) {
        if (device->is_replaced || device->make != Make::ours) continue;
        device->is_leaving = there++ >= staying;
      }
      run_until(clock_.now() + 1min, false);
      std::string shown;
      std::size_t count = 0;
      for (const firmware::SnapshotVertex& vertex : run_->gateway().snapshot().vertices) {
        const bool is_own = vertex.kind == VertexKind::node && vertex.owner.is_none();
        if (!is_own || vertex.is_anchor) continue;
        shown += " " + std::to_string(vertex.serial.value);
        ++count;
      }
      if (outcome_.wrong.empty() && staying < there && count != staying + silent) {
        note("all but " + std::to_string(staying) +
             " have left, and these are in the mesh:" + shown);
      }
    }
    look_at_rest();
  }

  void tell_devices() const {
    if (outcome_.wrong.empty() || std::getenv("ETCM_SIMULATION_VERBOSE") == nullptr) return;
    for (const auto& device : site_.devices) {
      if (device->is_replaced) continue;
      std::printf("node %u at unit %u of bus %zu, ailment %d%s%s%s\n", device->serial, device->unit,
                  device->bus, static_cast<int>(device->ailment),
                  device->is_plugged_in ? "" : ", unplugged", device->is_leaving ? ", leaving" : "",
                  site_.is_doubled(*device) ? ", not alone there" : "");
    }
  }

  void look_at_rest() {
    if (outcome_.wrong.empty()) note(judge_.look_at_rest(*run_));
    if (outcome_.wrong.empty() && newcomers_) note(newcomers_->look_at_rest());
    if (outcome_.wrong.empty() && site_.whole.has_write_back) note(told_.look_at_rest(*run_));
    if (outcome_.wrong.empty() && others_) note(others_->look_at_rest(*run_));
  }

  void start() {
    for (const auto& device : site_.devices) device->answers = 0;
    site_.write_file();
    site_.running = site_.file;
    run_ =
        std::make_unique<GatewayRun>(site_, clock_, wall_clock_, ++runs_,
                                     others_ ? others_->company(clock_.now()) : GatewayCompany{});
    judge_.begin(*run_, clock_.now());
    note(judge_.look_at_kept_alarms(*run_));
  }

  void note(const std::string& wrong) {
    if (wrong.empty() || !outcome_.wrong.empty()) return;
    outcome_.wrong =
        "after " +
        std::to_string(
            std::chrono::duration<double>(clock_.now().time_since_epoch() - 1h).count()) +
        " s: " + wrong;
  }

  void run_until(Instant end, bool is_eventful) {
    while (clock_.now() < end && outcome_.wrong.empty()) {
      if (is_eventful && happens_at_ <= clock_.now()) {
        happen();
        happens_at_ = clock_.now() + 100ms +
                      random_.below(2 * static_cast<std::uint64_t>(pause_ / 1ms)) * 1ms;
      }
      const Instant now = clock_.now();
      run_->step(now);
      if (newcomers_) note(newcomers_->step(now));
      if (others_) note(others_->step(*run_, now));
      ++outcome_.steps;
      look_for_spinning(now);
      note(judge_.look(*run_, now));
      if (site_.whole.has_write_back) note(told_.look(*run_, now));
      Instant next = std::min({run_->next_deadline(), site_.next(), end});
      if (is_eventful) next = std::min(next, happens_at_);
      if (others_) next = std::min(next, others_->next());
      if (newcomers_) next = std::min(next, newcomers_->next());
      pass_to(std::max(next, now + 1us));
    }
  }

  // A gateway whose next step is always due takes a whole processor.
  void look_for_spinning(Instant now) {
    if (now - second_ >= 1s) {
      second_ = now;
      steps_in_second_ = 0;
    }
    if (++steps_in_second_ > 5000) {
      note("it spins: thousands of steps in a second");
    }
  }

  void pass_to(Instant now) {
    clock_.pass_to(now);
    site_.pass_to(now);
    if (others_) others_->pass_to(now);
  }

  Device* any_device() {
    std::vector<Device*> there;
    for (const auto& device : site_.devices) {
      if (!device->is_replaced) there.push_back(device.get());
    }
    return there[random_.index(there.size())];
  }
  void happen() {
    std::uint64_t all = 0;
    for (const std::uint32_t weight : weights_) all += weight;
    std::uint64_t drawn = random_.below(all);
    std::size_t event = 0;
    while (drawn >= weights_[event]) drawn -= weights_[event++];
    ++outcome_.events[event];
    happen(static_cast<Event>(event));
  }

  void tell(Event event, const Device* device, std::size_t bus) const {
    if (std::getenv("ETCM_SIMULATION_VERBOSE") == nullptr) return;
    std::printf("[%10.3f] event %d",
                std::chrono::duration<double>(clock_.now().time_since_epoch() - 1h).count(),
                static_cast<int>(event));
    if (device != nullptr) std::printf(" node %u unit %u", device->serial, device->unit);
    std::printf(" bus %zu\n", bus);
  }

  void happen(Event event) {
    const Instant now = clock_.now();
    Device& device = *any_device();
    const std::size_t number = device.bus;
    BusWorld& bus = site_.buses[number];
    tell(event, &device, number);
    switch (event) {
      case Event::move:
        device.move(site_.free_place(), now);
        break;
      case Event::move_all:
        for (const auto& each : site_.devices) each->move(site_.free_place(), now);
        break;
      case Event::jump: {
        // There and back, and there again, between two questions.
        const Position home = device.place();
        device.move(site_.free_place(), now);
        device.move(home, now + 1ms);
        break;
      }
      case Event::fall_ill:
        device.fall_ill(static_cast<Ailment>(1 + random_.index(ailment_count - 1)), now, random_);
        // A slow one holds up the others of its line.
        disturb(bus);
        break;
      case Event::get_well:
        device.fall_ill(Ailment::none, now, random_);
        disturb(bus);
        break;
      case Event::unplug:
        device.is_plugged_in = false;
        device.disturb(now);
        disturb(bus);
        break;
      case Event::plug_in:
        for (const auto& each : site_.devices) {
          if (each->is_plugged_in || random_.below(2) == 0) continue;
          each->is_plugged_in = true;
          each->disturb(now);
        }
        break;
      case Event::replace:
        if (site_.devices.size() < 60 && !site_.is_doubled(device)) {
          site_.replace(device, now).disturb(now);
          disturb(bus);
        }
        break;
      case Event::twin:
        if (site_.devices.size() < 60 && site_.twins.empty()) {
          site_.add_twin(device, now);
          disturb_unit(device);
          disturb(bus);
        } else {
          site_.remove_twins(now);
        }
        break;
      case Event::leave:
        // The other make says nothing of it.
        if (device.make != Make::ours) break;
        device.is_leaving = !device.is_leaving;
        device.disturb(now);
        break;
      case Event::dismiss:
        for (const auto& each : site_.devices) each->answers = 0;
        if (random_.below(2) == 0) {
          run_->gateway().dismiss(firmware::Serial{device.serial});
        } else {
          run_->gateway().dismiss_all(now);
        }
        break;
      case Event::meet:
        device.move(any_device()->place(), now);
        break;
      default:
        happen_around(event, bus);
    }
  }

  void disturb(BusWorld& bus) {
    bus.undisturbed_since = std::max(bus.undisturbed_since, clock_.now());
  }
  void disturb_unit(const Device& device) {
    for (Device* const each : site_.buses[device.bus].devices) {
      if (each->unit == device.unit) each->disturb(clock_.now());
    }
  }

  void happen_around(Event event, BusWorld& bus) {
    const Instant now = clock_.now();
    switch (event) {
      case Event::cut_bus:
        disturb(bus);
        if (bus.line) bus.line->is_cut = true;
        if (bus.converter) bus.converter->cut(true);
        break;
      case Event::noise:
        disturb(bus);
        if (bus.line) bus.line->has_noise = true;
        break;
      case Event::hang_converter:
        disturb(bus);
        if (bus.converter) bus.converter->hangs = true;
        break;
      case Event::mend_bus:
        for (BusWorld& each : site_.buses) mend(each);
        break;
      case Event::disk_full:
        set_disk_full(true);
        break;
      case Event::disk_hangs:
        set_disk_hanging(true);
        break;
      case Event::mend_disk:
        mend_disk();
        break;
      case Event::power_loss:
        restart(false);
        if (random_.below(20) == 0) site_.disk.lose_all();
        break;
      case Event::restart:
        restart(true);
        break;
      case Event::stand_still:
        // Bytes come meanwhile, and nobody reads them.
        pass_to(now + random_.below(120'000) * 1ms);
        judge_.begin(*run_, clock_.now());
        if (others_) others_->look_anew(clock_.now());
        for (const auto& each : site_.devices) each->disturb(clock_.now());
        for (BusWorld& each : site_.buses) {
          disturb(each);
          if (each.converter) each.undisturbed_since = clock_.now() + standstill_cost_max;
        }
        break;
      case Event::set_clock:
        wall_clock_.offset_ms +=
            static_cast<std::int64_t>(random_.below(200'000'000)) - 100'000'000;
        break;
      case Event::read_page:
        note(run_->readers().read_whole(random_));
        break;
      case Event::change_settings:
        change_settings();
        break;
      default:
        break;
    }
  }

  // An operator edits the file and sends SIGHUP.
  void change_settings() {
    if (random_.below(4) == 0) return change_settings_wrongly();
    SiteFile& file = site_.file;
    BusText& bus = file.buses[random_.index(file.buses.size())];
    const std::size_t count = file.buses.size();
    switch (random_.below(7)) {
      case 0:
        site_.draw_times(file);
        break;
      case 1: {
        const auto before = file.features;
        site_.draw_features(file);
        if (site_.has_other_makes && goes_by_the_fleet(file)) file.features = before;
        break;
      }
      case 2:
        if (bus.units > 2) --bus.units;
        break;
      case 3:
        if (count > 1) file.buses.pop_back();
        break;
      case 4:
        if (count < site_.whole.buses.size()) file.buses.push_back(site_.whole.buses[count]);
        break;
      case 5:
        if (site_.has_other_makes && !goes_by_the_fleet(file)) {
          site_.draw_plane(file);
          // Half of those who edit it wait for the next start.
          if (random_.below(2) == 0) return;
          break;
        }
        [[fallthrough]];
      default:
        for (std::size_t i = 0; i < count; ++i) {
          file.buses[i].units = std::max(file.buses[i].units, site_.running.units(i));
        }
        if (bus.units < site_.whole.buses[bus_number(bus)].units) ++bus.units;
        break;
    }
    reload();
  }

  std::size_t bus_number(const BusText& bus) const {
    return static_cast<std::size_t>(&bus - site_.file.buses.data());
  }

  // It has no site of its own, and goes on by what the fleet has kept, also by the plane of that.
  static bool goes_by_the_fleet(const SiteFile& file) {
    return file.is_site_shared && file.features.empty();
  }

  void reload() {
    const Instant now = clock_.now();
    site_.write_file();
    if (!run_->reload(now)) return note("settings are refused: " + run_->refusal());
    if (!run_->refusal().empty()) return note("settings that were taken over are told as refused");
    const SiteFile before = std::exchange(site_.running, site_.file);
    // Nothing of a bus is taken back before a restart, and then all that is new has to wait.
    for (std::size_t i = 0; i < before.buses.size(); ++i) {
      if (site_.file.units(i) < before.units(i)) site_.running.buses = before.buses;
    }
    for (const auto& device : site_.devices) {
      if (!before.asks(device->bus, device->unit)) device->disturb(now);
    }
    for (BusWorld& bus : site_.buses) disturb(bus);
    judge_.change_settings(now);
    look_at_settings();
  }

  void look_at_settings() {
    const firmware::Settings& settings = run_->gateway().settings();
    std::uint32_t units = 0;
    for (const BusText& bus : site_.running.buses) units += bus.unit_count();
    if (run_->gateway().poller().unit_count() != units) {
      note(std::to_string(run_->gateway().poller().unit_count()) + " units are asked, not " +
           std::to_string(units));
    }
    if (settings.poll.interval != site_.running.interval ||
        settings.poll.leave_after != site_.running.leave_after) {
      note("the times are not those of the file");
    }
    const PlaneText& expected = site_.running.plane;
    const firmware::SitePlane plane = settings.site.plane();
    if (plane.unit_length * expected.units != nano || plane.origin_x != expected.origin * nano) {
      note("the plane is not that of the file");
    }
    if (goes_by_the_fleet(site_.running)) return;
    if (settings.features.size() != site_.running.features.size() ||
        run_->gateway().features().size() != site_.running.features.size()) {
      note("the features are not those of the file");
    }
  }

  void change_settings_wrongly() {
    const firmware::Settings* const before = &run_->gateway().settings();
    const std::uint64_t hash = run_->mesh().hash();
    site_.write_file(with_mistake(site_.file, random_.index(mistake_count)));
    if (run_->reload(clock_.now())) return note("settings with a mistake are taken over");
    if (run_->refusal().empty()) note("nobody is told why settings are refused");
    if (&run_->gateway().settings() != before || run_->mesh().hash() != hash) {
      note("refused settings have changed something");
    }
    look_at_settings();
  }

  void mend(BusWorld& bus) {
    if (bus.is_out_of_order()) disturb(bus);
    if (bus.line) bus.line->is_cut = bus.line->has_noise = false;
    if (bus.converter) {
      bus.converter->hangs = false;
      bus.converter->cut(false);
    }
  }
  // All folders are on one disk.
  void set_disk_full(bool is_full) {
    site_.disk.is_full = site_.disk_of_alarms.is_full = site_.folder.is_full = is_full;
  }
  void set_disk_hanging(bool hangs) {
    site_.disk.hangs = site_.disk_of_alarms.hangs = site_.folder.hangs = hangs;
  }
  void mend_disk() {
    set_disk_full(false);
    set_disk_hanging(false);
  }

  void restart(bool is_orderly) {
    if (is_orderly) {
      run_->finish(clock_.now());
      judge_.finish(*run_);
    }
    run_.reset();
    if (others_) others_->leave();
    site_.disk.lose_power();
    site_.disk_of_alarms.lose_power();
    for (BusWorld& bus : site_.buses) {
      if (bus.converter) bus.converter->close();
      if (bus.line) bus.line->close();
    }
    pass_to(clock_.now() + 1s + random_.below(300'000) * 1ms);
    start();
  }

  void end_faults() {
    const Instant now = site_.faults_ended_at = clock_.now();
    site_.remove_twins(now);
    mend_disk();
    site_.file.buses = site_.whole.buses;
    reload();
    if (others_) others_->end_faults(now);
    for (BusWorld& bus : site_.buses) {
      mend(bus);
      disturb(bus);
    }
    for (const auto& device : site_.devices) {
      device->is_plugged_in = true;
      device->is_leaving = false;
      device->fall_ill(Ailment::none, now, random_);
      if (!device->is_replaced) device->move(site_.free_place(), now);
      // It was told three times in vain, may be, and is told again then.
      if (site_.whole.has_write_back) device->boot(now);
    }
    if (newcomers_) newcomers_->end_faults(now);
  }

  inputs::Random random_;
  SimulatedClock clock_;
  WallClockWorld wall_clock_;
  SiteWorld site_;
  Judge judge_;
  ToldNeighbours told_;
  std::unique_ptr<Newcomers> newcomers_;
  std::unique_ptr<Others> others_;
  std::unique_ptr<GatewayRun> run_;
  std::array<std::uint32_t, event_count> weights_{};
  Duration pause_{};
  Instant happens_at_{};
  std::uint64_t runs_ = 0;
  Instant second_{};
  std::uint32_t steps_in_second_ = 0;
  Outcome outcome_;
};

}  // namespace

Outcome live(std::uint64_t seed, Duration faults, Company company) {
  try {
    return Life(seed, company).run(faults);
  } catch (const std::exception& error) {
    return {.wrong = error.what()};
  }
}

}  // namespace etcm::simulation

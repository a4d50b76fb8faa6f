// How well the poller uses a serial line: against simulated units on a terminal at the line's pace.
//
// Bus efficiency is the least time that the bytes and the silences of the questions need, over the
// time they took. The age of a position is the time since its last reading, sampled for all healthy
// units every few milliseconds. Reports, and judges nothing but that all units were read.
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <atomic>
#include <cstdio>
#include <cstdlib>
#include <string>
#include <thread>
#include <vector>

#include "firmware/polling/poller.h"
#include "fleet.h"
#include "modbus/rtu_bus.h"
#include "posix/event_loop.h"
#include "posix/steady_clock.h"
#include "posix/stream_log.h"
#include "pseudo_terminal.h"
#include "serial_units.h"

namespace {

using namespace etcm;
using namespace std::chrono_literals;

constexpr std::uint32_t dead_every = 10;
constexpr port::Duration sample_interval = 5ms;

struct Setup {
  std::uint32_t baud = 0;
  std::uint32_t units = 0;  // of which every tenth is dead
  bool with_dead = false;   // else those are not asked at all
  bool all_healthy = false;
  std::uint32_t sweeps = 0;
  port::Duration timeout{};
  port::Duration quiet{};
};

bool is_dead(const Setup& setup, std::uint32_t unit) {
  return !setup.all_healthy && unit % dead_every == 0;
}

// The units in a thread of their own, as they would be at the other end of a cable.
class OtherEnd {
 public:
  OtherEnd(const Setup& setup, const port::SerialLine& line, int descriptor)
      : fleet_(script_of(setup)), units_(loop_, fleet_, descriptor, line), thread_([this] {
          const port::SteadyClock clock;
          fleet_.advance(0);
          while (!ends_) {
            units_.advance(clock.now());
            loop_.wait(std::min<port::Duration>(units_.next_deadline() - clock.now(), 50ms));
          }
        }) {}
  ~OtherEnd() {
    ends_ = true;
    thread_.join();
  }
  std::uint32_t collision_count() const { return units_.collision_count(); }

 private:
  static nodes::Script script_of(const Setup& setup) {
    nodes::Script script;
    for (std::uint32_t unit = 1; unit <= setup.units; ++unit) {
      script.serials.push_back(unit);
      script.events.push_back(
          {.time_ms = 0,
           .node = unit - 1,
           .action = is_dead(setup, unit) ? nodes::Action::silent : nodes::Action::join,
           .position = {static_cast<std::int32_t>(unit), 0}});
    }
    return script;
  }

  port::EventLoop loop_;
  nodes::Fleet fleet_;
  nodes::SerialUnits units_;
  std::atomic<bool> ends_ = false;
  std::thread thread_;
};

class Readings final : public firmware::ReadingListener {
 public:
  explicit Readings(std::uint32_t units) : read_at_(units) {}
  bool on_reading(firmware::UnitIndex unit, const firmware::NodeReading&,
                  std::span<const firmware::Measurement>, port::Instant now) override {
    read_at_[unit.value] = now;
    ++count;
    return true;
  }
  void sample(port::Instant now) {
    for (const port::Instant read : read_at_) {
      if (read == port::Instant{}) continue;
      const auto age = static_cast<std::size_t>((now - read) / 1ms);
      if (age >= ages_.size()) ages_.resize(age + 1);
      ++ages_[age];
      ++samples_;
    }
  }
  std::size_t age_ms(double part) const {
    std::uint64_t seen = 0;
    for (std::size_t age = 0; age < ages_.size(); ++age) {
      seen += ages_[age];
      if (static_cast<double>(seen) >= part * static_cast<double>(samples_)) return age;
    }
    return ages_.size();
  }
  std::uint64_t count = 0;

 private:
  std::vector<port::Instant> read_at_;
  std::vector<std::uint64_t> ages_;  // by milliseconds
  std::uint64_t samples_ = 0;
};

struct Outcome {
  double efficiency = 0;
  double sweep_ms = 0;
  std::size_t age_p50_ms = 0;
  std::size_t age_p99_ms = 0;
  std::uint32_t collisions = 0;
  bool all_read = false;
};

Outcome measure(const Setup& setup, port::Log& log) {
  const nodes::PseudoTerminal terminal;
  const port::SerialLine line{.path = terminal.path(), .baud = setup.baud};
  const OtherEnd other_end(setup, line, terminal.descriptor());

  port::EventLoop loop;
  port::RtuBus bus(loop, log,
                   {.name = "bench",
                    .serial_line = line,
                    .quiet = setup.quiet,
                    .reopen_interval = 1s,
                    .send_enable = {}});
  firmware::BusSettings settings{.name = "bench",
                                 .link = line,
                                 .units = {},
                                 .timeout = setup.timeout,
                                 .quiet = setup.quiet,
                                 .outstanding_max = 1,
                                 .send_enable = {}};
  std::uint32_t healthy = 0;
  for (std::uint32_t unit = 1; unit <= setup.units; ++unit) {
    if (is_dead(setup, unit) && !setup.with_dead) continue;
    healthy += is_dead(setup, unit) ? 0u : 1u;
    const auto address = static_cast<std::uint8_t>(unit);
    settings.units.push_back({.first = address, .last = address});
  }
  // Shorter than a sweep, so that the line is never idle.
  const firmware::PollSettings poll{.interval = 10ms, .absent_interval = 10s};
  const std::vector<firmware::PolledBus> buses{{.bus = &bus, .settings = &settings}};
  Readings readings(setup.units);
  firmware::Poller poller(poll, buses, readings, log);

  const port::SteadyClock clock;
  const auto run = [&](std::uint64_t reads, bool samples) {
    const std::uint64_t end = readings.count + reads;
    // Twice what it takes, for units that are not read at all.
    const port::Instant latest = clock.now() + 60s + reads * 100ms;
    port::Instant sample_due = clock.now();
    while (readings.count < end && clock.now() < latest) {
      const port::Instant now = clock.now();
      poller.step(now);
      if (samples && sample_due <= now) {
        readings.sample(now);
        sample_due = now + sample_interval;
      }
      loop.wait(poller.next_deadline() - clock.now());
    }
    return readings.count >= end;
  };
  Outcome outcome;
  // The first sweeps find out who is dead.
  run(3 * healthy, false);
  const port::Instant begin = clock.now();
  outcome.all_read = run(std::uint64_t{setup.sweeps} * healthy, true);
  const port::Duration took = clock.now() - begin;
  const auto bytes = static_cast<std::int64_t>(
      port::rtu_read_request_bytes + port::rtu_read_answer_bytes(firmware::node_register_count));
  const port::Duration least =
      (bytes * character_time(line) + 2 * frame_silence(line)) * (setup.sweeps * healthy);
  outcome.efficiency = static_cast<double>(least.count()) / static_cast<double>(took.count());
  outcome.sweep_ms = static_cast<double>(took / 1us) / 1000 / setup.sweeps;
  outcome.age_p50_ms = readings.age_ms(0.5);
  outcome.age_p99_ms = readings.age_ms(0.99);
  outcome.collisions = other_end.collision_count();
  return outcome;
}

void print(const char* what, const Setup& setup, const Outcome& outcome) {
  std::printf(
      "%-24s %6u baud: efficiency %.3f, sweep %.1f ms, age p50 %zu ms p99 %zu ms, %u "
      "collisions%s\n",
      what, setup.baud, outcome.efficiency, outcome.sweep_ms, outcome.age_p50_ms,
      outcome.age_p99_ms, outcome.collisions, outcome.all_read ? "" : ", NOT ALL READ");
  std::fflush(stdout);
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app("Measures how well the poller uses a serial line.");
  std::vector<std::uint32_t> bauds{9600, 19200, 115200};
  std::uint32_t units = 247;
  std::uint32_t sweeps = 5;
  app.add_option("--baud", bauds);
  app.add_option("--units", units)->check(CLI::Range(11, 247));
  app.add_option("--sweeps", sweeps);
  CLI11_PARSE(app, argc, argv);

  port::StreamLog log(STDERR_FILENO);
  bool all_read = true;
  for (const std::uint32_t baud : bauds) {
    Setup setup{.baud = baud, .units = units, .sweeps = sweeps, .timeout = 50ms, .quiet = 20ms};
    setup.all_healthy = true;
    const Outcome full = measure(setup, log);
    print("all healthy", setup, full);
    setup.all_healthy = false;
    const Outcome without = measure(setup, log);
    print("without the dead tenth", setup, without);
    setup.with_dead = true;
    const Outcome with = measure(setup, log);
    print("with the dead tenth", setup, with);
    std::printf(
        "%-24s %6u baud: p99 age %+.1f %%\n", "the dead cost the others", baud,
        100.0 *
            (static_cast<double>(with.age_p99_ms) / static_cast<double>(without.age_p99_ms) - 1));
    all_read = all_read && full.all_read && without.all_read && with.all_read;
  }
  return all_read ? EXIT_SUCCESS : EXIT_FAILURE;
}

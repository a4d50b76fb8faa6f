// etcm-members: gateways of a fleet without devices, on a real broker. fleet_scale runs it.
#include <CLI/CLI.hpp>
#include <chrono>
#include <cstdio>
#include <ctime>
#include <exception>
#include <string>

#include "bench/fleet/crowd.h"
#include "command_line/command_line.h"
#include "posix/steady_clock.h"
#include "posix/stop_signal.h"

namespace {

using namespace etcm;
using namespace std::chrono_literals;

constexpr int exit_bad_input = 2;

double seconds(port::Duration duration) { return std::chrono::duration<double>(duration).count(); }

double cpu_seconds() { return static_cast<double>(std::clock()) / CLOCKS_PER_SEC; }

// What members of a site say, until all is said; then some of their nodes move.
void run_crowd(const bench::CrowdOptions& options, double moves_a_second, double duration) {
  port::EventLoop loop;
  bench::ErrorLog log;
  port::StopSignal stop(loop);
  const port::SteadyClock clock;
  const port::Instant start = clock.now();
  bench::Crowd crowd(loop, log, options, start);
  crowd.hear_all(start);
  const auto pause = std::chrono::duration_cast<port::Duration>(
      std::chrono::duration<double>(moves_a_second > 0 ? 1 / moves_a_second : 1e9));
  port::Instant ready = port::never;
  port::Instant next_move = port::never;
  port::Instant next_look = start;
  const auto end = [&](port::Instant now) {
    return ready != port::never && now >= ready + std::chrono::duration_cast<port::Duration>(
                                                      std::chrono::duration<double>(duration));
  };
  for (port::Instant now = start; !stop.received() && !end(now); now = clock.now()) {
    crowd.step(now);
    if (ready == port::never && now >= next_look) {
      next_look = now + 200ms;
      if (crowd.has_told_all()) {
        ready = next_move = now;
        std::printf("ready %.3f\n", seconds(now - start));
        std::fflush(stdout);
      }
    }
    for (; now >= next_move; next_move += pause) {
      const bench::Crowd::Move move = crowd.move_next(now);
      std::printf("move %.6f %u %d %d\n", seconds(now.time_since_epoch()), move.serial.value,
                  move.position.x, move.position.y);
      std::fflush(stdout);
    }
    loop.wait(std::min({crowd.next_deadline(), next_move, now + 100ms}) - clock.now());
  }
}

class Counter final : public bench::Participant {
 public:
  using Participant::Participant;
  void on_node(const firmware::FleetRecord&, bool, port::Instant) override { ++count; }
  std::uint32_t count = 0;
};

// A member that has just begun learns all nodes of the site.
void run_sync(const bench::CrowdOptions& options) {
  port::EventLoop loop;
  bench::ErrorLog log;
  const port::SteadyClock clock;
  const port::Instant start = clock.now();
  Counter reader(loop, log, options.broker, settings_of(options, "reader"), true, start);
  const std::uint32_t wanted = options.gateways * options.nodes;
  while (reader.count < wanted) {
    reader.step(clock.now());
    loop.wait(std::min(reader.next_deadline() - clock.now(), port::Duration(100ms)));
  }
  const double wall = seconds(clock.now() - start);
  std::uint32_t known = 0;
  reader.member().for_each_node([&](const firmware::FleetRecord&, bool) { ++known; });
  std::printf("synchronised %u nodes in %.3f s, %.3f s of CPU\n", known, wall, cpu_seconds());
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app("Gateways of a fleet without devices, on a broker that lets in anybody.",
               "etcm-members");
  bench::CrowdOptions options;
  std::string broker = "127.0.0.1:1883";
  bool is_deaf = false;
  double moves = 0;
  double duration = 0;
  app.add_option("--broker", broker, "HOST:PORT")->capture_default_str();
  app.add_option("--gateways", options.gateways, "How many")->capture_default_str();
  app.add_option("--nodes", options.nodes, "Nodes of each")->capture_default_str();
  CLI::App* const crowd = app.add_subcommand("crowd", "They tell their nodes, and nodes move");
  crowd->add_flag("--deaf", is_deaf, "They read nothing of each other");
  crowd->add_option("--moves", moves, "Moves a second, of all nodes together");
  crowd->add_option("--seconds", duration, "So long after all is told");
  const CLI::App* const sync =
      app.add_subcommand("sync", "Another one learns all that a crowd has told");
  if (const auto end = command_line::parse(app, argc, argv)) return *end;
  try {
    const auto end = port::parse_endpoint(broker, std::uint16_t{1883});
    if (!end) throw std::invalid_argument("--broker wants HOST:PORT, got '" + broker + "'");
    options.broker = *end;
    options.reads_all = !is_deaf;
    if (sync->parsed()) {
      run_sync(options);
    } else {
      run_crowd(options, moves, duration);
    }
  } catch (const std::exception& error) {
    std::fprintf(stderr, "etcm-members: %s\n", error.what());
    return exit_bad_input;
  }
  return 0;
}

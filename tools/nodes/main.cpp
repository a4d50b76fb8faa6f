// etcm-nodes: position nodes that join, move and go silent as a file says.
#include <CLI/CLI.hpp>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <memory>
#include <string>
#include <vector>

#include "fleet.h"
#include "modbus/tcp_listener.h"
#include "posix/event_loop.h"
#include "posix/steady_clock.h"
#include "posix/stop_signal.h"
#include "script.h"

namespace {

using namespace etcm;

constexpr int exit_bad_input = 2;
constexpr std::size_t clients_max = 8;

void run(port::SocketAddress address, const nodes::Script& script) {
  port::EventLoop loop;
  port::StopSignal stop(loop);
  const port::SteadyClock clock;
  nodes::Fleet fleet(script);

  std::vector<std::unique_ptr<nodes::FleetPort>> ports;
  std::vector<std::unique_ptr<port::TcpListener>> listeners;
  for (std::uint32_t i = 0; i < fleet.port_count(); ++i) {
    ports.push_back(std::make_unique<nodes::FleetPort>(fleet, i));
    listeners.push_back(
        std::make_unique<port::TcpListener>(loop, *ports.back(), address, clients_max));
    std::printf("listens on %s for units 1-%u\n", to_string(listeners.back()->address()).c_str(),
                fleet.unit_count(i));
    if (address.port != 0) ++address.port;
  }
  std::printf("ready: %zu nodes\n", script.serials.size());
  std::fflush(stdout);

  const port::Instant start = clock.now();
  while (!stop.received()) {
    using std::chrono::milliseconds;
    const port::Duration passed = clock.now() - start;
    fleet.advance(static_cast<std::uint32_t>(passed / milliseconds(1)));
    loop.wait(milliseconds(fleet.next_event_ms()) - passed);
  }
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app("Simulates position nodes as Modbus TCP units, 247 to a port.");
  std::string listen;
  std::string file;
  app.add_option("--listen", listen,
                 "ADDRESS:PORT of the first 247; the next have the ports after it. Port 0: the "
                 "system chooses each")
      ->required();
  app.add_option("--nodes", file, "what the nodes do, a CSV file: time_ms,serial,event,x,y")
      ->required();
  CLI11_PARSE(app, argc, argv);

  const auto address = port::parse_socket_address(listen);
  if (!address) {
    std::fprintf(stderr, "--listen %s: no address; write it as 127.0.0.1:1502\n", listen.c_str());
    return exit_bad_input;
  }
  nodes::Script script;
  try {
    script = nodes::read_script(file);
  } catch (const std::exception& error) {
    std::fprintf(stderr, "%s\n", error.what());
    return exit_bad_input;
  }
  try {
    run(*address, script);
    return EXIT_SUCCESS;
  } catch (const std::exception& error) {
    std::fprintf(stderr, "etcm-nodes: %s\n", error.what());
    return EXIT_FAILURE;
  }
}

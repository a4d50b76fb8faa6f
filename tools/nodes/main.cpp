// etcm-nodes: position nodes that join, move and go silent as a file says.
#include <CLI/CLI.hpp>
#include <algorithm>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "command_line/command_line.h"
#include "etcm/port/endpoint.h"
#include "fleet.h"
#include "modbus/tcp_listener.h"
#include "posix/event_loop.h"
#include "posix/name_resolver.h"
#include "posix/steady_clock.h"
#include "posix/stop_signal.h"
#include "pseudo_terminal.h"
#include "script.h"
#include "serial_units.h"

namespace {

using namespace etcm;

constexpr int exit_bad_input = 2;
constexpr std::size_t clients_max = 8;

// The fleet as time passes, whatever carries its answers. `advance` is told the time and says when
// it wants to be told again.
template <class Advance>
void run(port::EventLoop& loop, nodes::Fleet& fleet, const Advance& advance) {
  using std::chrono::milliseconds;
  port::StopSignal stop(loop);
  const port::SteadyClock clock;
  std::printf("ready: %u nodes\n", fleet.node_count());
  std::fflush(stdout);
  const port::Instant start = clock.now();
  while (!stop.received()) {
    const port::Instant now = clock.now();
    fleet.advance(static_cast<std::uint32_t>((now - start) / milliseconds(1)));
    const port::Instant deadline =
        std::min(start + milliseconds(fleet.next_event_ms()), advance(now));
    loop.wait(deadline - clock.now());
  }
}

void run_tcp(port::SocketAddress address, const nodes::Script& script) {
  port::EventLoop loop;
  nodes::Fleet fleet(script);
  std::vector<std::unique_ptr<nodes::FleetPort>> ports;
  std::vector<std::unique_ptr<port::TcpListener>> listeners;
  for (std::uint32_t i = 0; i < fleet.port_count(); ++i) {
    ports.push_back(std::make_unique<nodes::FleetPort>(fleet, i));
    listeners.push_back(
        std::make_unique<port::TcpListener>(loop, *ports.back(), address, clients_max));
    const port::Acceptor& acceptor = listeners.back()->acceptor();
    if (!acceptor.is_listening()) {
      throw std::runtime_error(acceptor.failure() + "; " + acceptor.cure("--listen"));
    }
    std::printf("listens on %s for units 1-%u\n", to_string(listeners.back()->address()).c_str(),
                fleet.unit_count(i));
    if (address.port != 0) ++address.port;
  }
  run(loop, fleet, [&](port::Instant now) {
    port::Instant deadline = port::never;
    for (const auto& listener : listeners) {
      listener->advance(now);
      deadline = std::min(deadline, listener->next_deadline());
    }
    return deadline;
  });
}

void run_rtu(const port::SerialLine& line, const nodes::Script& script) {
  port::EventLoop loop;
  nodes::Fleet fleet(script);
  const nodes::PseudoTerminal terminal(line.path);
  nodes::SerialUnits units(loop, fleet, terminal.descriptor(), line);
  std::printf("answers on %s at %u baud for units 1-%u\n", terminal.path().c_str(), line.baud,
              fleet.unit_count(0));
  run(loop, fleet, [&](port::Instant now) {
    units.advance(now);
    return units.next_deadline();
  });
}

// A name stands for the first of its addresses. None where there is none, and why.
std::optional<port::SocketAddress> address_to_listen_at(const std::string& text, std::string& why) {
  if (const auto address = port::parse_socket_address(text)) return address;
  const auto end = port::parse_endpoint(text);
  if (!end) {
    why = "no address; write it as 127.0.0.1:1502, localhost:1502 or [::1]:1502";
    return std::nullopt;
  }
  const port::FoundHosts found = port::find_hosts(end->host.c_str(), false);
  if (found.count > 0) return port::SocketAddress{found.hosts[0], end->port};
  why = std::string(found.why_none) + "; give a name of this machine, or an address";
  return std::nullopt;
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app(
      "Simulates position nodes as Modbus units: over TCP, 247 to a port, or on a serial line.",
      "etcm-nodes");
  std::string listen;
  std::string file;
  port::SerialLine line;
  auto* const links = app.add_option_group("link");
  links->add_option("--listen", listen,
                    "HOST:PORT of the first 247; the next have the ports after it. Port 0: the "
                    "system chooses each");
  auto* const rtu =
      links->add_option("--rtu", line.path, "where to make a pseudo terminal for a master to open");
  links->require_option(1);
  app.add_option("--baud", line.baud, "the pace of the terminal, with even parity")->needs(rtu);
  app.add_option("--nodes", file, "what the nodes do, a CSV file: time_ms,serial,event,x,y")
      ->required();
  if (const auto end = command_line::parse(app, argc, argv)) return *end;

  const auto complain = [&](const std::string& what) {
    return command_line::complain(app, exit_bad_input, what);
  };
  std::optional<port::SocketAddress> address;
  if (std::string why; line.path.empty() && !(address = address_to_listen_at(listen, why))) {
    return complain("--listen " + listen + ": " + why);
  }
  if (!port::is_baud(line.baud)) {
    return complain("--baud " + std::to_string(line.baud) +
                    ": no speed; give 9600, 19200, 115200, or another from " +
                    std::to_string(port::baud_least) + " to " + std::to_string(port::baud_most));
  }
  nodes::Script script;
  try {
    script = nodes::read_script(file);
  } catch (const std::exception& error) {
    return complain(error.what());
  }
  if (!line.path.empty() && script.serials.size() > nodes::units_per_port) {
    return complain(file + ": " + std::to_string(script.serials.size()) +
                    " nodes, but a line has 247 units; take some out, or use --listen");
  }
  try {
    if (line.path.empty()) {
      run_tcp(*address, script);
    } else {
      run_rtu(line, script);
    }
    return EXIT_SUCCESS;
  } catch (const std::exception& error) {
    return command_line::complain(app, EXIT_FAILURE, error.what());
  }
}

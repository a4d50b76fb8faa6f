// etcm-gateway: the only place that knows which adapters stand behind the interfaces.
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <memory>
#include <optional>
#include <stdexcept>
#include <string>
#include <variant>
#include <vector>

#include "etcm/mesh.h"
#include "firmware/config/configuration.h"
#include "firmware/config/reload.h"
#include "firmware/config/settings.h"
#include "firmware/config/settings_text.h"
#include "firmware/gateway/board_io.h"
#include "firmware/gateway/gateway.h"
#include "firmware/gateway/service_watch.h"
#include "firmware/logging/limited_log.h"
#include "firmware/persist/saved_state.h"
#include "firmware/publish/mesh_registers.h"
#include "firmware/status/recent_events.h"
#include "firmware/status/status_page.h"
#include "http/web_server.h"
#include "modbus/register_server.h"
#include "modbus/rtu_bus.h"
#include "modbus/tcp_bus.h"
#include "posix/background_store.h"
#include "posix/event_loop.h"
#include "posix/mesh_folder.h"
#include "posix/process_memory.h"
#include "posix/signal_watch.h"
#include "posix/steady_clock.h"
#include "posix/stop_signal.h"
#include "posix/stream_log.h"
#include "posix/systemd_notify.h"
#ifdef ETCM_WITH_GPIO
#include "gpio/gpio_lines.h"
#endif

namespace {

using namespace etcm;

constexpr int exit_bad_settings = 2;
constexpr port::Identity identity{{"ETCM", "etcm-gateway", ETCM_VERSION}};

// The lines of the board that the settings name.
class Board {
 public:
  Board(const firmware::Settings& settings, port::EventLoop& loop, port::Log& log) {
#ifdef ETCM_WITH_GPIO
    std::vector<port::LineRequest> requests;
    const auto want = [&](const std::optional<firmware::LineSettings>& line, port::LineUse use) {
      if (!line) return;
      requests.push_back({.place = line->place, .use = use, .is_active_low = line->is_active_low});
      places_.push_back(line->place);
    };
    want(settings.gpio.alert, port::LineUse::input);
    want(settings.gpio.join_button, port::LineUse::input);
    want(settings.gpio.status_led, port::LineUse::output);
    want(settings.gpio.watchdog, port::LineUse::output);
    for (const firmware::BusSettings& bus : settings.buses) {
      want(bus.send_enable, port::LineUse::output);
    }
    if (!requests.empty()) io_.emplace(loop, log, requests, settings.gpio.debounce);
#else
    static_cast<void>(loop);
    static_cast<void>(log);
    const firmware::GpioSettings& gpio = settings.gpio;
    bool is_wanted = gpio.alert || gpio.join_button || gpio.status_led || gpio.watchdog;
    for (const firmware::BusSettings& bus : settings.buses) {
      is_wanted = is_wanted || bus.send_enable;
    }
    if (is_wanted) {
      throw std::runtime_error(
          "the settings name gpio lines, but this gateway was built without libgpiod; install "
          "libgpiod-dev and build it again, or take the lines out");
    }
#endif
  }

  // Null where the settings name no line.
  port::DigitalIo* io() {
#ifdef ETCM_WITH_GPIO
    if (io_) return &*io_;
#endif
    return nullptr;
  }

  std::optional<port::Line> line_of(const std::optional<firmware::LineSettings>& line) const {
    const auto found =
        line ? std::find(places_.begin(), places_.end(), line->place) : places_.end();
    if (found == places_.end()) return std::nullopt;
    return port::Line{static_cast<std::uint8_t>(found - places_.begin())};
  }

 private:
  std::vector<std::string> places_;  // by line
#ifdef ETCM_WITH_GPIO
  std::optional<port::GpioLines> io_;
#endif
};

using Bus = std::variant<std::unique_ptr<port::TcpBus>, std::unique_ptr<port::RtuBus>>;

Bus make_bus(const firmware::BusSettings& bus, port::Duration retry_interval, port::EventLoop& loop,
             port::Log& log, Board& board) {
  if (const auto* const line = std::get_if<port::SerialLine>(&bus.link)) {
    return std::make_unique<port::RtuBus>(
        loop, log,
        port::RtuBusOptions{.name = bus.name,
                            .line = *line,
                            .quiet = bus.quiet,
                            .reopen_interval = retry_interval,
                            .lines = board.io(),
                            .send_enable = board.line_of(bus.send_enable)});
  }
  return std::make_unique<port::TcpBus>(
      loop, log,
      port::TcpBusOptions{.name = bus.name,
                          .address = std::get<port::SocketAddress>(bus.link),
                          .outstanding_max = bus.outstanding_max,
                          .reconnect_interval = retry_interval});
}

port::NodeBus* interface_of(const Bus& bus) {
  return std::visit([](const auto& adapter) -> port::NodeBus* { return adapter.get(); }, bus);
}

// The status page and its server.
class Web {
 public:
  Web(const firmware::HttpSettings& settings, const firmware::StatusSources& sources,
      port::ServiceCounters& counters, port::EventLoop& loop, port::Log& log)
      : page_(sources, settings.clients_max),
        server_(loop, page_, {.listen = settings.listen, .clients_max = settings.clients_max},
                counters) {
    allow(settings.allow, log);
  }

  void allow(const std::vector<port::Network>& networks, port::Log& log) {
    server_.allow(networks, log);
  }

  void step(port::Instant now) {
    page_.advance(now);
    server_.advance(now);
  }
  port::Instant next_deadline() const {
    return std::min(page_.next_deadline(), server_.next_deadline());
  }
  const port::Acceptor& acceptor() const { return server_.acceptor(); }

 private:
  firmware::StatusPage page_;
  port::WebServer server_;
};

// A disk that does not answer holds up the end no longer than this.
constexpr port::Duration exit_patience = std::chrono::seconds(5);

void finish(firmware::Gateway& gateway, port::BackgroundStore* store, port::MeshFolder* folder,
            const port::Clock& clock, port::Log& log) {
  const port::Instant end = clock.now() + exit_patience;
  const auto is_answered = [&](auto* disk) {
    return disk == nullptr || disk->wait(std::max<port::Duration>(end - clock.now(), {}));
  };
  // What is under way first; then there is room for the last ones.
  static_cast<void>(is_answered(store));
  static_cast<void>(is_answered(folder));
  gateway.finish(clock.now());
  if (!is_answered(store)) {
    log.write(port::Level::error, "state: the disk of " + store->folder() +
                                      " does not answer; a restart finds an earlier state");
  }
  if (!is_answered(folder)) {
    log.write(port::Level::error, "files: the disk of " + folder->base() +
                                      ".node does not answer; the files show an earlier mesh");
  }
  gateway.finish_saving(clock.now());
}

std::string list_of(const std::vector<port::Network>& networks) {
  std::string list;
  for (const port::Network& network : networks) {
    list += (list.empty() ? "" : ", ") + to_string(network);
  }
  return list.empty() ? "nobody" : list;
}

// Says where something is served, once it is; and once why it is not, while its port cannot be had.
class PortReport {
 public:
  // `section` of the settings has the port. All must outlive this.
  PortReport(const port::Acceptor& acceptor, const char* section,
             const std::vector<port::Network>& allowed, port::Log& log)
      : acceptor_(acceptor), section_(section), allowed_(allowed), log_(log) {}

  void step(const char* served, const char* missing) {
    if (is_told_ == acceptor_.is_listening()) return;
    is_told_ = acceptor_.is_listening();
    if (*is_told_) {
      log_.write(port::Level::info,
                 served + to_string(acceptor_.address()) + " to " + list_of(allowed_));
    } else {
      log_.write(port::Level::error, std::string(missing) + ": " + acceptor_.failure() + "; " +
                                         acceptor_.cure(section_) + "; goes on, and tries again");
    }
  }

 private:
  const port::Acceptor& acceptor_;
  const char* section_;
  const std::vector<port::Network>& allowed_;
  port::Log& log_;
  std::optional<bool> is_told_;
};

// `log` leaves out what repeats; `events` writes each line.
void run(const std::string& config, firmware::Settings& settings, const port::Clock& clock,
         port::Log& log, firmware::RecentEvents& events) {
  port::EventLoop loop;
  port::StopSignal stop(loop);
  port::SignalWatch reread(loop, {SIGHUP});

  // All the memory the mesh ever has. operator new aligns it to 16; the mesh asks for 8.
  std::vector<std::byte> memory(storage_bytes(settings.mesh));
  Mesh mesh;
  if (const Status status = mesh.open(memory, settings.mesh); status != Status::ok) {
    throw std::runtime_error(std::string("the mesh refuses its settings: ") + explain(status));
  }

  Board board(settings, loop, log);
  std::vector<Bus> buses;
  std::vector<firmware::PolledBus> polled;
  for (const firmware::BusSettings& bus : settings.buses) {
    buses.push_back(make_bus(bus, settings.poll.interval, loop, log, board));
    polled.push_back({.bus = interface_of(buses.back()), .settings = &bus});
  }
  port::RegisterServer server(loop, settings.server.listen, settings.server.clients_max, identity,
                              firmware::empty_image(settings));
  server.allow(settings.server.allow, log);
  PortReport server_report(server.acceptor(), "server", settings.server.allow, log);
  std::unique_ptr<port::MeshFolder> folder;
  if (settings.files) {
    folder = std::make_unique<port::MeshFolder>(settings.files->folder, settings.files->name,
                                                settings.mesh.vertices_max);
    log.write(port::Level::info, "writes " + folder->base() + ".node, .ele and .svg");
  }

  std::unique_ptr<port::BackgroundStore> store;
  if (settings.state) {
    store = std::make_unique<port::BackgroundStore>(settings.state->folder,
                                                    firmware::saved_state_size_max(settings), log);
    log.write(port::Level::info, "keeps its state in " + store->folder());
  }

  firmware::Gateway gateway(settings, mesh,
                            {.buses = polled,
                             .server = server,
                             .files = folder.get(),
                             .store = store.get(),
                             .clock = clock,
                             .log = log});
  std::optional<firmware::BoardIo> board_io;
  if (board.io() != nullptr) {
    board_io.emplace(*board.io(),
                     firmware::BoardLines{.alert = board.line_of(settings.gpio.alert),
                                          .join_button = board.line_of(settings.gpio.join_button),
                                          .status_led = board.line_of(settings.gpio.status_led),
                                          .watchdog = board.line_of(settings.gpio.watchdog)},
                     gateway);
  }
  port::ServiceCounters readers;
  std::optional<Web> web;
  std::optional<PortReport> web_report;
  if (settings.http) {
    web.emplace(*settings.http,
                firmware::StatusSources{.gateway = gateway,
                                        .settings = settings,
                                        .events = events,
                                        .masters = server.counters(),
                                        .readers = readers,
                                        .version = ETCM_VERSION,
                                        .started_at = clock.now(),
                                        .resident_bytes = port::resident_bytes},
                readers, loop, log);
    web_report.emplace(web->acceptor(), "http", settings.http->allow, log);
  }
  const auto report_ports = [&] {
    server_report.step("serves the mesh on ", "the mesh is not served");
    if (web_report) web_report->step("shows the status page on http://", "there is no status page");
  };
  report_ports();
  port::SystemdNotify manager;
  firmware::ServiceWatch watch(manager, gateway, {.masters = server.counters(), .readers = readers},
                               log);
  gateway.restore(clock.now());
  watch.ready(clock.now());
  port::Instant reload_due{};
  while (!stop.received()) {
    if (board_io) board_io->step(clock.now());
    gateway.step(clock.now());
    watch.step(clock.now());
    server.advance(clock.now());
    if (web) web->step(clock.now());
    report_ports();
    // A large site takes its time. What arrives meanwhile is taken in before anybody is given up.
    if (reread.received() && reload_due <= clock.now()) {
      static_cast<void>(reread.take_received());
      watch.reloading();
      if (firmware::reload(config, settings, events)) {
        server.allow(settings.server.allow, log);
        if (web) web->allow(settings.http->allow, log);
        gateway.update_settings(clock.now());
      }
      watch.ready(clock.now());
      reload_due = clock.now() + firmware::reload_pause;
    }
    const port::Instant deadline =
        std::min({gateway.next_deadline(), watch.next_deadline(), server.next_deadline(),
                  reread.received() ? reload_due : port::never,
                  board_io ? board_io->next_deadline() : port::never,
                  web ? web->next_deadline() : port::never});
    loop.wait(deadline - clock.now());
  }
  watch.stopping();
  finish(gateway, store.get(), folder.get(), clock, log);
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app(
      "Collects node positions over Modbus, keeps a conforming Delaunay mesh of them, and "
      "publishes it as Modbus registers and files.");
  std::string config;
  bool check_config = false;
  bool register_map = false;
  bool settings_file = false;
  bool settings_table = false;
  auto* config_option = app.add_option("--config", config, "settings, a TOML file");
  auto* check_option = app.add_flag("--check-config", check_config, "check the settings and end");
  auto* map_option = app.add_flag("--register-map", register_map,
                                  "print the tables of the registers it serves, and end");
  auto* settings_option = app.add_flag(
      "--settings", settings_file, "print a settings file with every key and its default, and end");
  auto* table_option =
      app.add_flag("--settings-table", settings_table, "print the table of the settings, and end");
  check_option->needs(config_option);
  for (CLI::Option* option : {map_option, settings_option, table_option}) {
    option->excludes(config_option);
  }
  app.set_version_flag("--version", ETCM_VERSION, "print the version and end");
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    return app.exit(error) == 0 ? EXIT_SUCCESS : exit_bad_settings;
  }

  if (register_map) std::fputs(firmware::describe_mesh_registers().c_str(), stdout);
  if (settings_file) std::fputs(firmware::print_settings().c_str(), stdout);
  if (settings_table) std::fputs(firmware::describe_settings().c_str(), stdout);
  if (register_map || settings_file || settings_table) return EXIT_SUCCESS;
  if (config.empty()) {
    std::fputs("--config is missing; give the path of the settings, such as --config site.toml\n",
               stderr);
    return exit_bad_settings;
  }
  const port::SteadyClock clock;
  port::StreamLog log(STDERR_FILENO);
  try {
    std::vector<std::string> mistakes;
    firmware::Settings settings = firmware::read_configuration(config, mistakes);
    for (const std::string& mistake : mistakes) {
      // Who checks reads them as they are; of a service they are errors in its log.
      if (check_config) {
        std::fprintf(stderr, "%s\n", mistake.c_str());
      } else {
        log.write(port::Level::error, mistake);
      }
    }
    if (!mistakes.empty()) return exit_bad_settings;
    if (check_config) {
      std::printf("%s: good\n", config.c_str());
      return EXIT_SUCCESS;
    }
    // Before both: noise fills neither the log nor the events of the status page.
    firmware::RecentEvents events(clock, log);
    firmware::LimitedLog limited(events, clock);
    run(config, settings, clock, limited, events);
    limited.flush();
    return EXIT_SUCCESS;
  } catch (const std::exception& error) {
    log.write(port::Level::error, error.what());
    return EXIT_FAILURE;
  }
}

#include "firmware/app/program.h"

#include <algorithm>
#include <csignal>
#include <cstdint>
#include <filesystem>
#include <random>
#include <stdexcept>
#include <utility>

#include "firmware/config/reload.h"
#include "firmware/persist/saved_state.h"
#include "firmware/polling/quantity.h"
#include "posix/process_memory.h"

namespace etcm::firmware {

namespace {

constexpr port::Identity identity{{"ETCM", "etcm-gateway", ETCM_VERSION}};
// A disk that does not answer holds up the end no longer than this.
constexpr port::Duration exit_patience = std::chrono::seconds(5);
// What a serial server still passes on after a wait in vain, as `quiet` of a serial line.
constexpr port::Duration quiet_over_tcp = std::chrono::milliseconds(50);

// So long a unit may take for what an earlier run has asked.
port::Duration clearing_of(const BusSettings& bus) {
  port::Duration longest = bus.timeout;
  for (const DeviceSettings& device : bus.devices) longest = std::max(longest, device.timeout);
  return longest + port::late_answer_max;
}

// Of all gateways anywhere no two are likely to draw the same.
std::uint64_t number_of_run() {
  std::random_device chance;
  return std::uint64_t{chance()} << 32 | chance();
}

PortMessages server_messages() {
  return {.key = "`listen` of [server]",
          .served = "serves the mesh on ",
          .missing = "the mesh is not served"};
}

}  // namespace

Program::Program(std::string config, std::shared_ptr<const Settings> settings,
                 port::ProjectionSource* projections, const port::Clock& clock, port::Log& log,
                 RecentEvents& events)
    : config_(std::move(config)),
      config_place_(std::filesystem::absolute(config_)),
      settings_(std::move(settings)),
      projections_(projections),
      clock_(clock),
      log_(log),
      events_(events),
      stop_(loop_),
      reread_(loop_, {SIGHUP}),
      board_(*settings_, loop_, log),
      shared_lines_(settings_->buses, loop_, log),
      server_(loop_, settings_->server.listen, settings_->server.clients_max, identity,
              empty_image(*settings_)),
      server_report_(server_.acceptor(), server_messages(), settings_->server.allow, log),
      broker_(*settings_, loop_, log) {
  open_mesh();
  const std::vector<PolledBus> buses = open_buses(0);
  server_.allow(settings_->server.allow, log);
  open_disks();
  make_gateway(buses);
  integrations_.emplace(*settings_, ETCM_VERSION, *gateway_, broker_, wall_clock_);
  open_desk();
  // Whoever reads that the mesh is served may give commands from then on.
  server_report_.step();
  watch_.emplace(manager_, *gateway_,
                 WatchedServers{.masters = server_.counters(), .readers = readers_}, refusal_,
                 log_);
}

void Program::open_desk() {
  const port::Instant now = clock_.now();
  desk_.emplace(*settings_,
                AlarmSources{.gateway = *gateway_,
                             .masters = server_.counters(),
                             .readers = settings_->http ? &readers_ : nullptr,
                             .refusal = refusal_,
                             .started_at = now},
                wall_clock_, log_);
  const StatusSources sources{.gateway = *gateway_,
                              .events = events_,
                              .alarms = desk_->alarms(),
                              .wall_clock = wall_clock_,
                              .masters = server_.counters(),
                              .readers = readers_,
                              .version = ETCM_VERSION,
                              .config = config_place_,
                              .started_at = now,
                              .refusal = &refusal_,
                              .needs_restart = &needs_restart_,
                              .disk_of_alarms = desk_->disk_of_alarms(),
                              .resident_bytes = port::resident_bytes,
                              .heap_bytes = port::heap_bytes};
  desk_->open(*settings_, *gateway_, sources, loop_);
  if (settings_->http) web_.emplace(*settings_->http, sources, readers_, loop_, log_);
}

void Program::open_mesh() {
  // operator new aligns it to 16; the mesh asks for 8.
  memory_.resize(storage_bytes(settings_->mesh));
  if (const Status status = mesh_.open(memory_, settings_->mesh); status != Status::ok) {
    throw std::runtime_error(std::string("the mesh refuses its settings: ") + explain(status));
  }
}

Program::Bus Program::make_bus(const BusSettings& bus, port::Duration retry_interval) {
  if (const auto* const line = std::get_if<port::SerialLine>(&bus.link)) {
    return std::make_unique<port::RtuBus>(
        loop_, log_,
        port::RtuBusOptions{.name = bus.name,
                            .serial_line = *line,
                            .clearing = clearing_of(bus),
                            .quiet = bus.quiet,
                            .reopen_interval = retry_interval,
                            .lines = board_.io(),
                            .send_enable = board_.line_of(bus.send_enable)});
  }
  const port::Endpoint& end = std::get<port::Endpoint>(bus.link);
  if (bus.framing == Framing::rtu) {
    tcp_lines_.push_back(std::make_unique<port::RtuTcpLine>(loop_, end));
    return std::make_unique<port::RtuBus>(*tcp_lines_.back(), log_,
                                          port::RtuBusOptions{.name = bus.name,
                                                              .serial_line = {},
                                                              .address = to_string(end),
                                                              .clearing = clearing_of(bus),
                                                              .quiet = quiet_over_tcp,
                                                              .reopen_interval = retry_interval});
  }
  return std::make_unique<port::TcpBus>(loop_, log_,
                                        port::TcpBusOptions{.name = bus.name,
                                                            .end = end,
                                                            .outstanding_max = bus.outstanding_max,
                                                            .reconnect_interval = retry_interval});
}

void Program::open_disks() {
  if (settings_->files) {
    const bool has_readings = count_readings(*settings_) > 0;
    folder_ = std::make_unique<port::MeshFolder>(settings_->files->folder, settings_->files->name,
                                                 settings_->mesh.vertices_max, has_readings);
    log_.write(port::Level::info,
               "writes " + folder_->base() +
                   (has_readings ? ".node, .ele, .svg and .geojson" : ".node, .ele and .svg"));
  }
  if (settings_->state) {
    store_ = std::make_unique<port::BackgroundStore>(settings_->state->folder,
                                                     saved_state_size_max(*settings_), log_);
    log_.write(port::Level::info, "keeps its state in " + store_->folder());
  }
}

// Those of the settings from this one on.
std::vector<PolledBus> Program::open_buses(std::size_t first) {
  std::vector<PolledBus> opened;
  for (std::size_t i = first; i < settings_->buses.size(); ++i) {
    buses_.push_back(make_bus(settings_->buses[i], settings_->poll.interval));
    port::NodeBus* const bus = std::visit(
        [](const auto& adapter) -> port::NodeBus* { return adapter.get(); }, buses_.back());
    opened.push_back(
        {.bus = bus, .settings = &settings_->buses[i], .clients = &shared_lines_.clients(i)});
  }
  return opened;
}

void Program::make_gateway(std::span<const PolledBus> buses) {
  gateway_.emplace(settings_, mesh_,
                   GatewayPorts{.buses = buses,
                                .server = server_,
                                .files = folder_.get(),
                                .store = store_.get(),
                                .clock = clock_,
                                .wall_clock = &wall_clock_,
                                .log = log_,
                                .broker = broker_.broker(),
                                .projections = projections_,
                                .run = number_of_run(),
                                .version = ETCM_VERSION});
  if (board_.io() != nullptr) {
    board_io_.emplace(*board_.io(), board_.lines_of(settings_->gpio), *gateway_);
  }
}

void Program::run() {
  gateway_->restore(clock_.now());
  watch_->ready(clock_.now());
  while (!stop_.received()) {
    if (board_io_) board_io_->step(clock_.now());
    broker_.step(clock_.now());
    gateway_->step(clock_.now());
    integrations_->step(clock_.now());
    watch_->step(clock_.now());
    server_.advance(clock_.now());
    server_report_.step();
    shared_lines_.step(clock_.now());
    desk_->step(clock_.now());
    if (web_) web_->step(clock_.now());
    // A large site takes its time. What arrives meanwhile is taken in before anybody is given up.
    if (reread_.received() && reload_due_ <= clock_.now()) reload_settings();
    const port::Instant deadline = next_deadline();
    loop_.wait(deadline - clock_.now());
  }
  watch_->stopping();
  finish();
}

void Program::reload_settings() {
  static_cast<void>(reread_.take_received());
  watch_->reloading();
  if (std::shared_ptr<const Settings> next =
          reload(config_, *settings_, projections_, events_, refusal_, &needs_restart_)) {
    const std::size_t known = settings_->buses.size();
    settings_ = std::move(next);
    shared_lines_.update(settings_->buses);
    const std::vector<PolledBus> added = open_buses(known);
    server_.allow(settings_->server.allow, log_);
    server_report_.allow(settings_->server.allow);
    if (web_) web_->update(*settings_->http);
    if (folder_ && count_readings(*settings_) > 0) folder_->add_values();
    gateway_->update_settings(settings_, added, clock_.now());
    integrations_->update_settings(gateway_->settings());
  }
  watch_->ready(clock_.now());
  reload_due_ = clock_.now() + reload_pause;
}

port::Instant Program::next_deadline() const {
  return std::min({gateway_->next_deadline(), watch_->next_deadline(), server_.next_deadline(),
                   shared_lines_.next_deadline(), broker_.next_deadline(),
                   integrations_->next_deadline(), reread_.received() ? reload_due_ : port::never,
                   desk_->next_deadline(), board_io_ ? board_io_->next_deadline() : port::never,
                   web_ ? web_->next_deadline() : port::never});
}

void Program::finish() {
  const port::Instant end = clock_.now() + exit_patience;
  const auto is_answered = [&](const auto& disk) {
    return disk == nullptr || disk->wait(std::max<port::Duration>(end - clock_.now(), {}));
  };
  // What is under way first; then there is room for the last ones.
  static_cast<void>(is_answered(store_));
  static_cast<void>(is_answered(folder_));
  gateway_->finish(clock_.now());
  if (!is_answered(store_)) {
    log_.write(port::Level::error, "state: the disk of " + store_->folder() +
                                       " does not answer; a restart finds an earlier state");
  }
  if (!is_answered(folder_)) {
    log_.write(port::Level::error, "files: the disk of " + folder_->base() +
                                       ".node does not answer; the files show an earlier mesh");
  }
  gateway_->finish_saving(clock_.now());
  desk_->finish(clock_.now(), std::max<port::Duration>(end - clock_.now(), {}));
}

}  // namespace etcm::firmware

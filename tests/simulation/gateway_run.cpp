#include "gateway_run.h"

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <stdexcept>
#include <utility>

#include "etcm/config.h"
#include "firmware/config/configuration.h"
#include "firmware/config/reload.h"

namespace etcm::simulation {

using namespace std::chrono_literals;

TellingLog::TellingLog(const port::Clock& clock)
    : clock_(clock), tells_(std::getenv("ETCM_SIMULATION_VERBOSE") != nullptr) {}

void TellingLog::write(port::Level, std::string_view line) {
  if (!tells_) return;
  std::printf("[%10.3f] %.*s\n",
              std::chrono::duration<double>(clock_.now().time_since_epoch() - 1h).count(),
              static_cast<int>(line.size()), line.data());
}

GatewayRun::GatewayRun(SiteWorld& site, const SimulatedClock& clock,
                       const port::WallClock& wall_clock, std::uint64_t number,
                       GatewayCompany company)
    : site_(site),
      company_(std::move(company)),
      settings_(read(site.path())),
      told_(clock),
      events_(clock, told_) {
  const std::vector<firmware::PolledBus> polled = open_buses(0);
  memory_.resize(storage_bytes(settings_->mesh));
  static_cast<void>(mesh_.open(memory_, settings_->mesh));
  gateway_ = std::make_unique<firmware::Gateway>(settings_, mesh_,
                                                 firmware::GatewayPorts{.buses = polled,
                                                                        .server = masters_,
                                                                        .files = &site.folder,
                                                                        .store = &site.disk,
                                                                        .clock = clock,
                                                                        .wall_clock = &wall_clock,
                                                                        .log = events_,
                                                                        .broker = company_.broker,
                                                                        .run = number,
                                                                        .version = "simulated"});
  const Instant now = clock.now();
  gateway_->restore(now);
  if (company_.sparkplug != nullptr) open_sparkplug(wall_clock);
  open_alarms(wall_clock, now);
  counters_.is_listening = true;
  page_.emplace(firmware::StatusSources{.gateway = *gateway_,
                                        .events = events_,
                                        .alarms = alarms_->book(),
                                        .wall_clock = wall_clock,
                                        .masters = counters_,
                                        .readers = counters_,
                                        .version = "simulated",
                                        .started_at = now,
                                        .refusal = &refusal_},
                PageReaders::count_max);
  readers_.emplace(*page_);
}

void GatewayRun::open_sparkplug(const port::WallClock& wall_clock) {
  edge_node_.emplace(firmware::sparkplug::EdgeNodeNames{.group = settings_->mqtt->sparkplug,
                                                        .edge_node = settings_->mqtt->name},
                     *settings_, settings_->mqtt->period_min,
                     firmware::sparkplug::Sources{.nodes = gateway_->nodes(),
                                                  .mesh = gateway_->snapshot(),
                                                  .readings = gateway_->readings()},
                     *company_.sparkplug, wall_clock);
}

void GatewayRun::open_alarms(const port::WallClock& wall_clock, Instant now) {
  alarms_.emplace(firmware::AlarmSources{.gateway = *gateway_,
                                         .masters = counters_,
                                         .readers = nullptr,
                                         .refusal = refusal_,
                                         .started_at = now});
  if (company_.broker == nullptr) {
    // A broker would be told of other alarms, and lives that have failed once would be others.
    alarm_keeper_.emplace(alarms_->book(), site_.disk_of_alarms, wall_clock, events_);
    alarms_->watch_disk_of_alarms(alarm_keeper_->disk());
    alarm_keeper_->restore(now);
  } else {
    teller_.emplace(alarms_->book(), *gateway_, wall_clock);
    announcer_.emplace(*settings_, "simulated", gateway_->nodes(), gateway_->readings(),
                       *company_.broker);
  }
  if (company_.board != nullptr) {
    board_.emplace(*company_.board,
                   firmware::BoardLines{.alert = BoardWorld::alert,
                                        .join_button = BoardWorld::button,
                                        .status_led = BoardWorld::lamp,
                                        .watchdog = BoardWorld::watchdog},
                   *gateway_);
  }
}

std::shared_ptr<const firmware::Settings> GatewayRun::read(const std::string& path) {
  std::vector<std::string> mistakes;
  auto settings =
      std::make_shared<firmware::Settings>(firmware::read_configuration(path, nullptr, mistakes));
  if (!mistakes.empty()) throw std::runtime_error("the settings are refused: " + mistakes.front());
  return settings;
}

// Those of the settings from this one on.
std::vector<firmware::PolledBus> GatewayRun::open_buses(std::size_t first) {
  std::vector<firmware::PolledBus> opened;
  for (std::size_t i = first; i < settings_->buses.size(); ++i) {
    const firmware::BusSettings& bus = settings_->buses[i];
    BusClients* const clients = i < company_.clients.size() ? company_.clients[i] : nullptr;
    if (site_.buses[i].line) {
      port::RtuBusOptions options{.name = bus.name,
                                  .serial_line = {},
                                  .clearing = bus.timeout + port::late_answer_max,
                                  .quiet = bus.quiet,
                                  .reopen_interval = 1s};
      if (const auto* const line = std::get_if<port::SerialLine>(&bus.link)) {
        options.serial_line = *line;
      } else {
        // As the program has it: what a server still passes on.
        options.quiet = 50ms;
        options.address = to_string(std::get<port::Endpoint>(bus.link));
      }
      lines_.push_back(std::make_unique<port::RtuBus>(*site_.buses[i].line, events_, options));
      opened.push_back({.bus = lines_.back().get(), .settings = &bus, .clients = clients});
    } else {
      connections_.push_back(
          std::make_unique<port::TcpBus>(*site_.buses[i].converter, events_,
                                         port::TcpBusOptions{.name = bus.name,
                                                             .end = {},
                                                             .outstanding_max = bus.outstanding_max,
                                                             .reconnect_interval = 1s}));
      opened.push_back({.bus = connections_.back().get(), .settings = &bus, .clients = clients});
    }
  }
  return opened;
}

bool GatewayRun::reload(Instant now) {
  std::shared_ptr<const firmware::Settings> next =
      firmware::reload(site_.path(), *settings_, nullptr, events_, refusal_);
  if (next == nullptr) return false;
  const std::size_t known = settings_->buses.size();
  settings_ = std::move(next);
  const std::vector<firmware::PolledBus> added = open_buses(known);
  gateway_->update_settings(settings_, added, now);
  if (edge_node_) edge_node_->update_settings(gateway_->settings());
  if (announcer_) announcer_->update_settings(gateway_->settings());
  return true;
}

// In the order in which the program has them.
void GatewayRun::step(Instant now) {
  if (board_) board_->step(now);
  if (company_.broker != nullptr) company_.broker->step(now);
  if (company_.sparkplug != nullptr) company_.sparkplug->step(now);
  gateway_->step(now);
  if (edge_node_) edge_node_->step(now);
  const firmware::FleetReport* const fleet = gateway_->fleet();
  if (announcer_ && fleet != nullptr) {
    announcer_->step(now, {.has_told_all = fleet->has_told_all,
                           .other_refused_count = fleet->other_refused_count});
  }
  if (alarms_->next_deadline() <= now) alarms_->step(now);
  if (teller_ && teller_->next_deadline() <= now) teller_->step(now);
  if (alarm_keeper_) alarm_keeper_->step(now);
  page_->advance(now);
}

Instant GatewayRun::next_deadline() const {
  Instant next =
      std::min({gateway_->next_deadline(), alarms_->next_deadline(), page_->next_deadline()});
  if (board_) next = std::min(next, board_->next_deadline());
  if (edge_node_) next = std::min(next, edge_node_->next_deadline());
  if (announcer_) next = std::min({next, announcer_->next_deadline(), teller_->next_deadline()});
  return next;
}

void GatewayRun::finish(Instant now) {
  gateway_->finish(now);
  gateway_->finish_saving(now);
  if (!alarm_keeper_) return;
  site_.disk_of_alarms.wait();
  alarm_keeper_->finish(now);
  site_.disk_of_alarms.wait();
}

}  // namespace etcm::simulation

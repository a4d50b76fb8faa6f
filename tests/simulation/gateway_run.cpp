#include "gateway_run.h"

#include <algorithm>
#include <array>
#include <cstdio>
#include <cstdlib>
#include <nlohmann/json.hpp>

#include "etcm/config.h"

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
                       const port::WallClock& wall_clock, std::uint64_t number)
    : settings_(std::make_shared<const firmware::Settings>(site.settings)),
      told_(clock),
      events_(clock, told_) {
  for (std::size_t i = 0; i < site.buses.size(); ++i) {
    const firmware::BusSettings& bus = settings_->buses[i];
    if (site.buses[i].line) {
      lines_.push_back(std::make_unique<port::RtuBus>(
          *site.buses[i].line, events_,
          port::RtuBusOptions{.name = bus.name,
                              .serial_line = std::get<port::SerialLine>(bus.link),
                              .clearing = bus.timeout + port::late_answer_max,
                              .quiet = bus.quiet,
                              .reopen_interval = 1s}));
      polled_.push_back({.bus = lines_.back().get(), .settings = &bus});
    } else {
      connections_.push_back(
          std::make_unique<port::TcpBus>(*site.buses[i].converter, events_,
                                         port::TcpBusOptions{.name = bus.name,
                                                             .end = {},
                                                             .outstanding_max = bus.outstanding_max,
                                                             .reconnect_interval = 1s}));
      polled_.push_back({.bus = connections_.back().get(), .settings = &bus});
    }
  }
  memory_.resize(storage_bytes(settings_->mesh));
  static_cast<void>(mesh_.open(memory_, settings_->mesh));
  gateway_ = std::make_unique<firmware::Gateway>(settings_, mesh_,
                                                 firmware::GatewayPorts{.buses = polled_,
                                                                        .server = masters_,
                                                                        .files = &site.folder,
                                                                        .store = &site.disk,
                                                                        .clock = clock,
                                                                        .wall_clock = &wall_clock,
                                                                        .log = events_,
                                                                        .run = number,
                                                                        .version = "simulated"});
  const Instant now = clock.now();
  gateway_->restore(now);
  alarms_.emplace(firmware::AlarmSources{.gateway = *gateway_,
                                         .masters = counters_,
                                         .readers = nullptr,
                                         .refusal = no_refusal_,
                                         .started_at = now});
  counters_.is_listening = true;
  page_.emplace(firmware::StatusSources{.gateway = *gateway_,
                                        .events = events_,
                                        .alarms = alarms_->book(),
                                        .wall_clock = wall_clock,
                                        .masters = counters_,
                                        .readers = counters_,
                                        .version = "simulated",
                                        .started_at = now},
                2);
}

void GatewayRun::step(Instant now) {
  gateway_->step(now);
  if (alarms_->next_deadline() <= now) alarms_->step(now);
}

Instant GatewayRun::next_deadline() const {
  return std::min(gateway_->next_deadline(), alarms_->next_deadline());
}

void GatewayRun::finish(Instant now) {
  gateway_->finish(now);
  gateway_->finish_saving(now);
}

std::string GatewayRun::read_page(std::string_view path) {
  const port::WebAnswer answer = page_->begin(0, path);
  std::string text;
  std::array<char, 4096> piece;
  while (const std::size_t size = page_->read(0, piece)) text.append(piece.data(), size);
  page_->end(0);
  if (answer.status != 200 && answer.status != 503) {
    return std::string(path) + " answers " + std::to_string(answer.status);
  }
  if (path.find("json") != std::string_view::npos && !nlohmann::json::accept(text)) {
    return std::string(path) + " is no JSON";
  }
  return {};
}

}  // namespace etcm::simulation

#include "gateway_run.h"

#include <algorithm>
#include <array>
#include <cstdio>
#include <cstdlib>
#include <nlohmann/json.hpp>
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
                       const port::WallClock& wall_clock, std::uint64_t number)
    : site_(site), settings_(read(site.path())), told_(clock), events_(clock, told_) {
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
                                                                        .run = number,
                                                                        .version = "simulated"});
  const Instant now = clock.now();
  gateway_->restore(now);
  alarms_.emplace(firmware::AlarmSources{.gateway = *gateway_,
                                         .masters = counters_,
                                         .readers = nullptr,
                                         .refusal = refusal_,
                                         .started_at = now});
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
                2);
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
      opened.push_back({.bus = lines_.back().get(), .settings = &bus});
    } else {
      connections_.push_back(
          std::make_unique<port::TcpBus>(*site_.buses[i].converter, events_,
                                         port::TcpBusOptions{.name = bus.name,
                                                             .end = {},
                                                             .outstanding_max = bus.outstanding_max,
                                                             .reconnect_interval = 1s}));
      opened.push_back({.bus = connections_.back().get(), .settings = &bus});
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
  return true;
}

void GatewayRun::step(Instant now) {
  gateway_->step(now);
  if (alarms_->next_deadline() <= now) alarms_->step(now);
  page_->advance(now);
}

Instant GatewayRun::next_deadline() const {
  return std::min({gateway_->next_deadline(), alarms_->next_deadline(), page_->next_deadline()});
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

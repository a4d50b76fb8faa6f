// One run of the gateway's program, from its start to its end or its power failure: all that
// main() puts together but sockets, files and time.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "firmware/alarms/alarm_watch.h"
#include "firmware/gateway/gateway.h"
#include "firmware/status/recent_events.h"
#include "firmware/status/status_page.h"
#include "modbus/rtu_bus.h"
#include "modbus/tcp_bus.h"
#include "site_world.h"

namespace etcm::simulation {

class SimulatedClock final : public port::Clock {
 public:
  Instant now() const override { return now_; }
  void pass_to(Instant now) { now_ = now; }

 private:
  Instant now_{std::chrono::hours(1)};
};

// Tells the lines where somebody wants to read them.
class TellingLog final : public port::Log {
 public:
  explicit TellingLog(const port::Clock& clock);
  void write(port::Level level, std::string_view line) override;

 private:
  const port::Clock& clock_;
  const bool tells_;
};

class MastersWorld final : public port::MeshServer {
 public:
  void publish(std::shared_ptr<const port::RegisterImage> image) override {
    last = std::move(image);
    ++count;
  }
  std::shared_ptr<const port::RegisterImage> last;
  std::uint64_t count = 0;
};

class GatewayRun {
 public:
  // Throws std::runtime_error where it refuses its settings.
  GatewayRun(SiteWorld& site, const SimulatedClock& clock, const port::WallClock& wall_clock,
             std::uint64_t number);
  GatewayRun(const GatewayRun&) = delete;
  GatewayRun& operator=(const GatewayRun&) = delete;

  void step(Instant now);
  Instant next_deadline() const;
  // Somebody sends SIGHUP. Whether the settings were taken over.
  bool reload(Instant now);
  // Why those that stand there were not; empty: they were.
  const std::string& refusal() const { return refusal_; }
  void finish(Instant now);
  // A person or a program reads something of the page. What is wrong with it, or nothing.
  std::string read_page(std::string_view path);

  firmware::Gateway& gateway() { return *gateway_; }
  const Mesh& mesh() const { return mesh_; }
  const MastersWorld& masters() const { return masters_; }
  const firmware::AlarmWatch& alarms() const { return *alarms_; }

 private:
  static std::shared_ptr<const firmware::Settings> read(const std::string& path);
  std::vector<firmware::PolledBus> open_buses(std::size_t first);

  SiteWorld& site_;
  std::shared_ptr<const firmware::Settings> settings_;
  TellingLog told_;
  firmware::RecentEvents events_;
  std::vector<std::unique_ptr<port::RtuBus>> lines_;
  std::vector<std::unique_ptr<port::TcpBus>> connections_;
  std::vector<std::byte> memory_;
  Mesh mesh_;
  MastersWorld masters_;
  port::ServiceCounters counters_;
  std::string refusal_;
  std::unique_ptr<firmware::Gateway> gateway_;
  std::optional<firmware::AlarmWatch> alarms_;
  std::optional<firmware::StatusPage> page_;
};

}  // namespace etcm::simulation

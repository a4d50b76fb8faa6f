// One run of the gateway's program, from its start to its end or its power failure: all that
// main() puts together but sockets, files and time.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "board_world.h"
#include "bus_clients.h"
#include "firmware/alarms/alarm_keeper.h"
#include "firmware/alarms/alarm_teller.h"
#include "firmware/alarms/alarm_watch.h"
#include "firmware/gateway/board_io.h"
#include "firmware/gateway/gateway.h"
#include "firmware/home_assistant/announcer.h"
#include "firmware/sparkplug/edge_node.h"
#include "firmware/status/recent_events.h"
#include "firmware/status/status_page.h"
#include "fleet/broker_model.h"
#include "masters_world.h"
#include "modbus/rtu_bus.h"
#include "modbus/tcp_bus.h"
#include "page_readers.h"
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

// What of a site is there for one run of its program, where there are others.
struct GatewayCompany {
  test::ModelClient* broker = nullptr;
  test::ModelClient* sparkplug = nullptr;  // has a broker then
  BoardWorld* board = nullptr;
  std::vector<BusClients*> clients{};  // by bus
};

class GatewayRun {
 public:
  // Throws std::runtime_error where it refuses its settings.
  GatewayRun(SiteWorld& site, const SimulatedClock& clock, const port::WallClock& wall_clock,
             std::uint64_t number, GatewayCompany company);
  GatewayRun(const GatewayRun&) = delete;
  GatewayRun& operator=(const GatewayRun&) = delete;

  void step(Instant now);
  Instant next_deadline() const;
  // Somebody sends SIGHUP. Whether the settings were taken over.
  bool reload(Instant now);
  // Why those that stand there were not; empty: they were.
  const std::string& refusal() const { return refusal_; }
  void finish(Instant now);
  firmware::Gateway& gateway() { return *gateway_; }
  const Mesh& mesh() const { return mesh_; }
  MastersWorld& masters() { return masters_; }
  PageReaders& readers() { return *readers_; }
  const firmware::AlarmBook& alarms() const { return alarms_->book(); }

 private:
  static std::shared_ptr<const firmware::Settings> read(const std::string& path);
  std::vector<firmware::PolledBus> open_buses(std::size_t first);

  void open_sparkplug(const port::WallClock& wall_clock);
  void open_alarms(const port::WallClock& wall_clock, Instant now);

  SiteWorld& site_;
  const GatewayCompany company_;
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
  std::optional<firmware::AlarmKeeper> alarm_keeper_;
  std::optional<firmware::AlarmTeller> teller_;
  std::optional<firmware::Announcer> announcer_;
  std::optional<firmware::sparkplug::EdgeNode> edge_node_;
  std::optional<firmware::BoardIo> board_;
  std::optional<firmware::StatusPage> page_;
  std::optional<PageReaders> readers_;
};

}  // namespace etcm::simulation

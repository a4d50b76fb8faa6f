// All parts of the gateway and their adapters, put together and run.
#pragma once

#include <cstddef>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <variant>
#include <vector>

#include "etcm/mesh.h"
#include "etcm/port/service_counters.h"
#include "firmware/app/board.h"
#include "firmware/app/broker_link.h"
#include "firmware/app/integrations.h"
#include "firmware/app/operator_desk.h"
#include "firmware/app/port_report.h"
#include "firmware/app/shared_lines.h"
#include "firmware/app/web.h"
#include "firmware/config/settings.h"
#include "firmware/gateway/board_io.h"
#include "firmware/gateway/gateway.h"
#include "firmware/gateway/service_watch.h"
#include "firmware/status/recent_events.h"
#include "modbus/register_server.h"
#include "modbus/rtu_bus.h"
#include "modbus/rtu_tcp_line.h"
#include "modbus/tcp_bus.h"
#include "posix/background_store.h"
#include "posix/event_loop.h"
#include "posix/mesh_folder.h"
#include "posix/signal_watch.h"
#include "posix/stop_signal.h"
#include "posix/system_wall_clock.h"
#include "posix/systemd_notify.h"

namespace etcm::firmware {

class Program {
 public:
  // `config` is where a reload finds the settings, `projections` whence it has projections, if not
  // null. `log` leaves out what repeats; `events` writes
  // each line. Throws std::runtime_error where something is wrong that cannot be tried again.
  Program(std::string config, std::shared_ptr<const Settings> settings,
          port::ProjectionSource* projections, const port::Clock& clock, port::Log& log,
          RecentEvents& events);

  // Until SIGTERM or SIGINT.
  void run();

 private:
  using Bus = std::variant<std::unique_ptr<port::TcpBus>, std::unique_ptr<port::RtuBus>>;

  Bus make_bus(const BusSettings& bus, port::Duration retry_interval);
  void open_mesh();
  void open_disks();
  std::vector<PolledBus> open_buses(std::size_t first);
  void make_gateway(std::span<const PolledBus> buses);
  void open_desk();
  void reload_settings();
  port::Instant next_deadline() const;
  void finish();

  const std::string config_;
  const std::string config_place_;  // the same, wherever who asks for it is
  std::shared_ptr<const Settings> settings_;
  port::ProjectionSource* const projections_;
  const port::Clock& clock_;
  const port::SystemWallClock wall_clock_;
  port::Log& log_;
  RecentEvents& events_;
  port::EventLoop loop_;
  port::StopSignal stop_;
  port::SignalWatch reread_;
  port::Instant reload_due_{};
  std::vector<std::string> needs_restart_;  // keys of the settings that were changed
  std::string refusal_;            // of the configuration, since it was changed to what is wrong
  std::vector<std::byte> memory_;  // all that the mesh ever has
  Mesh mesh_;
  Board board_;
  std::vector<std::unique_ptr<port::RtuTcpLine>> tcp_lines_;  // of buses with RTU frames over TCP
  std::vector<Bus> buses_;
  SharedLines shared_lines_;
  port::RegisterServer server_;
  PortReport server_report_;
  std::unique_ptr<port::MeshFolder> folder_;
  std::unique_ptr<port::BackgroundStore> store_;
  BrokerLink broker_;
  std::optional<Gateway> gateway_;
  std::optional<Integrations> integrations_;
  std::optional<BoardIo> board_io_;
  port::ServiceCounters readers_;
  std::optional<OperatorDesk> desk_;
  std::optional<Web> web_;
  port::SystemdNotify manager_;
  std::optional<ServiceWatch> watch_;
};

}  // namespace etcm::firmware

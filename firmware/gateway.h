// The gateway: nodes are polled, the mesh follows them, and each state of it is published.
//
// Everything that changed between two publications is one generation: a node that joins on its own
// has a generation of its own, and a burst of them shares one, publish_pause apart from the next.
// No input or output of its own, no waiting: whoever runs it calls step() when bytes have arrived
// or next_deadline() is reached.
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "etcm/port/clock.h"
#include "etcm/port/log.h"
#include "etcm/port/mesh_files.h"
#include "etcm/port/mesh_server.h"
#include "mesh_keeper.h"
#include "poller.h"
#include "roster.h"
#include "settings.h"
#include "snapshot.h"

namespace etcm::firmware {

// Least time between two publications.
inline constexpr port::Duration publish_pause = std::chrono::milliseconds(100);

struct GatewayPorts {
  std::span<const PolledBus> buses;
  port::MeshServer& server;
  port::MeshFiles* files = nullptr;  // null: no files are wanted
  const port::Clock& clock;
  port::Log& log;
};

class Gateway final : private ReadingListener {
 public:
  // The mesh is open and empty. All arguments must outlive the gateway.
  Gateway(const Settings& settings, Mesh& mesh, const GatewayPorts& ports);

  void step(port::Instant now);
  port::Instant next_deadline() const;

  // Publishes what is still unpublished, and says how things stand.
  void finish(port::Instant now);

  // Asks the units with this address next: somebody says that a node is there.
  void ask_at_once(std::uint8_t address, port::Instant now) { poller_.ask_at_once(address, now); }

  std::uint32_t generation() const { return generation_; }
  std::uint32_t node_count() const { return keeper_.mesh().node_count(); }
  // As published last (snapshot.h).
  std::uint16_t state() const { return state_; }

 private:
  bool on_reading(std::uint32_t unit, const NodeReading& reading, port::Instant now) override;
  NodeRecord* record_of(std::uint32_t unit, std::uint32_t serial);
  void disbelieve(std::uint32_t unit, std::uint32_t serial, const std::string& why);
  void place(NodeRecord& node);
  void sweep_silent(port::Instant now);
  void publish(port::Instant now);
  void write_files(port::Instant now);
  Snapshot take_snapshot(port::Instant now) const;
  port::Instant files_due() const;

  const Settings& settings_;
  const GatewayPorts ports_;
  Poller poller_;
  Roster roster_;
  std::vector<std::uint32_t> disbelieved_;  // by unit: the serial that was not believed last
  MeshKeeper keeper_;
  port::Duration sweep_interval_;
  port::Instant sweep_due_{};
  port::Instant published_at_{};
  port::Instant files_tried_at_{};
  std::uint32_t generation_ = 0;  // published last
  std::uint16_t state_ = 0;
  bool changed_ = false;  // since then
  bool files_outdated_ = false;
  bool files_failing_ = false;
};

// The image a server has before the first generation.
std::shared_ptr<const port::RegisterImage> empty_image(const Settings& settings);

}  // namespace etcm::firmware

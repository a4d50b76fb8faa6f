// What operators have on this machine: the alarms, over restarts, and a socket to say something.
#pragma once

#include <memory>
#include <optional>
#include <string>

#include "etcm/port/log.h"
#include "etcm/port/wall_clock.h"
#include "firmware/alarms/alarm_keeper.h"
#include "firmware/alarms/alarm_teller.h"
#include "firmware/alarms/alarm_watch.h"
#include "firmware/config/settings.h"
#include "firmware/control/control.h"
#include "posix/background_store.h"
#include "posix/command_socket.h"
#include "posix/event_loop.h"

namespace etcm::firmware {

// Where the gateway takes commands; empty: nowhere.
std::string control_socket_of(const Settings& settings);

class OperatorDesk {
 public:
  // All but `settings` must outlive this. Restores the alarms of an earlier run.
  OperatorDesk(const Settings& settings, const AlarmSources& sources,
               const port::WallClock& wall_clock, port::Log& log);

  const AlarmBook& alarms() const { return watch_.book(); }
  // Null where they are not saved.
  const DiskWriter* disk_of_alarms() const { return keeper_ ? &keeper_->disk() : nullptr; }

  // Tells the alarms, and takes commands from now on, where the settings have a place for it.
  // `sources` has these alarms.
  void open(const Settings& settings, Gateway& gateway, const StatusSources& sources,
            port::EventLoop& loop);

  void step(port::Instant now);
  port::Instant next_deadline() const;
  // Saves what is not saved. Returns within `patience`.
  void finish(port::Instant now, port::Duration patience);

 private:
  port::Log& log_;
  AlarmWatch watch_;
  std::unique_ptr<port::BackgroundStore> store_;
  std::optional<AlarmKeeper> keeper_;
  std::optional<AlarmTeller> teller_;
  std::optional<Control> control_;
  std::optional<port::CommandSocket> socket_;
};

}  // namespace etcm::firmware

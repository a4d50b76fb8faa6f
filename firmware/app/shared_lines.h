// The servers by which others use the buses, those that the settings share.
#pragma once

#include <cstddef>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "etcm/port/log.h"
#include "firmware/app/port_report.h"
#include "firmware/config/settings.h"
#include "modbus/line_share.h"
#include "posix/event_loop.h"

namespace etcm::firmware {

class SharedLines {
 public:
  // `loop` and `log` must outlive this.
  SharedLines(const std::vector<BusSettings>& buses, port::EventLoop& loop, port::Log& log);

  // Other settings of the same buses, and more behind them.
  void update(const std::vector<BusSettings>& buses);

  port::LineClients& clients(std::size_t bus) { return *lines_[bus].share; }

  void step(port::Instant now);
  port::Instant next_deadline() const;

 private:
  struct Line {
    std::string name;
    std::unique_ptr<port::LineShare> share;
    std::optional<port::SocketAddress> listen;
    std::optional<PortReport> report;
  };
  void update(Line& line, const ShareSettings& settings);

  port::EventLoop& loop_;
  port::Log& log_;
  std::vector<Line> lines_;  // by bus
};

}  // namespace etcm::firmware

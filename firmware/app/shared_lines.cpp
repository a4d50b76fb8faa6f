#include "firmware/app/shared_lines.h"

#include <algorithm>
#include <utility>

namespace etcm::firmware {

namespace {

port::LineShareSettings share_settings(const ShareSettings& settings) {
  port::LineShareSettings share{.listen = settings.listen,
                                .allow = settings.allow,
                                .rules = {.units = {}, .may_write = settings.writes},
                                .wait_max = settings.wait_max};
  for (const UnitRange range : settings.units) {
    for (const ModbusAddress unit : range) share.rules.units.set(unit.value);
  }
  return share;
}

}  // namespace

SharedLines::SharedLines(const std::vector<BusSettings>& buses, port::EventLoop& loop,
                         port::Log& log)
    : loop_(loop), log_(log) {
  update(buses);
}

void SharedLines::update(const std::vector<BusSettings>& buses) {
  for (std::size_t i = 0; i < buses.size(); ++i) {
    if (i == lines_.size()) {
      lines_.push_back({.name = buses[i].name,
                        .share = std::make_unique<port::LineShare>(loop_, log_, buses[i].name),
                        .listen = {},
                        .report = {}});
    }
    update(lines_[i], buses[i].share);
  }
}

void SharedLines::update(Line& line, const ShareSettings& settings) {
  if (line.listen != settings.listen) line.report.reset();
  line.share->update(share_settings(settings));
  if (line.report) line.report->allow(settings.allow);
  if (std::exchange(line.listen, settings.listen) == settings.listen) return;
  if (!settings.listen) {
    log_.write(port::Level::info, "bus " + line.name + ": is shared no more");
    return;
  }
  line.report.emplace(*line.share->acceptor(),
                      PortMessages{.key = "`share` of bus " + line.name,
                                   .served = "shares bus " + line.name + " on ",
                                   .missing = "bus " + line.name + " is not shared"},
                      settings.allow, log_);
  line.report->step();
}

void SharedLines::step(port::Instant now) {
  for (Line& line : lines_) {
    line.share->advance(now);
    if (line.report) line.report->step();
  }
}

port::Instant SharedLines::next_deadline() const {
  port::Instant deadline = port::never;
  for (const Line& line : lines_) deadline = std::min(deadline, line.share->next_deadline());
  return deadline;
}

}  // namespace etcm::firmware

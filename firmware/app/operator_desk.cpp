#include "firmware/app/operator_desk.h"

#include <algorithm>
#include <cstdlib>

namespace etcm::firmware {

namespace {

// For some hundred alarms; more than that take memory when they are saved.
constexpr std::size_t usual_book_size = std::size_t{64} * 1024;

}  // namespace

std::string control_socket_of(const Settings& settings) {
  if (!settings.control.socket.empty()) return settings.control.socket;
  const char* const folder = std::getenv("RUNTIME_DIRECTORY");
  return folder == nullptr || *folder == '\0' ? "" : std::string(folder) + "/control";
}

OperatorDesk::OperatorDesk(const Settings& settings, const AlarmSources& sources,
                           const port::WallClock& wall_clock, port::Log& log)
    : log_(log), watch_(sources) {
  if (!settings.state) return;
  store_ = std::make_unique<port::BackgroundStore>(settings.state->folder + "/alarms",
                                                   usual_book_size, log);
  keeper_.emplace(watch_.book(), *store_, wall_clock, log);
  watch_.watch_disk_of_alarms(keeper_->disk());
  keeper_->restore(sources.started_at);
}

void OperatorDesk::open(const Settings& settings, Gateway& gateway, const StatusSources& sources,
                        port::EventLoop& loop) {
  teller_.emplace(watch_.book(), gateway, sources.wall_clock);
  const std::string path = control_socket_of(settings);
  if (path.empty()) return;
  control_.emplace(gateway, watch_.book(), sources, log_);
  socket_.emplace(loop, path, *control_, log_);
}

void OperatorDesk::step(port::Instant now) {
  watch_.step(now);
  if (teller_) teller_->step(now);
  if (keeper_) keeper_->step(now);
  if (!socket_) return;
  control_->advance(now);
  socket_->advance(now);
}

port::Instant OperatorDesk::next_deadline() const {
  port::Instant deadline = watch_.next_deadline();
  if (teller_) deadline = std::min(deadline, teller_->next_deadline());
  if (keeper_) deadline = std::min(deadline, keeper_->next_deadline());
  if (socket_) {
    deadline = std::min({deadline, control_->next_deadline(), socket_->next_deadline()});
  }
  return deadline;
}

void OperatorDesk::finish(port::Instant now, port::Duration patience) {
  if (!keeper_ || !store_->wait(patience)) return;
  keeper_->finish(now);
  static_cast<void>(store_->wait(patience));
}

}  // namespace etcm::firmware

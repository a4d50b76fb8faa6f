#include "firmware/gateway/service_watch.h"

#include <algorithm>
#include <array>
#include <cinttypes>
#include <cstdio>
#include <utility>

namespace etcm::firmware {

ServiceWatch::ServiceWatch(port::ServiceManager& manager, const Gateway& gateway,
                           const WatchedServers& servers, const std::string& refusal,
                           port::Log& log)
    : manager_(manager),
      gateway_(gateway),
      servers_(servers),
      refusal_(refusal),
      log_(log),
      // Twice in the time it has, as sd_watchdog_enabled(3) advises.
      feed_interval_(manager.watchdog_timeout() / 2) {}

void ServiceWatch::ready(port::Instant now) {
  manager_.tell(port::ServiceEvent::ready);
  tell_status(now);
  if (feed_interval_ > port::Duration{}) feed_due_ = now;
}

void ServiceWatch::step(port::Instant now) {
  if (feed_due_ <= now) feed(now);
  if (status_due_ <= now && has_news()) tell_status(now);
}

port::Instant ServiceWatch::next_deadline() const {
  return std::min(feed_due_, has_news() ? status_due_ : port::never);
}

bool ServiceWatch::has_news() const {
  return gateway_.generation() != delivered_generation_ || what_is_missing() != told_missing_;
}

// As it ends the status; with an end of its own, for printf().
std::string_view ServiceWatch::what_is_missing() const {
  if (!servers_.masters.is_listening) return "; nobody can read the mesh: see the log";
  if (!servers_.readers.is_listening) return "; no status page: see the log";
  return refusal_.empty() ? "" : "; the changed configuration is refused: see the log";
}

void ServiceWatch::feed(port::Instant now) {
  // While it starves it may recover, and is then fed at once.
  feed_due_ = now + (is_starving_ ? std::min<port::Duration>(feed_interval_, status_interval)
                                  : feed_interval_);
  const std::string stall = what_stalls(now);
  if (stall.empty()) {
    manager_.tell(port::ServiceEvent::alive);
    is_starving_ = false;
  } else if (!std::exchange(is_starving_, true)) {
    log_.write(port::Level::error, "the watchdog is not fed: " + stall);
  }
}

// Empty while everything makes progress.
std::string ServiceWatch::what_stalls(port::Instant now) const {
  const Poller& poller = gateway_.poller();
  for (BusIndex bus{0}; bus.value < poller.bus_count(); ++bus.value) {
    if (!poller.is_stalled(bus, now, feed_interval_)) continue;
    return "bus " + poller.bus(bus).name + " neither asks nor hears anything, though units are due";
  }
  if (gateway_.is_late(now, feed_interval_)) return "a changed mesh is not published";
  return "";
}

void ServiceWatch::tell_status(port::Instant now) {
  status_due_ = now + status_interval;
  delivered_generation_ = gateway_.generation();
  told_missing_ = what_is_missing();
  const Snapshot& snapshot = gateway_.snapshot();
  std::array<char, 300> text{};
  const int size = std::snprintf(
      text.data(), text.size(),
      "generation %" PRIu32 ": %" PRIu32 " nodes, %" PRIu32 " stale, %" PRIu32 " missing, %" PRIu32
      " refused, %" PRIu32 " of %" PRIu32 " features, %" PRIu32 " Steiner vertices%s",
      snapshot.generation, snapshot.node_count, snapshot.stale_count, snapshot.missing_count,
      snapshot.quarantined_count, snapshot.features_active, snapshot.features_configured,
      snapshot.steiner_count, told_missing_.data());
  manager_.tell_status({text.data(), static_cast<std::size_t>(size)});
}

}  // namespace etcm::firmware

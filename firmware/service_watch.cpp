#include "service_watch.h"

#include <algorithm>
#include <array>
#include <cinttypes>
#include <cstdio>
#include <utility>

namespace etcm::firmware {

ServiceWatch::ServiceWatch(port::ServiceManager& manager, const Gateway& gateway, port::Log& log)
    : manager_(manager),
      gateway_(gateway),
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
  if (status_due_ <= now && gateway_.generation() != told_generation_) tell_status(now);
}

port::Instant ServiceWatch::next_deadline() const {
  const bool has_news = gateway_.generation() != told_generation_;
  return std::min(feed_due_, has_news ? status_due_ : port::never);
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
  for (std::uint32_t bus = 0; bus < poller.bus_count(); ++bus) {
    if (!poller.is_stalled(bus, now, feed_interval_)) continue;
    return "bus " + poller.bus(bus).name + " neither asks nor hears anything, though units are due";
  }
  if (gateway_.is_late(now, feed_interval_)) return "a changed mesh is not published";
  return "";
}

void ServiceWatch::tell_status(port::Instant now) {
  status_due_ = now + status_interval;
  told_generation_ = gateway_.generation();
  const Snapshot& snapshot = gateway_.snapshot();
  std::array<char, 200> text{};
  const int size = std::snprintf(
      text.data(), text.size(),
      "generation %" PRIu32 ": %" PRIu32 " nodes, %" PRIu32 " stale, %" PRIu32 " refused, %" PRIu32
      " of %" PRIu32 " features, %" PRIu32 " Steiner vertices",
      snapshot.generation, snapshot.node_count, snapshot.stale_count, snapshot.quarantined_count,
      snapshot.features_active, snapshot.features_configured, snapshot.steiner_count);
  manager_.tell_status({text.data(), static_cast<std::size_t>(size)});
}

}  // namespace etcm::firmware

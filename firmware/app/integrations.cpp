#include "firmware/app/integrations.h"

#include <algorithm>

namespace etcm::firmware {

Integrations::Integrations(const Settings& settings, std::string_view version,
                           const Gateway& gateway, BrokerLink& link,
                           [[maybe_unused]] const port::WallClock& clock)
    : gateway_(gateway), plane_(settings.site.plane()) {
#ifdef ETCM_WITH_SPARKPLUG
  if (port::MessageBroker* const broker = link.sparkplug()) {
    edge_node_.emplace(
        sparkplug::EdgeNodeNames{.group = settings.mqtt->sparkplug,
                                 .edge_node = settings.mqtt->name},
        settings, settings.mqtt->period_min,
        sparkplug::Sources{
            .nodes = gateway.nodes(), .mesh = gateway.snapshot(), .readings = gateway.readings()},
        *broker, clock);
  }
#endif
  if (link.broker() != nullptr && !settings.mqtt->home_assistant.empty()) {
    announcer_.emplace(settings, version, gateway.nodes(), gateway.readings(), *link.broker());
  }
}

void Integrations::update_settings(const Settings& settings) {
  plane_ = settings.site.plane();
#ifdef ETCM_WITH_SPARKPLUG
  if (edge_node_) edge_node_->update_settings(settings);
#endif
  if (announcer_) announcer_->update_settings(settings);
}

void Integrations::follow_plane() {
  if (gateway_.settings().site.plane() != plane_) update_settings(gateway_.settings());
}

void Integrations::step(port::Instant now) {
  follow_plane();
#ifdef ETCM_WITH_SPARKPLUG
  if (edge_node_) edge_node_->step(now);
#endif
  const FleetReport* const fleet = gateway_.fleet();
  if (announcer_ && fleet != nullptr) {
    announcer_->step(now, {.has_told_all = fleet->has_told_all,
                           .other_refused_count = fleet->other_refused_count});
  }
}

port::Instant Integrations::next_deadline() const {
  port::Instant deadline = announcer_ ? announcer_->next_deadline() : port::never;
#ifdef ETCM_WITH_SPARKPLUG
  if (edge_node_) deadline = std::min(deadline, edge_node_->next_deadline());
#endif
  return deadline;
}

}  // namespace etcm::firmware

// Other systems that are told of the nodes through the broker, those that the settings name: hosts
// of Sparkplug, and Home Assistant.
#pragma once

#include <optional>
#include <string_view>

#include "etcm/port/clock.h"
#include "etcm/port/wall_clock.h"
#include "firmware/app/broker_link.h"
#include "firmware/config/settings.h"
#include "firmware/gateway/gateway.h"
#include "firmware/home_assistant/announcer.h"
#ifdef ETCM_WITH_SPARKPLUG
#include "firmware/sparkplug/edge_node.h"
#endif

namespace etcm::firmware {

class Integrations {
 public:
  // All but the settings must outlive this. REQUIRES: nothing is lacking() (broker_link.h).
  Integrations(const Settings& settings, std::string_view version, const Gateway& gateway,
               BrokerLink& link, const port::WallClock& clock);

  // After the gateway has taken them over.
  void update_settings(const Settings& settings);

  // Takes over another plane of the site too, where the gateway has that from the fleet by now.
  void step(port::Instant now);
  port::Instant next_deadline() const;

 private:
  void follow_plane();

  const Gateway& gateway_;
  SitePlane plane_;  // that they know
#ifdef ETCM_WITH_SPARKPLUG
  std::optional<sparkplug::EdgeNode> edge_node_;
#endif
  std::optional<Announcer> announcer_;
};

}  // namespace etcm::firmware

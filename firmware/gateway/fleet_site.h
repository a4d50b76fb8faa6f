// Which site a gateway of a fleet works with: that of its own file, or the fleet's.
//
// A site is features, anchors and the domain. The one that holds for all is one document
// (fleet_member.h); it takes the place of the gateway's own in the settings, once it is found to be
// as good as a site file has to be.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <utility>

#include "etcm/port/log.h"
#include "etcm/port/projection.h"
#include "firmware/config/settings.h"
#include "firmware/fleet/fleet_member.h"

namespace etcm::firmware {

class FleetSite {
 public:
  using Pointer = std::shared_ptr<const Settings>;

  // `own`: as the operator has them. `projections` may be null. REQUIRES: own->mqtt.
  FleetSite(Pointer own, port::ProjectionSource* projections, port::Log& log);

  // Settings with the site that was saved, or null: their own is as good. O(what was saved).
  Pointer restored(std::span<const std::byte> saved);
  // What the operator has, to the fleet; after FleetMember::restore(). Once: then it does nothing.
  void begin(FleetMember& member, port::Instant now);
  // Others of the operator.
  void update_settings(Pointer own, FleetMember& member, port::Instant now);
  // FleetListener::on_site()
  std::string take(const SiteDocument& document);

  // The settings that hold, where they are others than at the last call; else null.
  Pointer take_news(const FleetMember& member);

  // What is wrong with the site, and the cure; empty: nothing. What is new goes to the log too.
  const std::string& find_trouble(const FleetMember& member, const FleetStatus& status);

 private:
  bool is_own(const SiteVersion& version) const { return own_ && version.hash == own_hash_; }
  bool is_fit(const SiteDocument& site, const SiteVersion& version);
  void read_own();
  std::string difference(const FleetMember& member) const;

  Pointer settings_;  // the operator's
  port::ProjectionSource* projections_;
  port::Log& log_;
  const bool is_shared_;
  // Of the operator's, where there is one that can be shared.
  std::optional<SiteDocument> own_{};
  std::uint64_t own_hash_ = 0;
  bool has_begun_ = false;  // the fleet has been told of it
  std::string unshared_{};  // why it cannot be shared, or empty
  Pointer foreign_{};       // with the site of another gateway
  SiteVersion foreign_version_{};
  SiteVersion unfit_version_{};  // that holds for others, and is not good here
  std::string unfit_{};          // why, or empty
  Pointer given_;                // by take_news() last
  std::string told_{};           // to the log, of the trouble
  std::string trouble_{};
};

}  // namespace etcm::firmware

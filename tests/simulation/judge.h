// Holds what a gateway says against what is so.
#pragma once

#include <optional>
#include <string>
#include <unordered_map>
#include <vector>

#include "gateway_run.h"
#include "others.h"
#include "site_world.h"

namespace etcm::simulation {

class Judge {
 public:
  explicit Judge(const SiteWorld& site) : site_(site) {}
  void set_others(const Others* others) { others_ = others; }

  // A run has begun: what it restores was judged before.
  void begin(GatewayRun& run, Instant now);
  // One has ended in order: the next one begins with the alarms that are on, if the disk took them.
  void finish(const GatewayRun& run);
  std::string look_at_kept_alarms(const GatewayRun& run);

  // Other times hold from now on: no silence counts before all were asked once.
  void change_settings(Instant now) {
    fresh_from_ = now + site_.running.interval + std::chrono::seconds(10);
    is_to_look_at_places_ = true;
  }

  // What is wrong after a step; empty: nothing.
  std::string look(GatewayRun& run, Instant now);
  // The same once faults have ended, and all had time to be heard.
  std::string look_at_rest(GatewayRun& run);

  std::uint64_t positions = 0;
  std::uint64_t positions_of_others = 0;  // of another make
  std::uint64_t generations = 0;
  std::uint64_t rebuilt = 0;

 private:
  std::string look_at_nodes(GatewayRun& run, Instant now);
  // In another plane too each must be where it said once.
  std::string look_at_places(GatewayRun& run);
  std::string look_for_unknown(GatewayRun& run, Instant now);
  // From when on the gateway knows that it alone is there.
  Instant settled_at(const Device& device, GatewayRun& run) const;
  // Another one answers at its unit, or has, and may not be forgotten.
  bool may_be_two(const Device& device, Instant now) const;
  std::string look_at_foreign(const firmware::NodeRecord& node) const;
  std::string look_at_node(const firmware::NodeRecord& node, GatewayRun& run, Instant now);
  std::string look_at_mesh(GatewayRun& run);
  // Who is missing is told.
  std::string look_at_alarm(const firmware::NodeRecord& node, GatewayRun& run, Instant now);
  std::string look_at_alarms_at_rest(GatewayRun& run);
  std::string compare_with_build(GatewayRun& run);

  struct Seen {
    Instant positioned_at{};
    Instant accepted_at{};  // a position, as the judge saw it; in any run
    // Its answers, when it was declared to be missing, or was alone at its unit; none: it is not.
    std::optional<std::uint32_t> missing_from;
    Instant missing_at = port::never;  // since when, as the judge saw it
    bool is_mixture = false;           // of what two devices have said
    bool was_left_behind = false;      // by a change of the plane
    std::vector<Position> said{};      // what was accepted, the last of it
  };

  const SiteWorld& site_;
  const Others* others_ = nullptr;
  std::unordered_map<std::uint32_t, Seen> seen_;  // by serial
  std::vector<firmware::Alarm> alarms_;           // that were on when the last run ended
  std::uint32_t generation_ = 0;
  bool is_to_look_at_ = false;  // the mesh of that generation
  bool is_to_look_at_places_ = false;
  Instant published_at_{};
  Instant began_{};
  Instant looked_at_{};
  Instant fresh_from_{};
};

}  // namespace etcm::simulation

// Holds what a gateway says against what is so.
#pragma once

#include <map>
#include <string>

#include "gateway_run.h"
#include "site_world.h"

namespace etcm::simulation {

class Judge {
 public:
  explicit Judge(const SiteWorld& site) : site_(site) {}

  // A run has begun: what it restores was judged before.
  void begin(GatewayRun& run, Instant now);

  // What is wrong after a step; empty: nothing.
  std::string look(GatewayRun& run, Instant now);
  // The same once faults have ended, and all had time to be heard.
  std::string look_at_rest(GatewayRun& run);

  std::uint64_t positions = 0;
  std::uint64_t generations = 0;
  std::uint64_t rebuilt = 0;

 private:
  std::string look_at_nodes(GatewayRun& run, Instant now);
  std::string look_at_node(const firmware::NodeRecord& node, GatewayRun& run, Instant now);
  std::string look_at_mesh(GatewayRun& run);
  std::string compare_with_build(GatewayRun& run);

  const SiteWorld& site_;
  std::map<std::uint32_t, Instant> positioned_at_;  // by serial
  std::map<std::uint32_t, Instant> accepted_at_;    // a position, as the judge saw it; in any run
  std::uint32_t generation_ = 0;
  bool is_to_look_at_ = false;  // the mesh of that generation
  Instant published_at_{};
  Instant began_{};
};

}  // namespace etcm::simulation

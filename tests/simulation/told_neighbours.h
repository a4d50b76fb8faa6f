// What nodes are told of their neighbours, against the mesh: whom an edge joins to a node, and whom
// a feature does.
#pragma once

#include <map>
#include <set>
#include <string>

#include "gateway_run.h"
#include "site_world.h"

namespace etcm::simulation {

class ToldNeighbours {
 public:
  explicit ToldNeighbours(SiteWorld& site) : site_(site) {}

  // What a node has just been told of the mesh as it is, must be so.
  std::string look(GatewayRun& run, Instant now);
  // All have been told all.
  std::string look_at_rest(GatewayRun& run);
  std::uint64_t lists() const { return lists_; }  // that were right

 private:
  using Lists = std::map<std::uint32_t, std::set<std::uint32_t>>;
  // By serial, of those that are in the mesh.
  static Lists lists_of(GatewayRun& run);

  SiteWorld& site_;
  std::uint64_t lists_ = 0;
};

}  // namespace etcm::simulation

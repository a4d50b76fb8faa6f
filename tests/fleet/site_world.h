// The nodes of a simulated site: where each is, and which of the gateways hear it.
#pragma once

#include <cstddef>
#include <cstdint>
#include <set>
#include <string>
#include <utility>

#include "gateway_model.h"

namespace etcm::test {

class SiteWorld {
 public:
  static constexpr std::size_t nodes_max = 24;

  explicit SiteWorld(Random& random) : random_(random) {}

  // Of so many gateways any may hear it.
  void add_node(std::size_t gateway_count);
  // A node comes, moves, goes to other gateways, falls silent, or leaves. Returns what happened.
  std::string change(std::size_t gateway_count);

  const World& nodes() const { return nodes_; }

 private:
  Position free_place();
  std::uint32_t any_hearers(std::size_t gateway_count);

  Random& random_;
  World nodes_;
  std::set<std::pair<std::int32_t, std::int32_t>> taken_;
};

}  // namespace etcm::test

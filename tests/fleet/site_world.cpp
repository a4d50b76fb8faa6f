#include "site_world.h"

#include <iterator>

namespace etcm::test {

Position SiteWorld::free_place() {
  while (true) {
    const Position place{.x = random_.between(-1500, 1500), .y = random_.between(-1500, 1500)};
    if (taken_.insert({place.x, place.y}).second) return place;
  }
}

std::uint32_t SiteWorld::any_hearers(std::size_t gateway_count) {
  std::uint32_t hearers = 1u << random_.below(gateway_count);
  if (random_.below(4) == 0) hearers |= 1u << random_.below(gateway_count);
  return hearers;
}

void SiteWorld::add_node(std::size_t gateway_count) {
  if (nodes_.size() >= nodes_max) return;
  const Serial serial{static_cast<std::uint32_t>(1 + random_.below(40))};
  if (nodes_.contains(serial)) return;
  nodes_[serial] = {.position = free_place(), .hearers = any_hearers(gateway_count)};
}

std::string SiteWorld::change(std::size_t gateway_count) {
  if (random_.below(4) == 0) add_node(gateway_count);
  if (nodes_.empty()) return "";
  auto at = nodes_.begin();
  std::advance(at, static_cast<std::ptrdiff_t>(random_.index(nodes_.size())));
  WorldNode& node = at->second;
  switch (random_.below(6)) {
    case 0:
    case 1:
      node.position = free_place();
      break;
    case 2:
    case 3:
      node.hearers = any_hearers(gateway_count);
      if (random_.below(2) == 0) node.position = free_place();
      break;
    case 4:
      node.hearers = random_.below(2) == 0 ? 0 : any_hearers(gateway_count);
      break;
    default:
      node.is_leaving = !node.is_leaving;
  }
  return "node " + std::to_string(at->first.value) + " heard by " + std::to_string(node.hearers) +
         (node.is_leaving ? " leaving" : "") + " at " + std::to_string(node.position.x);
}

}  // namespace etcm::test

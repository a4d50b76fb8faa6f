// A gateway that finds any bytes where its state should be: it starts, and its mesh is whole.
#include <vector>

#include "etcm/audit.h"
#include "firmware/fakes.h"
#include "firmware/memory_store.h"
#include "fuzz_target.h"

namespace etcm::fuzz {

using namespace std::chrono_literals;

void run(std::span<const std::uint8_t> bytes) {
  Input input(bytes);
  const std::uint8_t choice = input.byte();
  const std::span<const std::byte> state = std::as_bytes(input.rest());
  firmware::MemoryStore store;
  store.last.assign(state.begin(), state.end());
  firmware::Rig rig({firmware::feature(1001, 1002), firmware::feature(1003, 1004)});
  rig.settings.state = firmware::StateSettings{.folder = "/state", .interval = 1s};
  rig.store = &store;
  firmware::FollowingWallClock wall(rig.clock);
  if (choice % 2 == 1) rig.wall_clock = &wall;
  if (choice % 4 >= 2) rig.put(3, 50, 50);
  rig.start();
  rig.gateway->restore(rig.clock.now());
  require(audit(rig.mesh).broken == Rule::none, "the mesh fails its audit");
  rig.run(200ms);
  require(audit(rig.mesh).broken == Rule::none, "the mesh fails its audit");
  rig.put_square();
  rig.run(300ms);
  require(audit(rig.mesh).broken == Rule::none, "the mesh fails its audit");
  require(rig.mesh.unresolved() == 0, "the mesh is not whole");
}

}  // namespace etcm::fuzz

// Comings and goings by chance on several buses, with cables that are pulled and a gateway that is
// stopped. Beside it runs a book of who was silent for itself, kept from what the test does and not
// from what the gateway sees: nobody else may ever be missing.
#include <gtest/gtest.h>

#include <array>
#include <string>

#include "etcm/audit.h"
#include "fakes.h"
#include "support/emulated.h"

namespace etcm::firmware {
namespace {

using namespace std::chrono_literals;

constexpr std::uint8_t bus_count = 3;
constexpr std::uint8_t bus_nodes = 5;
// Who answers is asked before this is over, however long it was away.
constexpr port::Duration asked_within = 500ms;

class History {
 public:
  explicit History(std::uint32_t seed) : chance_(seed) {
    rig_.settings.buses.resize(bus_count, rig_.settings.buses[0]);
    rig_.settings.buses[0].units = {{.first = 1, .last = bus_nodes}};
    for (std::uint8_t bus = 0; bus < bus_count; ++bus) {
      rig_.settings.buses[bus].name = std::string(1, static_cast<char>('a' + bus));
      rig_.settings.buses[bus].units = {{.first = 1, .last = bus_nodes}};
      for (std::uint8_t unit = 1; unit <= bus_nodes; ++unit) plug_in(bus, unit);
    }
    rig_.start_with({&buses_[0], &buses_[1], &buses_[2]});
    rig_.run(1s);
  }

  void run(int events) {
    for (int i = 0; i < events && !testing::Test::HasFailure(); ++i) {
      happen();
      pass(port::Duration(1ms) * (100 + below(3000)));
      check();
    }
  }

  void end() {
    for (std::uint8_t bus = 0; bus < bus_count; ++bus) {
      buses_[bus].link_up = true;
      for (std::uint8_t unit = 1; unit <= bus_nodes; ++unit) plug_in(bus, unit);
    }
    rig_.run(2s);
    EXPECT_EQ(rig_.server.header("node_count"), unsigned{bus_count} * bus_nodes);
    EXPECT_EQ(rig_.server.header("state"), 0u);
    EXPECT_TRUE(audit(rig_.mesh));
  }

  std::size_t were_missing() const { return rig_.log.count("is missing"); }
  std::size_t were_silent() const { return rig_.log.count(": silent"); }

 private:
  struct Node {
    bool is_plugged_in = false;
    port::Duration heard{};    // for so long it could be
    port::Duration silence{};  // of its own, since then: while others of its bus could be heard
  };

  std::uint32_t below(std::uint32_t limit) {
    chance_ = chance_ * 1664525u + 1013904223u;
    return static_cast<std::uint32_t>(std::uint64_t{chance_} * limit >> 32);
  }
  Node& node(std::uint8_t bus, std::uint8_t unit) { return nodes_[bus][unit - 1u]; }

  void plug_in(std::uint8_t bus, std::uint8_t unit) {
    node(bus, unit).is_plugged_in = true;
    buses_[bus].set(unit, {.serial = Serial{1000u * (bus + 1u) + unit},
                           .position = {100 * bus + unit * unit, 7 * unit},
                           .status = node_status::fix_valid});
  }

  void happen() {
    const auto bus = static_cast<std::uint8_t>(below(bus_count));
    const auto unit = static_cast<std::uint8_t>(1 + below(bus_nodes));
    switch (below(5)) {
      case 0:
      case 1:
        if (!node(bus, unit).is_plugged_in) return plug_in(bus, unit);
        node(bus, unit).is_plugged_in = false;
        return buses_[bus].silence(unit);
      case 2:
        buses_[bus].link_up = !buses_[bus].link_up;
        return;
      case 3:
        rig_.clock.pass(port::Duration(1ms) * below(20'000));
        return;
      default:
        return;
    }
  }

  void pass(port::Duration time) {
    rig_.run(time);
    for (std::uint8_t bus = 0; bus < bus_count; ++bus) {
      bool is_heard = false;
      for (const Node& each : nodes_[bus]) is_heard = is_heard || each.is_plugged_in;
      is_heard = is_heard && buses_[bus].link_up;
      for (Node& each : nodes_[bus]) {
        each.heard = is_heard && each.is_plugged_in ? each.heard + time : port::Duration{};
        if (is_heard && !each.is_plugged_in) each.silence += time;
        if (each.heard > asked_within) each.silence = {};
      }
    }
  }

  void check() {
    for (const NodeRecord& record : rig_.gateway->nodes().records()) {
      if (!record.is_missing) continue;
      const std::uint32_t bus = record.serial.value / 1000 - 1;
      const Node& each = nodes_[bus][record.serial.value % 1000 - 1];
      EXPECT_LE(each.heard, asked_within) << record.serial.value;
      EXPECT_GT(each.silence + 500ms, rig_.settings.poll.leave_after) << record.serial.value;
    }
  }

  Rig rig_;
  std::array<ScriptedBus, bus_count> buses_;
  std::array<std::array<Node, bus_nodes>, bus_count> nodes_{};
  std::uint32_t chance_;
};

TEST(PresenceHistory, OnlyWhoWasSilentForItselfIsEverMissing) {
  std::size_t missing = 0;
  std::size_t silent = 0;
  for (std::uint32_t seed = 1; seed <= 60u / test::thinning_if_emulated; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    History history(seed);
    history.run(150);
    history.end();
    missing += history.were_missing();
    silent += history.were_silent();
    if (HasFailure()) return;
  }
  // Else it would have shown nothing.
  EXPECT_GT(missing, 100u / test::thinning_if_emulated);
  EXPECT_GT(silent, 100u / test::thinning_if_emulated);
}

}  // namespace
}  // namespace etcm::firmware

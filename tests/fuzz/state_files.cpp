// What a gateway reads back from its disk. The first byte says what it is: 's' its state, 'a' its
// book of alarms, 'm' what a member of a fleet has saved; 'f' is the file around each of these,
// whose checksum is made right as often as not.
#include <algorithm>
#include <string>
#include <vector>

#include "firmware/alarms/alarm_codec.h"
#include "firmware/fleet/fleet_member.h"
#include "firmware/persist/saved_state.h"
#include "fleet/recording_broker.h"
#include "posix/state_file.h"
#include "text_parts.h"

namespace etcm::fuzz {
namespace {

using namespace std::chrono_literals;
using namespace firmware;

std::vector<std::byte> bytes_of(std::span<const std::uint8_t> given) {
  const std::span<const std::byte> bytes = std::as_bytes(given);
  return {bytes.begin(), bytes.end()};
}

void check_indices(const SavedState& state) {
  const std::size_t ends = state.nodes.size() + state.anchors.size();
  for (const SavedFeature& feature : state.features) {
    require(feature.from < ends && feature.to < ends, "a feature ends nowhere");
  }
  for (const SteinerPlace& place : state.steiner) {
    require(place.feature < state.features.size(), "a Steiner vertex of no feature");
  }
  for (const SavedNode& node : state.nodes) {
    require(node.bus == no_saved_bus || node.bus < state.buses.size(), "a node of no bus");
  }
}

// What was read, as this version writes it.
std::vector<std::byte> written(const SavedState& state) {
  StateWriter writer(1 << 16);
  writer.begin(state.generation, state.next_generation, state.mesh_hash, state.saved_at_s);
  if (state.is_canonical) writer.set_canonical();
  for (const std::string& bus : state.buses) writer.add_bus(bus);
  for (const SavedNode& node : state.nodes) writer.add(node);
  for (const Position& anchor : state.anchors) writer.add(anchor);
  for (const SavedFeature& feature : state.features) writer.add(feature);
  for (const SteinerPlace& place : state.steiner) writer.add(place);
  for (const SavedMissing& missing : state.missing) writer.add(missing);
  for (const Quantity& quantity : state.quantities) writer.add(quantity);
  for (const LearnedSensor& sensor : state.sensors) writer.add(sensor);
  if (state.plane) writer.add(*state.plane);
  if (!state.fleet.empty()) writer.add_fleet(state.fleet);
  const auto bytes = writer.finish();
  return {bytes.begin(), bytes.end()};
}

void read_state(std::span<const std::byte> bytes) {
  SavedState state;
  if (!decode_state(bytes, state).empty()) return;
  check_indices(state);
  const std::vector<std::byte> once = written(state);
  SavedState again;
  require(decode_state(once, again).empty(), "what was written is not read");
  require(written(again) == once, "what was written reads as something else");
}

void read_alarms(std::span<const std::byte> bytes) {
  constexpr port::Instant now{1h};
  constexpr std::int64_t wall_ms = 1'800'000'000'000;
  AlarmBook book;
  const std::string wrong = decode_alarms(bytes, now, wall_ms, book);
  std::vector<std::byte> once;
  encode_alarms(book, now, wall_ms, once);
  require(once.size() <= saved_alarms_size_max, "a book of alarms is too large");
  if (!wrong.empty()) return;
  AlarmBook other;
  require(decode_alarms(once, now, wall_ms, other).empty(), "what was written is not read");
  require(other.on_count() == book.on_count(), "alarms are lost");
}

void read_member(std::span<const std::byte> bytes) {
  constexpr port::Instant now{1h};
  FleetSettings settings{.site = "yard", .gateway = "a", .instance = 10};
  settings.nodes_max = 20;
  settings.members_max = 4;
  static_cast<void>(FleetMember::saved_site(bytes));
  test::RecordingBroker broker, other_broker;
  test::RecordingGateway gateway, other_gateway;
  FleetMember member(settings, broker, gateway, gateway, now);
  if (!member.restore(bytes, now).empty()) return;
  const std::vector<std::byte> once = member.save();
  require(once.size() <= save_bytes_max(settings), "it saves more than it says");
  FleetMember other(settings, other_broker, other_gateway, other_gateway, now);
  require(other.restore(once, now).empty(), "what was written is not read");
  require(other.status().node_count == member.status().node_count, "nodes are lost");
}

std::uint32_t crc32(std::span<const std::uint8_t> bytes, std::uint32_t sum) {
  for (const std::uint8_t byte : bytes) {
    sum ^= byte;
    for (int bit = 0; bit < 8; ++bit) sum = sum >> 1 ^ ((sum & 1u) != 0 ? 0xedb88320u : 0u);
  }
  return sum;
}

void read_file(std::span<const std::uint8_t> given) {
  std::string text(text_of(given));
  if (!given.empty() && given.size() >= port::state_head_size && given.back() % 2 == 1) {
    const std::uint32_t sum = ~crc32(given.subspan(16), crc32(given.first(12), ~0u));
    for (std::size_t i = 0; i < 4; ++i) text[12 + i] = static_cast<char>(sum >> (8 * i));
  }
  scratch().write("state", text);
  port::StateFile file(scratch().path(""));
  std::vector<std::byte> bytes;
  std::string why;
  const auto found = file.load(port::Copy::last, bytes, why);
  require(found != port::StateFile::Found::nothing, "a file is not found");
  const bool is_sound = found == port::StateFile::Found::sound;
  require(is_sound || !why.empty(), "no reason");
  if (is_sound) require(bytes.size() + port::state_head_size == given.size(), "bytes are lost");
}

}  // namespace

void run(std::span<const std::uint8_t> bytes) {
  Input input(bytes);
  const std::uint8_t kind = input.byte();
  const std::span<const std::uint8_t> rest = input.rest();
  if (kind == 'f') return read_file(rest);
  const std::vector<std::byte> given = bytes_of(rest);
  if (kind == 'a') return read_alarms(given);
  kind == 'm' ? read_member(given) : read_state(given);
}

}  // namespace etcm::fuzz

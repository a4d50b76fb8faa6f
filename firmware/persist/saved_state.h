// What outlives a restart: the mesh as it was published last, which node answered where, who is
// missing, and what was learned of the sensors. Its form in bytes is here; how they get to the disk
// is the store's business.
//
// All numbers are little-endian, and everything follows the one before without gaps:
//   u32 version of this form, 6
//   u32 generation, u32 the first one that a restart may give out
//   u64 mesh hash
//   u32 counts of buses, nodes, anchors, features, Steiner vertices, missing nodes, quantities,
//       sensors
//   i64 time of day when it was saved, in s since 1970 (UTC); 0: it was not known
//   u32 flags (1: the mesh is the one that build() makes of the nodes, anchors and features, so no
//       Steiner vertices follow; 2: what FleetMember::save() gave follows all else, up to the end;
//       4: the gateway ended with it, so nobody answered later; 8: the plane follows all records)
//   bus:     u8 length, name (at most 255 bytes of it)
//   node:    u32 serial, i32 x, i32 y, u32 age of the position in ms, u16 bus, u8 unit, u8 flags
//            (1: it was silent), u32 silence in s
//   anchor:  i32 x, i32 y
//   feature: u32 from, u32 to; nodes and after them anchors, counted from 0
//   Steiner: u32 feature, counted from 0, i64 x, i64 y in 2^-28 units
//   missing: as a node, but the flags are 1 where it has a position
//   quantity: u8 length, name, u8 length, unit
//   sensor:  u32 serial, u16 quantity, counted from 0, u8 flags (1 disagrees, 2 has a slow change,
//            4 is noisy, 8 and 16 alarms that ended, up to 3), u8 samples, u64 definition, i64 x,
//            i64 y in 2^-28 units, u32 age of its last reading in s, f64 (IEEE 754) reference,
//            followed, slow change, slow residual, residual, roughness, step, wander, rise, fall,
//            u16 samples of the residual, of the roughness, the step, the wander
//            (records/learned_sensor.h)
//   plane:   u8 flags (1: metres about a place, whose degrees x and y are), u8 length, coordinate
//            system, i64 unit, x, y, as in fleet/site_document.h
// Forms 1 to 5 are read too: none has the plane, and forms 1 to 4 have not the silence of a node
// that is not missing. Forms 1 to 3 have no flags of the state, and each has all Steiner vertices;
// forms 1 and 2 have no quantities, sensors, their counts and the time, and form 1 no missing nodes
// either.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "etcm/mesh.h"
#include "firmware/config/settings.h"
#include "firmware/fleet/site_document.h"
#include "firmware/polling/quantity.h"
#include "firmware/records/learned_sensor.h"

namespace etcm::firmware {

inline constexpr std::uint32_t saved_state_version = 6;
// The bus of a node that answers nowhere at the moment.
inline constexpr std::uint16_t no_saved_bus = 0xffff;

// How a bus is named there: what follows is cut off. It is compared and never shown, so it may end
// inside a character.
inline constexpr std::size_t saved_bus_name_max = 255;
inline std::string_view saved_bus_name(std::string_view name) {
  return name.substr(0, saved_bus_name_max);
}

struct SavedNode {
  Serial serial{};
  Position position{};               // where the mesh has it
  std::uint32_t age_ms = 0;          // of the position
  std::uint16_t bus = no_saved_bus;  // in the order of SavedState::buses
  std::uint8_t address = 0;          // of the unit
  bool is_silent = false;            // when it was saved; else it may have answered since
  std::uint32_t silence_s = 0;       // since its last answer
};

struct SavedMissing {
  SavedNode node;
  bool has_position = false;
};

struct SavedFeature {
  std::uint32_t from = 0;
  std::uint32_t to = 0;
};

struct SavedState {
  std::uint32_t generation = 0;
  std::uint32_t next_generation = 0;
  std::uint64_t mesh_hash = 0;
  bool is_canonical = false;  // the mesh is the one of build()
  bool is_last = false;       // the gateway ended with it: nobody answered later
  std::vector<std::string> buses;
  std::vector<SavedNode> nodes;
  std::vector<Position> anchors;
  std::vector<SavedFeature> features;  // those in the mesh
  std::vector<SteinerPlace> steiner;   // none where the mesh is canonical
  std::vector<SavedMissing> missing{};
  std::int64_t saved_at_s = 0;  // time of day; 0: not known
  std::vector<Quantity> quantities{};
  std::vector<LearnedSensor> sensors{};  // of these quantities
  std::optional<DocumentPlane> plane{};  // what positions count in; none: nobody has said
  std::vector<std::byte> fleet{};        // what FleetMember::save() gave; or empty
};

// Reads it. Returns what is wrong with it, as in "it is cut off"; empty where nothing is. What it
// then says makes sense: indices name something, no serial of a node comes twice, numbers are
// finite.
std::string decode_state(std::span<const std::byte> bytes, SavedState& state);

// The most bytes that a gateway with these settings needs.
std::size_t saved_state_size_max(const Settings& settings);

// Writes it, always into the same memory. Records are added kind by kind, in the order above.
class StateWriter {
 public:
  explicit StateWriter(std::size_t size_max);

  // `time_of_day_s` may be 0: not known.
  void begin(std::uint32_t generation, std::uint32_t next_generation, std::uint64_t mesh_hash,
             std::int64_t time_of_day_s = 0);
  // The mesh is the one of build(), so its Steiner vertices need not be added.
  void set_canonical() { is_canonical_ = true; }
  // The gateway ends: what is said of silences holds until then.
  void set_last() { is_last_ = true; }
  // More room: takes memory.
  void set_room(std::size_t size_max) { bytes_.reserve(size_max); }
  void add_bus(std::string_view name);
  void add(const SavedNode& node);
  void add(Position anchor);
  void add(const SavedFeature& feature);
  void add(const SteinerPlace& place);
  void add(const SavedMissing& missing);
  void add(const Quantity& quantity);
  void add(const LearnedSensor& sensor);
  // What positions count in; after all of the above. Not where its coordinate system has too long a
  // name: then nobody has said.
  void add(const DocumentPlane& plane);
  // What FleetMember::save() gives; the last of all.
  void add_fleet(std::span<const std::byte> fleet);
  // What is learned changes all the time: it is content when this number is another one.
  void set_edition(std::uint32_t edition) { mix(edition); }

  // Good until begin().
  std::span<const std::byte> finish();

  // The same for the same content; ages, generations and what was learned are left out, of the
  // silence of who is silent or missing all but the whole hours. After finish().
  std::uint64_t content() const { return content_; }

 private:
  template <class Value>
  void put_content(Value value);
  void mix(std::uint64_t value);
  void put_node(const SavedNode& node, std::uint8_t flags);
  void count(std::size_t kind) { ++counts_[kind]; }

  std::vector<std::byte> bytes_;
  std::uint32_t counts_[8] = {};
  bool is_canonical_ = false;
  bool is_last_ = false;
  bool has_plane_ = false;
  bool has_fleet_ = false;
  std::uint64_t content_ = 0;
};

}  // namespace etcm::firmware

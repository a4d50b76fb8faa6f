// What a member says of itself as JSON: schema/header.json, schema/set.json, schema/conflict.json,
// schema/have.json.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "firmware/fleet/site_document.h"
#include "firmware/protocol/serial.h"

namespace etcm::firmware {

inline constexpr std::size_t header_bytes_max = 1024;
inline constexpr std::size_t fleet_version_max = 40;  // bytes

// A run of a program that goes by the name of a gateway.
struct FleetRun {
  std::uint64_t instance = 0;
  std::uint32_t epoch = 0;
  // Greater than that of every run which the broker knew when this one began to speak.
  std::uint32_t arrival = 0;
  friend bool operator==(const FleetRun&, const FleetRun&) = default;
};

// That a member is there, and what it knows. Its last will is the same, not online.
struct FleetHeader {
  FleetRun run;
  std::uint32_t beat = 0;  // grows with each header of a run
  std::string version{};   // of the program; empty: it does not tell
  bool is_online = false;
  // The rest is there only while it is online.
  std::uint64_t other_instance = 0;  // another run of this name that it has seen; 0: none lately
  bool has_conflict = false;         // that other run is there too
  std::uint32_t merged_count = 0;
  std::uint64_t merged_hash = 0;
  std::uint64_t merged_records = 0;  // 0: it does not tell
  std::uint32_t generation = 0;
  std::uint64_t mesh_hash = 0;
  std::optional<std::uint32_t> mesh_nodes{};  // in that mesh; none: it does not tell
  bool is_alone = false;                      // that mesh is to have its own nodes alone
  SiteVersion site{};
  SiteVersion refused_site{};  // the newest that its gateway does not take; number 0: none
};

// All messages about nodes that the member has published and not taken back. It is no part of the
// header: a last will is written when a connection begins, and may not replace what those who come
// later need.
struct FleetSetSummary {
  FleetRun run;
  std::uint32_t count = 0;
  std::uint64_t hash = 0;
  friend bool operator==(const FleetSetSummary&, const FleetSetSummary&) = default;
};

// What a member has of the messages about nodes of another one, of all serials from `first` to
// `last`.
struct FleetHave {
  struct Item {
    Serial serial;
    std::uint32_t incarnation = 0;
    std::uint32_t sequence = 0;
  };
  Serial first;
  Serial last;
  std::vector<Item> items{};  // by serial
};
inline constexpr std::size_t have_items_max = 1000;
inline constexpr std::size_t have_bytes_max = std::size_t{64} * 1024;

std::string encode_header(const FleetHeader& header);
std::string encode_set(const FleetSetSummary& set);
std::string encode_conflict(const FleetRun& run);
std::string encode_have(const FleetHave& have);

// None, and what is wrong, for what is not sound.
std::optional<FleetHeader> decode_header(std::string_view payload, std::string& wrong);
std::optional<FleetSetSummary> decode_set(std::string_view payload, std::string& wrong);
std::optional<FleetRun> decode_conflict(std::string_view payload, std::string& wrong);
std::optional<FleetHave> decode_have(std::string_view payload, std::string& wrong);

}  // namespace etcm::firmware

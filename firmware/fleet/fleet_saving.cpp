// What a member knows, as bytes that outlive a restart. All numbers are little-endian:
//   u32 version of this form, 3; u32 epoch; u32 count of records
//   record: u8 1 where this member had it published, else 0; u16 length, the JSON of it
//   u32 length, the JSON of the site; 0: there was none; bit 31: the broker has never had it
//   u32 greatest number of a site that was taken out before it was the fleet's for certain
//   u32 count of members that were dismissed; u8 length of the name, the name
//   u64 FNV-1a of all before
#include <algorithm>
#include <utility>

#include "etcm/port/bytes.h"
#include "firmware/fleet/fleet_hash.h"
#include "firmware/fleet/fleet_state.h"
#include "firmware/fleet/record_codec.h"
#include "firmware/fleet/site_codec.h"

namespace etcm::firmware {

namespace {

constexpr std::uint32_t blob_form = 3;
constexpr std::size_t blob_head_size = 12;
constexpr std::size_t blob_sum_size = 8;
constexpr std::uint32_t own_site_bit = 1u << 31;

struct Saved {
  struct Entry {
    FleetRecord record;
    bool is_held = false;
  };
  std::uint32_t epoch = 0;
  std::vector<Entry> entries{};
  std::optional<SiteDocument> site{};
  bool is_fleets_site = true;
  std::uint32_t dropped_number = 0;
  std::vector<std::string> dismissed{};
};

// A record tells its serial itself.
std::optional<Serial> serial_in(std::string_view json) {
  constexpr std::string_view begin = "{\"serial\":";
  if (!json.starts_with(begin)) return std::nullopt;
  std::uint64_t value = 0;
  for (const char c : json.substr(begin.size(), 11)) {
    if (c == ',') return Serial{static_cast<std::uint32_t>(value)};
    if (c < '0' || c > '9') return std::nullopt;
    value = value * 10 + static_cast<std::uint64_t>(c - '0');
  }
  return std::nullopt;
}

// What is between form and sum; where something is wrong, that is said.
std::string open_blob(std::span<const std::byte> bytes, port::ByteReader& reader) {
  if (bytes.size() < blob_head_size + blob_sum_size) return "it is cut off";
  port::ByteReader sum(bytes.last(blob_sum_size));
  bytes = bytes.first(bytes.size() - blob_sum_size);
  if (sum.take<std::uint64_t>() != fnv_hash(port::text_of(bytes))) return "it is damaged";
  reader = port::ByteReader(bytes);
  return reader.take<std::uint32_t>() == blob_form ? "" : "it is of another form";
}

// The last part of it.
void take_dismissed(port::ByteReader& reader, Saved& saved) {
  const auto count = reader.take<std::uint32_t>();
  for (std::uint32_t i = 0; i < count && !reader.is_cut_off(); ++i) {
    saved.dismissed.emplace_back(reader.take_text(reader.take<std::uint8_t>()));
  }
}

std::string decode(std::span<const std::byte> bytes, std::uint32_t nodes_max, Saved& saved) {
  port::ByteReader reader;
  if (std::string wrong = open_blob(bytes, reader); !wrong.empty()) return wrong;
  saved.epoch = reader.take<std::uint32_t>();
  const auto count = reader.take<std::uint32_t>();
  if (saved.epoch > fleet_number_max || count > 2 * std::uint64_t{nodes_max}) {
    return "it is of a larger fleet";
  }
  std::string wrong;
  for (std::uint32_t i = 0; i < count && !reader.is_cut_off(); ++i) {
    const bool is_held = reader.take<std::uint8_t>() != 0;
    const std::string_view json = reader.take_text(reader.take<std::uint16_t>());
    const auto serial = serial_in(json);
    auto record = serial ? decode_record(json, *serial, wrong) : std::nullopt;
    if (!record) return "a record of it is not sound";
    saved.entries.push_back({.record = std::move(*record), .is_held = is_held});
  }
  const auto site_size = reader.take<std::uint32_t>();
  const std::string_view site = reader.take_text(site_size & ~own_site_bit);
  saved.is_fleets_site = (site_size & own_site_bit) == 0;
  saved.dropped_number = std::min(fleet_number_max, reader.take<std::uint32_t>());
  take_dismissed(reader, saved);
  if (reader.is_cut_off()) return "it is cut off";
  if (reader.left() != 0) return "it is too long";
  if (!site.empty()) saved.site = decode_site(site, wrong);
  return site.empty() || saved.site ? "" : "its site is not sound";
}

}  // namespace

std::size_t save_bytes_max(const FleetSettings& settings) {
  return blob_head_size + 2 * std::size_t{settings.nodes_max} * (3 + record_bytes_max) + 4 +
         port::broker_message_bytes_max + 8 + settings.members_max * (1 + fleet_name_max) +
         blob_sum_size;
}

std::optional<SiteDocument> FleetMember::saved_site(std::span<const std::byte> saved) {
  port::ByteReader reader;
  if (!open_blob(saved, reader).empty()) return std::nullopt;
  reader.take<std::uint32_t>();
  const auto count = reader.take<std::uint32_t>();
  for (std::uint32_t i = 0; i < count && !reader.is_cut_off(); ++i) {
    reader.take<std::uint8_t>();
    reader.take_text(reader.take<std::uint16_t>());
  }
  std::string wrong;
  const auto size = reader.take<std::uint32_t>();
  if ((size & own_site_bit) != 0) return std::nullopt;
  return decode_site(reader.take_text(size), wrong);
}

std::vector<std::byte> FleetMember::State::save() const {
  std::vector<std::byte> saved;
  port::put_number(saved, blob_form);
  port::put_number(saved, header.run.epoch);
  port::put_number(saved, static_cast<std::uint32_t>(merged.nodes().size()));
  for (const auto& [serial, node] : merged.nodes()) {
    const auto mine = held.find(serial);
    const bool is_held = mine != held.end() && compare(*mine->second.record, *node.record) == 0;
    const std::string json = encode_record(*node.record);
    port::put_number(saved, static_cast<std::uint8_t>(is_held ? 1 : 0));
    port::put_number(saved, static_cast<std::uint16_t>(json.size()));
    port::put_text(saved, json);
  }
  const bool has_site = site.held && site.version.number > 0;
  const std::string document = has_site ? encode_site(*site.held) : std::string();
  const std::uint32_t own_bit = has_site && !site.is_fleets ? own_site_bit : 0;
  port::put_number(saved, static_cast<std::uint32_t>(document.size()) | own_bit);
  port::put_text(saved, document);
  port::put_number(saved, site.dropped_number);
  port::put_number(saved, static_cast<std::uint32_t>(dismissed.size()));
  for (const std::string& name : dismissed) {
    port::put_number(saved, static_cast<std::uint8_t>(name.size()));
    port::put_text(saved, name);
  }
  port::put_number(saved, fnv_hash(port::text_of(saved)));
  return saved;
}

std::string FleetMember::State::restore(std::span<const std::byte> bytes, port::Instant now) {
  Saved saved;
  if (std::string wrong = decode(bytes, settings.nodes_max, saved); !wrong.empty()) return wrong;
  header.run.epoch = std::min(fleet_number_max, saved.epoch + 1);
  set_will();
  for (Saved::Entry& entry : saved.entries) {
    if (!know_owner(entry.record.owner, now)) continue;
    const auto record = std::make_shared<const FleetRecord>(std::move(entry.record));
    const Serial serial = record->node.serial;
    if (merged.offer(record, now) != MergedSet::Offered::newer) continue;
    if (entry.is_held) held[serial] = {.record = record, .is_sent = true, .held_since = now};
    if (owns(*record) && !record->has_left()) {
      local[serial] = {.node = record->node, .heard_at = now};
    }
  }
  // What was known of them was all that there was.
  for (auto& [name, peer] : peers) peer.is_believed = true;
  for (std::string& name : saved.dismissed) {
    if (is_fleet_name(name) && dismissed.size() < settings.members_max) {
      dismissed.insert(std::move(name));
    }
  }
  site.dropped_number = saved.dropped_number;
  if (saved.site && saved.is_fleets_site) {
    consider_site(std::move(*saved.site), now);
  } else if (saved.site) {
    // Whether its file is still there is said next.
    hold_site(std::move(*saved.site), false, now);
  }
  for (auto& [serial, node] : merged.nodes()) tell_node(serial, node, now);
  has_news_to_save = true;
  return "";
}

}  // namespace etcm::firmware

#include "firmware/publish/reading_register_tables.h"

#include <algorithm>
#include <bit>
#include <limits>

#include "firmware/profile/profile.h"

namespace etcm::firmware {

namespace {

using namespace std::chrono_literals;

// What no reading is.
constexpr std::uint64_t no_nano = std::uint64_t{1} << 63;
constexpr std::uint32_t no_number = 0x7fc00000;  // of 32 bits, IEEE 754

std::uint64_t nano_bits(const ReadingEntrySource& source) {
  return source.reading.nano ? static_cast<std::uint64_t>(*source.reading.nano) : no_nano;
}

std::uint32_t real_of(const ReadingEntrySource& source) {
  if (!source.reading.nano || source.reading.is_stale) return no_number;
  const double value = static_cast<double>(*source.reading.nano) / 1e9;
  return std::bit_cast<std::uint32_t>(static_cast<float>(value));
}

// Four bytes of a text from this one on, zeros behind its end.
std::uint32_t letters_of(const std::string& text, std::size_t first) {
  std::uint32_t letters = 0;
  for (std::size_t at = first; at < first + 4; ++at) {
    const unsigned letter = at < text.size() ? static_cast<unsigned char>(text[at]) : 0u;
    letters = letters << 8 | letter;
  }
  return letters;
}
template <std::size_t first>
std::uint32_t name_from(const Quantity& quantity) {
  return letters_of(quantity.name, first);
}
template <std::size_t first>
std::uint32_t unit_from(const Quantity& quantity) {
  return letters_of(quantity.unit, first);
}

template <typename List>
std::uint32_t entries_of(const List& list, std::uint32_t most) {
  return static_cast<std::uint32_t>(std::min<std::size_t>(list.size(), most));
}

constexpr auto reading_head_table = in_sequence(std::to_array<RegisterRow<ReadingHeadSource>>({
    {"generation", 2, "of this block, as in every block",
     [](const ReadingHeadSource& source) { return source.readings.generation; }},
    {"sequence", 2,
     "of the readings: one more whenever any was read; in every block of readings, so that those "
     "of one "
     "table are known",
     [](const ReadingHeadSource& source) { return source.readings.sequence; }},
    {"reading_count", 2, "readings of all nodes that are known",
     [](const ReadingHeadSource& source) {
       return static_cast<std::uint32_t>(source.readings.readings.size());
     }},
    {"stale_reading_count", 2, "of these, those that are stale",
     [](const ReadingHeadSource& source) {
       return static_cast<std::uint32_t>(
           std::count_if(source.readings.readings.begin(), source.readings.readings.end(),
                         [](const PublishedReading& reading) { return reading.is_stale; }));
     }},
    {"quantities_per_block", 1, "{}", [](const ReadingHeadSource&) { return block_quantities; }},
    {"quantity_entries", 2, "entries of the list of quantities in use",
     [](const ReadingHeadSource& source) {
       return entries_of(source.readings.quantities, source.capacity.quantities);
     }},
    {"quantity_block_first", 2, "number of the first block of quantities",
     [](const ReadingHeadSource& source) { return source.layout.quantities.first; }},
    {"quantity_blocks", 2,
     "blocks of quantities there are; only a reload that adds quantities changes it",
     [](const ReadingHeadSource& source) { return source.layout.quantities.count; }},
    {"readings_per_block", 1, "{}", [](const ReadingHeadSource&) { return block_readings; }},
    {"reading_entries", 2, "entries of the list of readings in use",
     [](const ReadingHeadSource& source) {
       return entries_of(source.readings.readings, source.capacity.readings);
     }},
    {"reading_block_first", 2, "number of the first block of readings",
     [](const ReadingHeadSource& source) { return source.layout.readings.first; }},
    {"reading_blocks", 2,
     "blocks of readings there are; only a reload that adds devices changes it",
     [](const ReadingHeadSource& source) { return source.layout.readings.count; }},
}));

constexpr auto quantity_table = in_sequence(std::to_array<RegisterRow<Quantity>>({
    {"name_1", 2, "bytes 1-4 of the name, UTF-8, zeros behind its end", name_from<0>},
    {"name_2", 2, "bytes 5-8", name_from<4>},
    {"name_3", 2, "bytes 9-12", name_from<8>},
    {"name_4", 2, "bytes 13-16", name_from<12>},
    {"name_5", 2, "bytes 17-20", name_from<16>},
    {"name_6", 2, "bytes 21-24", name_from<20>},
    {"name_7", 2, "bytes 25-28", name_from<24>},
    {"name_8", 2, "bytes 29-32", name_from<28>},
    {"name_9", 2, "bytes 33-36", name_from<32>},
    {"name_10", 2, "bytes 37-40", name_from<36>},
    {"name_11", 2, "bytes 41-44", name_from<40>},
    {"name_12", 2, "bytes 45-48", name_from<44>},
    {"unit_1", 2, "bytes 1-4 of the unit, likewise", unit_from<0>},
    {"unit_2", 2, "bytes 5-8", unit_from<4>},
    {"unit_3", 2, "bytes 9-12", unit_from<8>},
    {"unit_4", 2, "bytes 13-16", unit_from<12>},
    {"unit_5", 2, "bytes 17-20", unit_from<16>},
    {"unit_6", 2, "bytes 21-24", unit_from<20>},
}));
static_assert(reading_name_max == 48 && reading_unit_max == 24);

constexpr auto reading_table = in_sequence(std::to_array<RegisterRow<ReadingEntrySource>>({
    {"serial", 2, "of the node",
     [](const ReadingEntrySource& source) { return register_of(source.reading.serial); }},
    {"row", 2, "of the node in the vertex table, from 0; 4294967295: it is not in the mesh",
     [](const ReadingEntrySource& source) { return source.reading.row; }},
    {"quantity", 1, "number of its entry in the list of quantities, from 1",
     [](const ReadingEntrySource& source) { return source.reading.quantity.value + 1; }},
    {"reading_flags", 1,
     "bit 0: stale, the value is the last known; bit 1: no value, the device had no valid one",
     [](const ReadingEntrySource& source) {
       return flag(source.reading.is_stale, 1) | flag(!source.reading.nano, 2);
     }},
    {"value", 2, "float, IEEE 754; NaN (0x7FC00000) where it is stale or there is none", real_of},
    {"value_nano_high", 2,
     "the value exactly: high half of an int64 that counts 10^-9, also where it is stale; "
     "0x80000000 where "
     "there is none",
     [](const ReadingEntrySource& source) {
       return static_cast<std::uint32_t>(nano_bits(source) >> 32);
     }},
    {"value_nano_low", 2, "low half",
     [](const ReadingEntrySource& source) {
       return static_cast<std::uint32_t>(nano_bits(source) & 0xffffffffu);
     }},
    {"age_ms", 2, "since the device was read, when this sequence was made",
     [](const ReadingEntrySource& source) {
       return static_cast<std::uint32_t>(
           std::clamp<std::int64_t>((source.snapshot_at - source.reading.taken_at) / 1ms, 0,
                                    std::numeric_limits<std::uint32_t>::max()));
     }},
}));

using HeadRows = std::span<const RegisterRow<ReadingHeadSource>>;
using QuantityRows = std::span<const RegisterRow<Quantity>>;
using ReadingRows = std::span<const RegisterRow<ReadingEntrySource>>;
static_assert(has_plain_widths(HeadRows(reading_head_table)));
static_assert(has_plain_widths(QuantityRows(quantity_table)));
static_assert(has_plain_widths(ReadingRows(reading_table)));
static_assert(size_of(HeadRows(reading_head_table)) <= block_size);
static_assert(size_of(QuantityRows(quantity_table)) == quantity_registers);
static_assert(size_of(ReadingRows(reading_table)) == reading_registers);
static_assert(reading_head_table[0].registers + reading_head_table[1].registers ==
              reading_generation_registers);

// As those of the mesh: published registers stay.
static_assert(fingerprint(HeadRows(reading_head_table)) == 0x5fe3ea9b);
static_assert(fingerprint(QuantityRows(quantity_table)) == 0xff283681);
static_assert(fingerprint(ReadingRows(reading_table)) == 0x65fd8480);

}  // namespace

std::span<const RegisterRow<ReadingHeadSource>> reading_head_rows() { return reading_head_table; }
std::span<const RegisterRow<Quantity>> quantity_rows() { return quantity_table; }
std::span<const RegisterRow<ReadingEntrySource>> reading_rows() { return reading_table; }

}  // namespace etcm::firmware

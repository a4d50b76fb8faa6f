// Payloads of Sparkplug B: metrics as bytes, and what a command asks for.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string_view>

namespace etcm::firmware::sparkplug {

enum class Kind : std::uint8_t { int32, int64, real, yes_no, hex };

// What a metric has. `bits` are those of the kind: in two's complement, of a double, 0 or 1, or 16
// digits of a text.
struct Value {
  Kind kind = Kind::int64;
  bool is_null = false;   // it has none, and `bits` are 0
  bool is_stale = false;  // it is not fresh
  std::uint64_t bits = 0;

  static Value whole(std::int32_t value);
  static Value count(std::uint32_t value);
  static Value real(double value);
  static Value yes_no(bool value);
  static Value hex(std::uint64_t value);
  static Value none(Kind kind) { return {.kind = kind, .is_null = true}; }
  friend bool operator==(const Value&, const Value&) = default;
};

// Longer texts are cut, in bytes.
inline constexpr std::size_t metric_name_max = 63;
inline constexpr std::size_t metric_unit_max = 24;

struct Metric {
  std::string_view name;
  std::string_view unit{};       // or empty
  std::uint64_t alias = 0;       // 0: it is always told by its name
  std::int64_t measured_ms = 0;  // since 1970, UTC
  Value value{};
};

// No payload with so many metrics is longer.
constexpr std::size_t payload_bytes_max(std::size_t metrics) { return 32 + 224 * metrics; }

// Writes one payload after the other into memory that is there.
class PayloadWriter {
 public:
  // The room must outlive the writer.
  explicit PayloadWriter(std::span<char> room) : room_(room) {}

  void begin(std::int64_t sent_ms);
  // In a birth: with name and unit.
  void add_birth(const Metric& metric);
  // Known by its alias. `was_stale`: so those who listen were told.
  void add_change(const Metric& metric, bool was_stale);
  // Valid until the next begin(). REQUIRES: there was room.
  std::string_view finish(std::optional<std::uint8_t> sequence);

 private:
  std::span<char> room_;
  std::size_t size_ = 0;
};

// Whether a command asks an edge node for its births. Any bytes may come.
bool asks_for_rebirth(std::string_view payload);

}  // namespace etcm::firmware::sparkplug

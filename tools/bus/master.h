// What one asks the units of a bus: registers and identities.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "link.h"
#include "modbus/frame.h"

namespace etcm::bus {

// The address of a broadcast, which is not answered.
inline constexpr std::uint8_t everybody = 0;
// Behind the last register of a unit.
inline constexpr std::uint32_t register_end = 0x10000;

// Why there is no result.
struct ErrorDetail {
  enum class Kind : std::uint8_t { silence, garbled, exception } kind = Kind::silence;
  std::uint8_t exception = 0;

  // No unit is there: silence, or a converter that says so for the unit.
  bool is_absence() const;
};
// What to do about one that reading met: "; check ...", or nothing.
std::string cure_of(const ErrorDetail& error_detail);
// "no answer", "exception 2: Illegal data address".
std::string to_string(const ErrorDetail& error_detail);

// The identity that a unit gives; empty texts where it gives none. Printable characters only.
struct Identification {
  std::string vendor;
  std::string product;
  std::string version;
  std::string server_id;  // of FC 17, where FC 43/14 is not served
};
// All of it in one line; empty where it said nothing.
std::string to_string(const Identification& who);

// As the protocol has it.
inline constexpr std::size_t bits_at_once = 2000;
inline constexpr std::size_t coils_at_once = 1968;

using Registers = std::vector<std::uint16_t>;

class Master {
 public:
  // `link` must outlive this.
  Master(Link& link, port::Duration timeout) : link_(link), timeout_(timeout) {}

  Link& link() { return link_; }

  // Whether that can be asked at once (link.h).
  bool may_read(std::uint8_t unit, std::uint8_t function, port::RegisterRange range) const;

  // Reads 1 to 125 registers with FC 3 or FC 4 into `registers`, which gives the count; with FC 1
  // or FC 2 1 to bits_at_once coils or discrete inputs, each 0 or 1.
  std::optional<ErrorDetail> read(std::uint8_t unit, std::uint8_t function, std::uint16_t first,
                                  std::span<std::uint16_t> registers);

  // Writes to the table that this function reads: 1 to 123 holding registers with FC 16, or coils,
  // each 0 or 1: one with FC 5, up to coils_at_once with FC 15.
  std::optional<ErrorDetail> write(std::uint8_t unit, std::uint8_t table, std::uint16_t first,
                                   std::span<const std::uint16_t> values);

  // The same to all units at once. That is not answered, so the result is unknown.
  void broadcast(std::uint8_t table, std::uint16_t first, std::span<const std::uint16_t> values);

  Identification identify(std::uint8_t unit);

  // How long the last question took to be answered.
  port::Duration took() const { return took_; }

 private:
  bool identify_by_objects(std::uint8_t unit, Identification& who);
  Reply ask(std::uint8_t unit, std::span<const std::uint8_t> request);

  Link& link_;
  port::Duration timeout_;
  port::Duration took_{};
};

}  // namespace etcm::bus

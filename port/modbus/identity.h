// The identity of a unit: FC 17 (report server id) and FC 43/14 (read device identification), both
// ends.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string_view>

namespace etcm::port {

inline constexpr std::uint8_t report_server_id = 17;
inline constexpr std::uint8_t encapsulated_interface = 43;
inline constexpr std::uint8_t read_device_identification = 14;  // in the encapsulated interface

// The objects of the basic category of FC 43/14, by their number.
struct Identity {
  std::array<std::string_view, 3> objects;  // vendor, product, version

  std::string_view vendor() const { return objects[0]; }
  std::string_view product() const { return objects[1]; }
  std::string_view version() const { return objects[2]; }
};

// Writes the answer to a request of at least one byte into `answer` (pdu_bytes_max bytes) and
// returns its length; 0 when the request asks for no identity. What does not fit one answer of FC
// 43/14 follows in the next one (object after object); a text of more than 240 bytes is cut.
std::size_t write_identity_answer(std::span<std::uint8_t> answer,
                                  std::span<const std::uint8_t> request, const Identity& identity);

// FC 17. The data are the unit's own: an identifier, whether it runs (0xff), and often a text.
std::size_t write_server_id_request(std::span<std::uint8_t> pdu);
std::optional<std::span<const std::uint8_t>> parse_server_id_answer(
    std::span<const std::uint8_t> pdu);

// FC 43/14, the basic category from object `first` on.
std::size_t write_identification_request(std::span<std::uint8_t> pdu, std::uint8_t first);

// Sets those texts of `identity` that stand in the answer; they point into `pdu`. Returns the first
// object to ask for next: Identity::objects.size() when that is all. None when this is no such
// answer; `identity` is then unchanged.
std::optional<std::uint8_t> parse_identification_answer(std::span<const std::uint8_t> pdu,
                                                        Identity& identity);

}  // namespace etcm::port

// Modbus TCP framing, and the PDUs of reading and writing registers, whatever carries them.
//
// Own framing, because libmodbus reads a socket until a frame is whole: it blocks, and one client
// that sends three stray bytes would hold up all others. Requests are judged here, and answered by
// replies.h.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>

namespace etcm::port {

inline constexpr std::uint8_t read_holding_registers = 3;
inline constexpr std::uint8_t read_input_registers = 4;
inline constexpr std::uint8_t write_holding_registers = 16;
// Set in the function of an answer that is an exception.
inline constexpr std::uint8_t exception_bit = 0x80;
// The exceptions that say what a unit does not have, and not how it is just now.
inline constexpr std::uint8_t illegal_function = 1;
inline constexpr std::uint8_t illegal_data_address = 2;

inline constexpr std::size_t pdu_bytes_max = 253;
inline constexpr std::size_t mbap_header_bytes = 7;
inline constexpr std::size_t frame_bytes_max = mbap_header_bytes + pdu_bytes_max;

struct Frame {
  std::uint16_t transaction = 0;
  std::uint8_t address = 0;
  std::span<const std::uint8_t> pdu;  // into the FrameReader, until its next call
};

// Cuts a byte stream into frames.
class FrameReader {
 public:
  enum class Next : std::uint8_t {
    frame,
    incomplete,  // more bytes are needed
    broken,      // this is no Modbus TCP: the stream cannot be followed any more
  };

  // Where to put received bytes; never empty after next() answered `incomplete`.
  std::span<std::uint8_t> free_space();
  void received(std::size_t count);

  Next next(Frame& frame);

  void clear() { begin_ = end_ = 0; }
  bool empty() const { return begin_ == end_; }

 private:
  std::array<std::uint8_t, 4 * frame_bytes_max> bytes_;
  std::size_t begin_ = 0;
  std::size_t end_ = 0;
};

// Writes the MBAP header before a PDU that already stands at frame[mbap_header_bytes]; returns the
// length of the whole frame.
std::size_t write_header(std::span<std::uint8_t> frame, std::uint16_t transaction,
                         std::uint8_t address, std::size_t pdu_bytes);

struct RegisterRange {
  std::uint16_t first = 0;
  std::uint16_t count = 0;
};

// The request to read registers (FC 3 or FC 4); returns the bytes written to `pdu`.
std::size_t write_read_request(std::span<std::uint8_t> pdu, std::uint8_t function,
                               RegisterRange range);

// The range an FC 3 or FC 4 request asks for. Otherwise nothing, and `exception` is the code to
// answer with. Whether the range exists is for the caller to say.
std::optional<RegisterRange> parse_read_request(std::span<const std::uint8_t> pdu,
                                                std::uint8_t& exception);

std::size_t write_exception(std::span<std::uint8_t> pdu, std::uint8_t function,
                            std::uint8_t exception);

// What an answer to write_read_request() with this function says.
enum class ReadAnswer : std::uint8_t { registers, exception, malformed };
ReadAnswer parse_read_answer(std::span<const std::uint8_t> pdu, std::uint8_t function,
                             std::span<std::uint16_t> registers, std::uint8_t& exception);

// The request to write registers (FC 16); returns the bytes written to `pdu`.
std::size_t write_write_request(std::span<std::uint8_t> pdu, std::uint16_t first,
                                std::span<const std::uint16_t> values);

// The range an FC 16 request writes. Otherwise nothing, and `exception` is the code to answer with.
std::optional<RegisterRange> parse_write_request(std::span<const std::uint8_t> pdu,
                                                 std::uint8_t& exception);

// What an answer to write_write_request() of this range says.
enum class WriteAnswer : std::uint8_t { written, exception, malformed };
WriteAnswer parse_write_answer(std::span<const std::uint8_t> pdu, RegisterRange range,
                               std::uint8_t& exception);

}  // namespace etcm::port

// What a request asks of a unit, by what tells its answer from other answers: they carry no number
// on a serial line.
//
// Known are the functions that read (1 to 4, 17, 43/14) and that write (5, 6, 15, 16, 22, 23).
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include "modbus/frame.h"

namespace etcm::port {

inline constexpr std::uint8_t read_coils = 1;
inline constexpr std::uint8_t read_discrete_inputs = 2;
inline constexpr std::uint8_t write_single_coil = 5;
inline constexpr std::uint8_t write_single_register = 6;
inline constexpr std::uint8_t write_coils = 15;
inline constexpr std::uint8_t mask_write_register = 22;
inline constexpr std::uint8_t write_and_read_registers = 23;

struct RtuQuestion {
  std::uint8_t function = 0;
  // What is read; of a function that only writes, the first two words behind the function, which
  // its answer repeats. Nothing of an identification.
  RegisterRange range;
};

// Of a request of at least one byte.
RtuQuestion question_of(std::span<const std::uint8_t> request);

// Whether an answer to one could be taken for an answer to the other: of reads it tells function
// and length, of writes what question_of() has, of identifications the function alone.
bool are_answered_alike(const RtuQuestion& a, const RtuQuestion& b);

// Whether a PDU of at least one byte can be the answer to the question. An exception is none.
bool answers(std::span<const std::uint8_t> pdu, const RtuQuestion& question);

// The bytes of the PDU of its answer; of an identification the most there may be.
std::size_t answer_bytes(const RtuQuestion& question);

}  // namespace etcm::port

// Log lines to a descriptor, such as standard error, one write each.
//
// Read by the journal, a line has its priority before it (sd-daemon(3)). On a terminal or in a file
// it has the time; to anybody else, such as a pipe, it goes without.
//
// Nothing waits for the reader: a line that would have to is left out, and so many are told when
// there is room again.
#pragma once

#include <cstdint>

#include "etcm/port/log.h"

namespace etcm::port {

class StreamLog final : public Log {
 public:
  // A longer line is cut.
  static constexpr std::size_t line_max = 1000;

  // The descriptor stays the caller's. What is finer than `finest` is not written.
  explicit StreamLog(int descriptor, Level finest = Level::info);
  // A line end, another control character and what is no UTF-8 become "?".
  void write(Level level, std::string_view line) override;

 private:
  enum class Reader : std::uint8_t { journal, person, program };
  bool try_write(Level level, std::string_view line);

  int descriptor_;
  Level finest_;
  Reader reader_;
  std::uint32_t left_out_ = 0;
};

}  // namespace etcm::port

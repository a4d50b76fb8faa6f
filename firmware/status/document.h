// A text that is made piece by piece: what is large needs no memory, and is never made in one go.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <string_view>
#include <utility>

#include "etcm/port/clock.h"
#include "firmware/status/text_writer.h"

namespace etcm::firmware {

// No piece of a document is longer.
inline constexpr std::size_t piece_bytes_max = 2560;

// How far a reader is: what the numbers count is the document's business. All zeros is the
// beginning.
struct Cursor {
  std::uint32_t section = 0;
  std::uint32_t item = 0;
  std::uint32_t part = 0;
  bool has_begun = false;  // a list in this section has its first element

  void next_section() { *this = {.section = section + 1}; }
  // What stands before the next element of a list.
  std::string_view separator() { return std::exchange(has_begun, true) ? "," : ""; }
};

// How long ago `since` was for a reader who asked at `asked_at`. What has come since then, while
// the reader took what stands before it, is new.
constexpr port::Duration age_of(port::Instant since, port::Instant asked_at) {
  return std::max<port::Duration>(asked_at - since, {});
}

class Document {
 public:
  // Writes the next piece (which may be empty) and moves the cursor on; false behind the last.
  // `asked_at` is the same for all pieces that one reader gets.
  virtual bool write_next(Cursor& cursor, port::Instant asked_at, TextWriter& piece) const = 0;

 protected:
  ~Document() = default;
};

}  // namespace etcm::firmware

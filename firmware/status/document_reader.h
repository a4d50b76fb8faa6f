// Hands a document or a text out as its reader takes it.
#pragma once

#include <array>
#include <cstddef>
#include <span>
#include <string_view>

#include "firmware/status/document.h"

namespace etcm::firmware {

class DocumentReader {
 public:
  // Whoever read before does no longer; there is nothing to read yet.
  void begin(port::Instant asked_at);

  // Room for a text of one piece, which show(writer.text()) shows.
  TextWriter writer() { return TextWriter(piece_); }
  // Must outlive the reading, as the next.
  void show(std::string_view text) { rest_ = text; }
  // Behind the text that is shown.
  void show(const Document& document) { document_ = &document; }

  // The next bytes, as many as fit; 0 at the end.
  std::size_t read(std::span<char> out);

 private:
  const Document* document_ = nullptr;  // null: what is in `rest_` is all
  Cursor cursor_;
  port::Instant asked_at_{};
  std::string_view rest_;  // to be handed out next
  std::array<char, piece_bytes_max> piece_;
};

}  // namespace etcm::firmware

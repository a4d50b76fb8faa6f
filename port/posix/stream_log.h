// Log lines to a C stream, one write each, with the journal's priority prefix where it is read by
// the journal.
#pragma once

#include <cstdio>

#include "etcm/port/log.h"

namespace etcm::port {

class StreamLog final : public Log {
 public:
  explicit StreamLog(std::FILE* stream);
  void write(Level level, std::string_view line) override;

 private:
  std::FILE* stream_;
  bool journal_;
};

}  // namespace etcm::port

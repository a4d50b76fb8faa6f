#include "posix/stream_log.h"

#include <cstdlib>

namespace etcm::port {

namespace {

// sd-daemon(3): "<3>" error, "<4>" warning, "<6>" information.
const char* journal_prefix(Level level) {
  switch (level) {
    case Level::error:
      return "<3>";
    case Level::warning:
      return "<4>";
    case Level::info:
      break;
  }
  return "<6>";
}

const char* plain_prefix(Level level) {
  switch (level) {
    case Level::error:
      return "error: ";
    case Level::warning:
      return "warning: ";
    case Level::info:
      break;
  }
  return "";
}

}  // namespace

StreamLog::StreamLog(std::FILE* stream)
    : stream_(stream), journal_(std::getenv("JOURNAL_STREAM") != nullptr) {
  std::setvbuf(stream_, nullptr, _IOLBF, BUFSIZ);
}

void StreamLog::write(Level level, std::string_view line) {
  std::fprintf(stream_, "%s%.*s\n", journal_ ? journal_prefix(level) : plain_prefix(level),
               static_cast<int>(line.size()), line.data());
}

}  // namespace etcm::port

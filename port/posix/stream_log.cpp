#include "posix/stream_log.h"

#include <poll.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cinttypes>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <ctime>

#include "etcm/port/utf8.h"

namespace etcm::port {

namespace {

constexpr std::string_view cut_mark = " ...";

// sd-daemon(3): "<3>" error, "<4>" warning, "<6>" information, "<7>" detail.
const char* journal_prefix(Level level) {
  switch (level) {
    case Level::error:
      return "<3>";
    case Level::warning:
      return "<4>";
    case Level::info:
      break;
    case Level::detail:
      return "<7>";
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
    case Level::detail:
      break;
  }
  return "";
}

// JOURNAL_STREAM names the stream that systemd gave the service; a child may have another.
bool is_journal(const struct stat& status) {
  const char* const stream = std::getenv("JOURNAL_STREAM");
  std::uintmax_t device = 0, inode = 0;
  return stream != nullptr && std::sscanf(stream, "%" SCNuMAX ":%" SCNuMAX, &device, &inode) == 2 &&
         device == status.st_dev && inode == status.st_ino;
}

// "2026-11-21 01:03:23.456 ", in local time.
std::size_t write_time(char* out, std::size_t room) {
  timespec now{};
  ::clock_gettime(CLOCK_REALTIME, &now);
  std::tm local{};
  ::localtime_r(&now.tv_sec, &local);
  const std::size_t size = std::strftime(out, room, "%Y-%m-%d %H:%M:%S", &local);
  return size + static_cast<std::size_t>(std::snprintf(out + size, room - size, ".%03d ",
                                                       static_cast<int>(now.tv_nsec / 1'000'000)));
}

}  // namespace

StreamLog::StreamLog(int descriptor, Level finest)
    : descriptor_(descriptor), finest_(finest), reader_(Reader::program) {
  struct stat status {};
  if (::fstat(descriptor, &status) != 0) return;
  if (is_journal(status)) {
    reader_ = Reader::journal;
  } else if (::isatty(descriptor) != 0 || S_ISREG(status.st_mode)) {
    reader_ = Reader::person;
  }
}

void StreamLog::write(Level level, std::string_view line) {
  if (level > finest_) return;
  if (left_out_ > 0) {
    std::array<char, 80> text{};
    const int size =
        std::snprintf(text.data(), text.size(),
                      "%" PRIu32 " lines of this log are missing: nobody took them", left_out_);
    if (try_write(Level::warning, {text.data(), static_cast<std::size_t>(size)})) left_out_ = 0;
  }
  if (left_out_ > 0 || !try_write(level, line)) ++left_out_;
}

bool StreamLog::try_write(Level level, std::string_view line) {
  // A pipe that can be written to takes a line whole; a terminal that was stopped cannot.
  pollfd waiting{.fd = descriptor_, .events = POLLOUT, .revents = 0};
  if (::poll(&waiting, 1, 0) <= 0) return false;

  std::array<char, 64 + line_max + cut_mark.size()> text;
  std::size_t size = reader_ == Reader::person ? write_time(text.data(), text.size()) : 0;
  const auto append = [&](std::string_view part) {
    size = static_cast<std::size_t>(
        std::copy(part.begin(), part.end(), text.begin() + static_cast<std::ptrdiff_t>(size)) -
        text.begin());
  };
  append(reader_ == Reader::journal ? journal_prefix(level) : plain_prefix(level));
  std::string_view left = cut_utf8(line, line_max);
  const bool is_cut = left.size() < line.size();
  while (!left.empty()) {
    const auto first = static_cast<unsigned char>(left.front());
    const std::size_t bytes = first < 0x20 || first == 0x7f ? 0 : utf8_character(left);
    append(bytes == 0 ? "?" : left.substr(0, bytes));
    left.remove_prefix(std::max<std::size_t>(bytes, 1));
  }
  if (is_cut) append(cut_mark);
  append("\n");
  // What fails is lost: there is nobody else to tell.
  static_cast<void>(!::write(descriptor_, text.data(), size));
  return true;
}

}  // namespace etcm::port

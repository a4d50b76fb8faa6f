#include "etcm/files/record_reader.h"

#include <fcntl.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>
#include <limits>

namespace etcm::files {

namespace {

class Descriptor {
 public:
  explicit Descriptor(int value) : value_(value) {}
  Descriptor(const Descriptor&) = delete;
  Descriptor& operator=(const Descriptor&) = delete;
  ~Descriptor() {
    if (value_ >= 0) ::close(value_);
  }
  int get() const { return value_; }

 private:
  int value_;
};

bool is_blank(char c) { return c == ' ' || c == '\t' || c == '\r' || c == '\v' || c == '\f'; }

constexpr std::string_view byte_order_mark = "\xef\xbb\xbf";

[[noreturn]] void fail_by_system(const std::string& path, const char* what) {
  const int error = errno;
  throw InputError(
      path, 0,
      std::string(what) + ": " + std::strerror(error) +
          (error == EACCES ? "; let the user of this program read it" : "; check the path"));
}

}  // namespace

std::string read_text(const std::string& path, std::size_t most) {
  const Descriptor file(::open(path.c_str(), O_RDONLY | O_CLOEXEC));
  if (file.get() < 0) {
    fail_by_system(path, "cannot be opened");
  }
  std::string text;
  std::array<char, 65536> buffer;
  while (true) {
    const ssize_t got = ::read(file.get(), buffer.data(), buffer.size());
    if (got < 0 && errno == EINTR) continue;
    if (got < 0) fail_by_system(path, "cannot be read");
    if (got == 0) break;
    if (static_cast<std::size_t>(got) > most - text.size()) {
      throw InputError(path, 0,
                       "has more than " + std::to_string(most) +
                           " bytes; check the path, or make the file smaller");
    }
    text.append(buffer.data(), static_cast<std::size_t>(got));
  }
  if (text.starts_with(byte_order_mark)) text.erase(0, byte_order_mark.size());
  return text;
}

RecordReader::RecordReader(const std::string& path) : path_(path), text_(read_text(path)) {
  const std::size_t nul = text_.find('\0');
  if (nul == std::string::npos) return;
  std::size_t line = 1;
  for (std::size_t i = 0; i < nul; ++i) line += text_[i] == '\n';
  fail_at(line, "contains a NUL byte, so this is no text file; convert it to plain text");
}

bool RecordReader::next() {
  while (at_ < text_.size()) {
    ++lines_seen_;
    const std::size_t end = std::min(text_.find('\n', at_), text_.size());
    std::string_view line(text_.data() + at_, end - at_);
    at_ = std::min(end + 1, text_.size());
    line = line.substr(0, line.find('#'));
    fields_.clear();
    for (std::size_t i = 0; i < line.size();) {
      if (is_blank(line[i])) {
        ++i;
        continue;
      }
      std::size_t stop = i;
      while (stop < line.size() && !is_blank(line[stop])) ++stop;
      fields_.push_back(line.substr(i, stop - i));
      i = stop;
    }
    if (!fields_.empty()) {
      line_number_ = lines_seen_;
      return true;
    }
  }
  return false;
}

void RecordReader::require(const std::string& what) {
  if (next()) return;
  fail_at(std::max<std::size_t>(lines_seen_, 1),
          "the file ends before " + what + "; it is cut short or a count is too high");
}

void RecordReader::expect_end() {
  if (next()) {
    fail("'" + quoted(field(0)) +
         "' stands after the end of the data; remove it or correct a count");
  }
}

void RecordReader::expect_fields(std::size_t least, std::size_t most,
                                 const std::string& what) const {
  if (size() >= least && size() <= most) return;
  const std::string wanted =
      least == most ? std::to_string(least) : std::to_string(least) + " to " + std::to_string(most);
  fail(what + " has " + std::to_string(size()) + " fields, not " + wanted);
}

Decimal RecordReader::number(std::size_t index, const std::string& what) const {
  const auto value = Decimal::parse(field(index));
  if (!value) fail(what + " '" + quoted(field(index)) + "' is no decimal number");
  return *value;
}

std::int64_t RecordReader::integer(std::size_t index, const std::string& what) const {
  const auto value = number(index, what).to_integer();
  if (!value) fail(what + " '" + quoted(field(index)) + "' is no integer of at most 18 digits");
  return *value;
}

std::size_t RecordReader::count(std::size_t index, const std::string& what,
                                std::size_t most) const {
  const std::int64_t value = integer(index, what);
  if (value < 0) fail(what + " is " + quoted(field(index)) + "; it must not be negative");
  if (static_cast<std::uint64_t>(value) > most) {
    fail(what + " is " + quoted(field(index)) + "; it must be at most " + std::to_string(most));
  }
  return static_cast<std::size_t>(value);
}

int RecordReader::marker(std::size_t index, const std::string& what) const {
  const std::int64_t value = integer(index, what);
  // The lowest values stay free, so that there always is one to mark Steiner vertices with.
  constexpr std::int64_t least = std::numeric_limits<int>::min() / 2;
  if (value < least || value > std::numeric_limits<int>::max()) {
    fail(what + " " + quoted(field(index)) + " does not fit; use a smaller number");
  }
  return static_cast<int>(value);
}

void RecordReader::fail(const std::string& message) const { fail_at(line_number_, message); }

void RecordReader::fail_at(std::size_t line, const std::string& message) const {
  throw InputError(path_, line, message);
}

std::string RecordReader::quoted(std::string_view field) const {
  constexpr std::size_t longest = 40;
  std::string text;
  for (const char c : field.substr(0, longest)) text += c >= ' ' && c <= '~' ? c : '?';
  if (field.size() > longest) text += "...";
  return text;
}

}  // namespace etcm::files

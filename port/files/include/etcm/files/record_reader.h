// The layout all of Triangle's files share: records of blank-separated fields, one a line; '#'
// starts a comment anywhere; blank lines do not count.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "etcm/files/decimal.h"
#include "etcm/files/error.h"

namespace etcm::files {

// What a file (or pipe) has, without the mark of UTF-8 that some editors put before a text. Throws
// InputError when it cannot be read, or has more than `most` bytes.
std::string read_text(const std::string& path, std::size_t most = std::string::npos);

class RecordReader {
 public:
  // Reads the file. Throws InputError, as does every call below: with the line where it stands.
  explicit RecordReader(const std::string& path);

  const std::string& path() const { return path_; }
  // The line of the record that next() found.
  std::size_t line() const { return line_number_; }
  std::size_t bytes_left() const { return text_.size() - at_; }

  // The next record; false at the end of the file.
  bool next();
  // The next record, where there must be one: `what` names it, as in "node 4 of 10".
  void require(const std::string& what);
  // Refuses a record after the last one that belongs to the file.
  void expect_end();

  // Fields of the record.
  std::size_t size() const { return fields_.size(); }
  std::string_view field(std::size_t index) const { return fields_[index]; }
  void expect_fields(std::size_t least, std::size_t most, const std::string& what) const;
  Decimal number(std::size_t index, const std::string& what) const;
  std::int64_t integer(std::size_t index, const std::string& what) const;
  // An integer in [0, most].
  std::size_t count(std::size_t index, const std::string& what, std::size_t most) const;
  // A boundary marker: an int.
  int marker(std::size_t index, const std::string& what) const;

  [[noreturn]] void fail(const std::string& message) const;
  [[noreturn]] void fail_at(std::size_t line, const std::string& message) const;

 private:
  std::string quoted(std::string_view field) const;

  std::string path_;
  std::string text_;
  std::size_t at_ = 0;
  std::size_t lines_seen_ = 0;
  std::size_t line_number_ = 0;
  std::vector<std::string_view> fields_;
};

}  // namespace etcm::files

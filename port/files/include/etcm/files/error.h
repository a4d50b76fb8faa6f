// What the readers and writers throw. Files fail in ways their caller can only report, so the whole
// sentence is made here and main() prints it.
#pragma once

#include <cstddef>
#include <stdexcept>
#include <string>

namespace etcm::files {

// The input is wrong. what() is one line, `file:line: what is wrong; the cure`.
class InputError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
  // Line 0: the file as a whole.
  InputError(const std::string& file, std::size_t line, const std::string& message);
};

// The output cannot be written. what() is one line, `file: what the system says`.
class OutputError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

}  // namespace etcm::files

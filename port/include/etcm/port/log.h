// Where the gateway says what happened, one line for a person each.
#pragma once

#include <cstdint>
#include <string_view>

namespace etcm::port {

enum class Level : std::uint8_t {
  error,
  warning,
  info,
  detail,  // figures, for who wants to know more than what happened
};

class Log {
 public:
  // `line` has no line end and no time of its own. It begins with what it is about, such as "unit 7
  // of yard"; numbers behind the first ": " or "(" are details. Lines that differ in details alone
  // are of one kind, and a log may leave out what would only repeat its kind.
  virtual void write(Level level, std::string_view line) = 0;

 protected:
  ~Log() = default;
};

}  // namespace etcm::port

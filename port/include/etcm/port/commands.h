// What a person on this machine tells a running program, and what it answers.
//
// The answer is made piece by piece, as in web_site.h.
#pragma once

#include <cstddef>
#include <span>
#include <string_view>

namespace etcm::port {

// So many say something at a time.
inline constexpr std::size_t command_clients_max = 4;

class CommandHandler {
 public:
  // Somebody says this, which may hold any bytes but a line feed. `client`, below
  // command_clients_max, is theirs alone until end().
  virtual void begin(std::size_t client, std::string_view line) = 0;
  // Writes the next bytes of the answer and returns how many; 0 when there are no more. `out` has
  // room for at least one.
  virtual std::size_t read(std::size_t client, std::span<char> out) = 0;
  // Comes once for each begin(), whether or not everything was read.
  virtual void end(std::size_t client) = 0;

 protected:
  ~CommandHandler() = default;
};

}  // namespace etcm::port

// People and programs that read the page of a gateway: several at a time, some slowly, and some
// hang up in the middle.
#pragma once

#include <array>
#include <nlohmann/json.hpp>
#include <string>
#include <string_view>

#include "firmware/status/status_page.h"
#include "inputs/random.h"

namespace etcm::simulation {

class PageReaders {
 public:
  static constexpr std::size_t count_max = 6;

  explicit PageReaders(firmware::StatusPage& page) : page_(page) {}

  // Somebody asks for something and reads all of it. What is wrong with it, or nothing.
  std::string read_whole(inputs::Random& random);
  // So many come, as far as there are places, and read on with each step.
  void come(std::size_t count, inputs::Random& random);
  bool is_there() const;
  // The same as of read_whole(), of whom has read to the end in this step.
  std::string read_on(inputs::Random& random);

 private:
  struct Reader {
    std::string_view path;  // empty: there is nobody
    std::uint16_t status = 0;
    std::string text;
  };
  void begin(std::size_t number, inputs::Random& random);
  // Whether there was something.
  bool read_piece(std::size_t number, std::size_t bytes);
  std::string end(std::size_t number);
  static std::string look_at_mesh(const nlohmann::json& document);

  firmware::StatusPage& page_;
  std::array<Reader, count_max> readers_;
};

}  // namespace etcm::simulation

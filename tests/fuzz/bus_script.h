// What a gateway asks of a bus, as bytes say, and that each request comes to one answer.
#pragma once

#include <cstdint>
#include <map>
#include <string_view>

#include "etcm/port/log.h"
#include "etcm/port/node_bus.h"
#include "fuzz_target.h"

namespace etcm::fuzz {

class SilentLog final : public port::Log {
 public:
  void write(port::Level, std::string_view) override {}
};

class BusScript {
 public:
  explicit BusScript(port::NodeBus& bus) : bus_(bus) {}

  port::Instant now() const { return now_; }
  // Starts a request, where the bus takes one: a read, a write, or one of somebody who shares it.
  void ask(Input& input);
  void pass(port::Duration time);
  // Lets time pass until all is answered, for as long as a bus may take.
  void finish();

 private:
  struct Asked {
    std::uint8_t address = 0;
    std::uint16_t count = 0;  // of registers to be read
    std::uint16_t spare = 0;
    bool is_of_client = false;
  };
  void start_read(Input& input);
  void start_write(Input& input);
  void start_request(Input& input);
  void take_answers();

  port::NodeBus& bus_;
  port::Instant now_{std::chrono::hours(1)};
  std::map<std::uint32_t, Asked> asked_;  // by ticket
  std::uint32_t last_ticket_ = 0;
};

}  // namespace etcm::fuzz

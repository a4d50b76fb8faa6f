// A serial line on which any bytes come while the gateway asks: noise, frames with the right
// checksum, and answers that are nearly right.
#include <algorithm>
#include <array>
#include <string>
#include <vector>

#include "bus_script.h"
#include "modbus/rtu_bus.h"

namespace etcm::fuzz {
namespace {

using namespace std::chrono_literals;

// A line whose other end is in the hand of the bytes.
class HeldLine final : public port::RtuLine {
 public:
  bool open(port::Instant, std::string&) override { return true; }
  void close() override { forget_all(); }
  const char* why_gone() const override { return is_gone ? "it is gone" : nullptr; }
  void discard() override { forget_all(); }
  bool is_sent() const override { return true; }
  void bring(std::span<const std::uint8_t> bytes) { hear(bytes); }

  bool is_gone = false;
  std::vector<std::uint8_t> sent;  // the last frame

 private:
  bool write(std::span<const std::uint8_t> frame, std::string&) override {
    require(port::is_rtu_frame(frame), "a request is no frame");
    sent.assign(frame.begin(), frame.end());
    return true;
  }
};

// A frame with the right checksum.
void bring_frame(HeldLine& line, std::uint8_t address, std::span<const std::uint8_t> pdu) {
  std::array<std::uint8_t, port::rtu_frame_bytes_max> frame;
  const std::size_t size = std::min(pdu.size(), port::pdu_bytes_max);
  std::copy_n(pdu.begin(), size, frame.begin() + port::rtu_unit_bytes);
  line.bring(std::span(frame).first(port::wrap_rtu(frame, address, size)));
}

// What a unit would say to the last request, with one byte exchanged at times.
void answer_last(HeldLine& line, Input& input) {
  const std::uint8_t kind = input.byte();
  if (line.sent.size() < 8) return;
  const std::uint8_t function = line.sent[1];
  std::vector<std::uint8_t> pdu{function};
  if (kind % 8 == 0) {
    pdu = {static_cast<std::uint8_t>(function | port::exception_bit), input.byte()};
  } else if (function == 3 || function == 4 || function == 23) {
    const std::size_t bytes = 2u * line.sent[5];
    pdu.push_back(static_cast<std::uint8_t>(bytes));
    for (std::size_t i = 0; i < bytes && i < 250; ++i) pdu.push_back(kind);
  } else {
    pdu.insert(pdu.end(), line.sent.begin() + 2, line.sent.begin() + 6);
  }
  if (kind >= 200) pdu[input.byte() % pdu.size()] = input.byte();
  bring_frame(line, kind % 16 == 1 ? 2 : line.sent[0], pdu);
}

void make_step(BusScript& script, HeldLine& line, Input& input) {
  switch (input.byte() % 8) {
    case 0:
    case 1:
      script.ask(input);
      break;
    case 2:
      line.bring(input.take(input.byte()));
      break;
    case 3: {
      const auto address = static_cast<std::uint8_t>(1 + input.below(3));
      bring_frame(line, address, input.take(1 + input.below(60)));
      break;
    }
    case 4:
    case 5:
      answer_last(line, input);
      break;
    case 6:
      script.pass(input.byte() * 40ms);
      break;
    default:
      line.is_gone = input.byte() % 8 == 0;
  }
  script.pass(2ms);
}

}  // namespace

void run(std::span<const std::uint8_t> bytes) {
  Input input(bytes);
  SilentLog log;
  HeldLine line;
  port::RtuBusOptions options{.name = "yard", .serial_line = {.path = "/dev/null", .baud = 19200}};
  if (input.byte() % 4 == 0) options.clearing = 5s;
  options.quiet = input.byte() % 2 * 200ms;
  options.reopen_interval = 1s;
  port::RtuBus bus(line, log, options);
  BusScript script(bus);
  script.pass(1ms);
  for (int step = 0; step < 200 && !input.is_empty(); ++step) make_step(script, line, input);
  line.is_gone = false;
  script.finish();
}

}  // namespace etcm::fuzz

// Units on a serial line (Modbus RTU), read and written without blocking, one request at a time.
//
// RTU frames carry no number that tells to which request an answer belongs. So that a late answer
// never becomes another request's data:
// - what has arrived is thrown away before a request is sent, and so is what an adapter has not
//   taken of an earlier request;
// - an answer counts only with the unit, function and length that were asked for (of a write: the
//   unit and the range) and the right checksum; other bytes (noise, an echo, another unit's late
//   answer) do not end the wait;
// - after a wait in vain the line stays silent for as long as that unit may still begin to answer:
//   `quiet`, or longer where it once was slower; less once its late answer has passed. Never longer
//   than late_silence_max, and each miss without a late answer halves what is remembered: who falls
//   into another's answer spoils that one, and no more, so waiting longer would cost more;
// - the unit that was waited for in vain is next asked with the other function that reads the same
//   registers (FC 3 after FC 4, FC 4 after FC 3), so that even a later answer does not match. There
//   is no other function that writes: node_bus.h says what follows from that.
#pragma once

#include <array>
#include <optional>
#include <string>

#include "etcm/port/digital_io.h"
#include "etcm/port/log.h"
#include "etcm/port/node_bus.h"
#include "etcm/port/serial_line.h"
#include "modbus/rtu_line.h"
#include "posix/event_loop.h"

namespace etcm::port {

// The line is silent for no longer after a wait in vain, where `quiet` is not longer.
inline constexpr Duration late_silence_max = std::chrono::seconds(1);

struct RtuBusOptions {
  std::string name;  // for the log
  SerialLine line;
  Duration quiet{};            // silence after a wait in vain
  Duration reopen_interval{};  // from one attempt to open the port to the next
  DigitalIo* lines = nullptr;  // with `send_enable`: the line that switches the transceiver
  std::optional<Line> send_enable;
};

class RtuBus final : public NodeBus {
 public:
  // `loop`, `log` and options.lines must outlive the bus. The port is opened by advance().
  RtuBus(EventLoop& loop, Log& log, const RtuBusOptions& options);
  ~RtuBus();
  RtuBus(const RtuBus&) = delete;
  RtuBus& operator=(const RtuBus&) = delete;

  bool ready() const override { return phase_ == Phase::idle && !has_answer_; }
  void start_read(const RegisterRead& read, Instant now) override;
  void start_write(const RegisterWrite& write, Instant now) override;
  void advance(Instant now) override;
  bool take_answer(BusAnswer& answer) override;
  Instant next_deadline() const override;

 private:
  enum class Phase : std::uint8_t {
    closed,   // no port
    idle,     // a request may be sent
    waiting,  // for the answer to request_, which is still being sent before sent_at_
    silent,   // until silent_until_
  };

  struct Request {
    std::uint8_t unit = 0;
    std::uint8_t function = read_input_registers;
    RegisterRange range;
    std::uint32_t ticket = 0;
  };

  // What is remembered of a unit, by its address.
  struct Unit {
    std::uint8_t function = read_input_registers;  // for the next read
    bool owes_answer = false;                      // to the request that was sent at asked_at
    bool is_reported_late = false;
    Instant asked_at{};
    Duration lateness{};  // from the end of a request to the end of a late answer, as remembered
  };

  void send(const Request& request, std::span<std::uint8_t> frame, std::size_t pdu_bytes,
            std::size_t answer_bytes, Duration timeout, Instant now);
  void listen(Instant now);
  void settle(const RtuAnswer& found);
  void settle_read(const RtuAnswer& found);
  void settle_write(const RtuAnswer& found);
  bool note_late(const RtuAnswer& found, Instant now);
  void give_up(Instant now);
  void complete(BusResult result);
  void be_silent(Instant until, Instant at_latest);
  void stop_sending(Instant now);
  void set_send_enable(bool active);
  // Whoever speaks is listened to for so long.
  Duration babble_max() const {
    return static_cast<std::int64_t>(RtuLine::heard_bytes_max) * character_;
  }
  void open(Instant now);
  void close(const std::string& why);

  Log& log_;
  RtuBusOptions options_;
  Duration character_;
  Duration silence_;  // between two frames
  RtuLine line_;
  Phase phase_ = Phase::closed;
  bool reported_closed_ = false;
  bool is_sending_ = false;
  Instant next_attempt_{};

  Request request_;
  Instant sent_at_{};   // when its last bit is on the line
  Instant deadline_{};  // of its answer
  Instant silent_until_{};
  Instant silent_at_latest_{};

  bool heard_wrong_ = false;  // since the last request

  std::array<Unit, 256> units_{};

  bool has_answer_ = false;
  BusAnswer answer_;
  std::array<std::uint16_t, read_registers_max> registers_{};
};

}  // namespace etcm::port

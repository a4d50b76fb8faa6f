// Units on a serial line (Modbus RTU), read and written without blocking, one request at a time.
//
// RTU frames carry no number that tells to which request an answer belongs. So that a late answer
// never becomes another request's data:
// - what has arrived is thrown away before a request is sent, and so is what an adapter has not
//   taken of an earlier request;
// - an answer counts only with the unit, function and length that were asked for (of a write: the
//   unit and the range) and the right checksum; other bytes (noise, an echo, another unit's late
//   answer) do not end the wait;
// - what was waited for in vain may come for late_answer_max, or for half as long again as that
//   unit has ever taken. Until then, or until it has come, nothing is asked that is answered alike
//   (owed_answers.h). So a read goes out with the other function (FC 3 for FC 4), or leaves out
//   registers that are known (RegisterRead::spare); a unit that owes half of what it can be asked
//   is asked at even distances; a write waits. Others are asked meanwhile;
// - an answer that was neither waited for nor owed may be followed by more like it (two units have
//   one address), so nothing is asked that is answered alike for as long as if it had been owed.
//   Where it looks like the answer to what was answered just before, they are two: then what is
//   answered is owed once more (doubled_for);
// - so it is known of a late answer when it was asked for, and the log says how slow the unit is.
//
// Those who share the line (UnitRequest) ask in their own way, so the same is done to them: nothing
// of theirs is sent whose answer would look like one that is under way. An exception that may be an
// earlier question's is not handed to them. And what a unit did not answer to them is asked again
// in twice the time in which the answer may come, with at most client_misses_max such of a unit:
// between them its registers can be read. (With an adapter that hears itself, FC 5, 6 and 22 are
// answered by their own echo, which is the same frame.)
//
// What an earlier run of the program has asked is not known. So nothing is asked before its answers
// have come (RtuBusOptions::clearing): one that were taken for the first question's would leave
// that question's own for the next, and so on.
//
// So that it falls into no other unit's answer either, the line stays silent after a wait in vain
// for as long as that unit may still begin to answer: `quiet`, or longer where it once was slower;
// less once its late answer has passed. Never longer than late_silence_max, and each miss without a
// late answer halves what is remembered: one that falls into another's answer spoils that one, and
// no more, so waiting longer would cost more.
#pragma once

#include <algorithm>
#include <array>
#include <optional>
#include <string>

#include "etcm/port/digital_io.h"
#include "etcm/port/log.h"
#include "etcm/port/node_bus.h"
#include "etcm/port/serial_line.h"
#include "modbus/late_advice.h"
#include "modbus/owed_answers.h"
#include "modbus/rtu_line.h"
#include "modbus/rtu_serial_line.h"

namespace etcm::port {

// The line is silent for no longer after a wait in vain, where `quiet` is not longer.
inline constexpr Duration late_silence_max = std::chrono::seconds(1);

// The pieces in which one answer is heard are no farther apart: an adapter hands on what it has
// every 16 ms, a server in packets.
inline constexpr Duration piece_gap_max = std::chrono::milliseconds(50);

// Requests of others that one unit may owe answers to.
inline constexpr std::size_t client_misses_max = 2;

struct RtuBusOptions {
  std::string name;  // for the log
  SerialLine serial_line;
  std::string address{};  // for the log, of a line over TCP; its bytes take no time
  // Nothing is asked for so long after it has opened for the first time: answers may come to what
  // an earlier run, or another program, has asked.
  Duration clearing{};
  Duration quiet{};            // silence after a wait in vain
  Duration reopen_interval{};  // from one attempt to open the port to the next
  DigitalIo* lines = nullptr;  // with `send_enable`: the line that switches the transceiver
  std::optional<DigitalLine> send_enable{};
};

class RtuBus final : public NodeBus {
 public:
  // `loop`, `log` and options.lines must outlive the bus. The port is opened by advance().
  RtuBus(EventLoop& loop, Log& log, const RtuBusOptions& options);
  // The same on another line than the serial port options.line.path.
  RtuBus(RtuLine& line, Log& log, const RtuBusOptions& options);
  ~RtuBus();
  RtuBus(const RtuBus&) = delete;
  RtuBus& operator=(const RtuBus&) = delete;

  bool ready() const override { return phase_ == Phase::idle && !has_answer_; }
  std::string_view why_down() const override { return why_down_; }
  Instant read_free_at(const RegisterRead& read, Instant now) const override;
  Instant write_free_at(std::uint8_t address) const override {
    return units_[address].owed.owed_until(write_holding_registers);
  }
  // The bytes of the longest request and answer.
  Duration delay_max() const override {
    return static_cast<std::int64_t>(2 * rtu_frame_bytes_max) * character_;
  }
  Instant request_free_at(const UnitRequest& request, Instant now) const override;
  bool is_up() const override { return phase_ != Phase::closed && phase_ != Phase::opening; }
  bool is_clearing(Instant now) const override { return is_up() && now < clear_at_; }
  void start_read(const RegisterRead& read, Instant now) override;
  void start_write(const RegisterWrite& write, Instant now) override;
  void start_request(const UnitRequest& request, Instant now) override;
  void advance(Instant now) override;
  bool take_answer(BusAnswer& answer) override;
  Instant next_deadline() const override;

 private:
  enum class Phase : std::uint8_t {
    closed,   // no port
    opening,  // it will be ready
    idle,     // a request may be sent
    waiting,  // for the answer to request_, which is still being sent before sent_at_
    silent,   // until silent_until_
  };

  struct Request {
    std::uint8_t address = 0;
    RtuQuestion question;
    std::uint16_t left_out = 0;
    std::uint32_t ticket = 0;
    bool is_of_client = false;
  };

  // A client's question that was not answered.
  struct ClientMiss {
    RtuQuestion question;
    Instant owed_until{};
    Instant again_at{};
  };

  // What is remembered of a unit, by its address.
  struct UnitState {
    OwedAnswers owed;
    std::array<ClientMiss, client_misses_max> client_misses{};
    bool has_no_holding = false;  // it refuses FC 3
    LateAdvice advice;
    // From the end of a request to the end of a late answer:
    Duration latest{};    // the longest ever
    Duration lateness{};  // as remembered for the silence of the line
  };
  // The ways to ask for the registers of a read, best first.
  struct Ways {
    static constexpr std::size_t count_max = OwedAnswers::count_max;
    std::array<RtuQuestion, count_max> ways;
    std::size_t count = 0;
  };
  // So long after a wait in vain the answer may still come.
  static Duration latest_of(const UnitState& unit) {
    return std::clamp(unit.latest + unit.latest / 2, late_answer_max, late_answer_longest);
  }
  Ways ways_of(const RegisterRead& read) const;
  std::optional<RtuQuestion> best_way(const RegisterRead& read, Instant now) const;

  void send(const Request& request, std::span<std::uint8_t> frame, std::size_t pdu_bytes,
            std::size_t answer_bytes, Duration timeout, Instant now);
  void listen(Instant now);
  bool is_within_answer(const RtuAnswer& found) const;
  void settle(const RtuAnswer& found, Instant now);
  void settle_for_client(const RtuAnswer& found, Instant now);
  void settle_exception(std::uint8_t exception, Instant now);
  bool note_late(const RtuAnswer& found, Instant now);
  void note_answered(Instant now);
  void note_unasked(const RtuAnswer& found, Instant now);
  void report_late(std::uint8_t address, Duration lateness, Instant now);
  void owe(Instant now);
  void refuse(const Request& request);
  void give_up(Instant now);
  void complete(BusResult result);
  void be_silent(Instant until, Instant at_latest);
  void stop_sending(Instant now);
  void set_send_enable(bool active);
  // A busy line is listened to for so long.
  Duration babble_max() const {
    return static_cast<std::int64_t>(RtuLine::heard_bytes_max) * character_;
  }
  void open(Instant now);
  void become_open(Instant now);
  const std::string& place() const {
    return options_.address.empty() ? options_.serial_line.path : options_.address;
  }
  void close(const std::string& why, Instant now);

  Log& log_;
  RtuBusOptions options_;
  Duration character_;
  Duration silence_;  // between two frames
  std::optional<RtuSerialLine> serial_line_;
  RtuLine& line_;
  Phase phase_ = Phase::closed;
  bool reported_closed_ = false;
  Instant clear_at_ = never;  // from when on it asks; not known before it has opened
  std::string why_down_;
  bool is_sending_ = false;
  Instant next_attempt_{};

  Request request_;
  Instant sent_at_{};   // when its last bit is on the line
  Instant deadline_{};  // of its answer
  Instant silent_until_{};
  Instant silent_at_latest_{};

  bool heard_wrong_ = false;  // since the last request

  std::array<UnitState, 256> units_{};

  bool has_answer_ = false;
  BusAnswer answer_;
  std::array<std::uint16_t, read_registers_max> registers_{};
  std::array<std::uint8_t, pdu_bytes_max> pdu_{};
};

}  // namespace etcm::port

// Units behind one Modbus TCP connection, read and written without blocking, several requests at a
// time.
//
// A late answer can never become another request's data: each request has its own transaction
// number, and an answer whose number is not under way is thrown away. The first number is another
// one at each start: some converters hand the answer to what an earlier connection has asked to the
// next one. How many are under way, and
// for how long each is waited for, follows from how they are answered (transaction_queue.h); the
// log says for each unit how slow it is and what to set, and again (late_advice.h).
//
// A connection can freeze without a word: a converter that hangs, a firewall that has forgotten it.
// So one on which requests were sent and nothing at all came back for tcp_silence_max, or three
// timeouts where that is longer, is given up and made anew. What was sent into it is thrown away,
// as far as the other side has not taken it. No request is cut short by that: no more are taken,
// and those under way have their time. Where the new connection is as silent (all units behind a
// converter are dead), the next comes after twice the time, up to tcp_silence_longest; the log has
// one line until something comes.
#pragma once

#include <array>
#include <bitset>
#include <optional>
#include <string>
#include <vector>

#include "etcm/port/log.h"
#include "etcm/port/node_bus.h"
#include "modbus/late_advice.h"
#include "modbus/tcp_connection.h"
#include "modbus/transaction_queue.h"

namespace etcm::port {

inline constexpr Duration tcp_silence_max = std::chrono::seconds(5);
inline constexpr Duration tcp_silence_longest = std::chrono::minutes(1);

struct TcpBusOptions {
  std::string name;  // for the log
  Endpoint end;
  std::uint32_t outstanding_max = 1;  // requests under way at a time
  Duration reconnect_interval{};      // from one attempt to connect to the next
};

class TcpBus final : public NodeBus, private FrameConnection::Listener {
 public:
  // `loop` and `log` must outlive the bus.
  TcpBus(EventLoop& loop, Log& log, const TcpBusOptions& options);
  // The same over another connection than one of the system.
  TcpBus(FrameConnection& connection, Log& log, const TcpBusOptions& options);

  bool ready() const override;
  std::string_view why_down() const override { return why_down_; }
  void start_read(const RegisterRead& read, Instant now) override;
  void start_write(const RegisterWrite& write, Instant now) override;
  void start_request(const UnitRequest& request, Instant now) override;
  bool is_up() const override { return connection_.state() == FrameConnection::State::up; }
  void advance(Instant now) override;
  std::optional<std::uint8_t> take_held_up() override { return queue_.take_held_up(); }
  bool take_answer(BusAnswer& answer) override;
  Instant next_deadline() const override;
  bool is_one_line() const override { return queue_.is_one_line(); }
  Duration delay_max() const override { return queue_.delay_max(); }

 private:
  struct Completed {
    std::uint8_t address = 0;
    std::uint32_t ticket = 0;
    BusResult result = BusResult::ok;
    std::uint8_t exception = 0;
    Duration silence{};
    std::uint16_t count = 0;  // of registers that were read
    std::array<std::uint16_t, read_registers_max> registers;
    std::size_t pdu_bytes = 0;  // of the answer to a UnitRequest
    std::array<std::uint8_t, pdu_bytes_max> pdu;
  };

  void on_connected() override;
  void on_frame(const Frame& frame) override;
  void on_lost(const char* why) override;
  // Nothing that is under way will be answered.
  void abandon_all();
  void send(TcpRequest request, std::span<std::uint8_t> frame, std::size_t pdu_bytes, Instant now);
  void settle(const TcpRequest& request, const Frame& frame);
  Completed& place();
  void complete(const TcpRequest& request, BusResult result);
  void report_late(const LateTransaction& late, Instant now);
  void give_up_silent(Instant now);
  // Nothing is waited for any more, or something has come.
  void start_listening();
  void note_up();
  void connect(Instant now);

  Log& log_;
  TcpBusOptions options_;
  std::optional<TcpConnection> tcp_connection_;
  FrameConnection& connection_;
  bool reported_down_ = false;
  std::string why_down_;
  Instant next_attempt_{};

  std::optional<Instant> unheard_since_;  // a request was sent, and nothing has come since then
  std::bitset<256> heard_{};              // units that have answered
  std::bitset<256> asked_in_silence_{};   // since then
  // One was asked since then that has answered before, or that was asked since then.
  bool is_answer_due_ = false;
  Duration slowest_timeout_{};              // of the requests since then
  Duration silence_max_ = tcp_silence_max;  // longer where the connection before was as silent
  bool is_silent_ = false;                  // for longer than it may be
  std::uint16_t last_transaction_ = 0;
  TransactionQueue queue_;
  std::array<LateAdvice, 256> advice_{};  // by unit
  std::vector<Completed> completed_;      // a ring; never more than outstanding_max are in it
  std::size_t completed_begin_ = 0;
  std::size_t completed_count_ = 0;
};

}  // namespace etcm::port

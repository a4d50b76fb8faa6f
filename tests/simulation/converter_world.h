// A converter from Modbus TCP to a serial line: one request after the other, and those that wait
// wait. What stood in its queue when a connection ended it may hand to the next one.
#pragma once

#include <deque>
#include <vector>

#include "bus_clients.h"
#include "device.h"
#include "modbus/frame_connection.h"

namespace etcm::simulation {

struct ConverterHabits {
  Duration hold{};             // for who says nothing
  bool says_nobody = true;     // then: exception 0x0b; else nothing
  bool keeps_queue = false;    // over connections
  std::size_t queue_max = 16;  // more are dropped
};

class ConverterWorld final : public port::FrameConnection {
 public:
  ConverterWorld(const ConverterHabits& habits, Duration timeout, std::vector<Device*>& devices,
                 inputs::Random& random);

  State state() const override { return state_; }
  void connect(const port::Endpoint& end, Instant now, Duration time_max) override;
  void advance(Instant now) override;
  Instant next_deadline() const override { return port::never; }
  void send(std::span<std::uint8_t> frame, std::uint16_t transaction, std::uint8_t address,
            std::size_t pdu_bytes) override;
  void discard() override {}
  void close() override;
  void abort() override { close(); }

  void pass_to(Instant now);
  Instant next() const;
  // The connection ends, and none can be made while it is cut.
  void cut(bool is_now_cut);
  bool is_cut() const { return is_cut_; }

  BusClients* clients = nullptr;  // who share the line behind it
  bool hangs = false;             // takes requests, and says nothing
  std::vector<Instant> asked_at;
  std::vector<Instant> asked_before;  // the time before that

 private:
  struct Request {
    std::uint16_t transaction = 0;
    std::uint8_t address = 0;
    std::uint64_t connection = 0;
    Instant sent_at{};
    bool is_clients = false;
    std::vector<std::uint8_t> pdu;
  };
  void begin();
  void finish();

  const ConverterHabits habits_;
  const Duration timeout_;
  std::vector<Device*>& devices_;
  inputs::Random& random_;
  State state_ = State::down;
  bool is_cut_ = false;
  std::uint64_t connection_ = 0;
  Instant now_{};
  std::deque<Request> queue_;  // the first one is on the line
  Instant done_at_ = port::never;
  std::vector<std::uint8_t> said_;
  Device* answered_ = nullptr;
};

}  // namespace etcm::simulation

// A serial line with devices on it, byte by byte in simulated time: answers that are late, meet
// each other or a question, and bytes that nobody has sent. It may be behind a server that hands
// its bytes on over a network, in pieces.
#pragma once

#include <vector>

#include "bus_clients.h"
#include "device.h"
#include "etcm/port/serial_line.h"
#include "modbus/rtu_line.h"

namespace etcm::simulation {

class RtuWorld final : public port::RtuLine {
 public:
  // `network_max`: what bytes take over the network at the most, each way; nothing where there is
  // none.
  RtuWorld(const port::SerialLine& line, Duration network_max, Duration timeout,
           std::vector<Device*>& devices, inputs::Random& random);

  bool open(Instant now, std::string& why) override;
  void close() override;
  const char* why_gone() const override {
    return is_open_ && is_cut ? "the adapter was pulled out" : nullptr;
  }
  void discard() override { forget_all(); }
  bool is_sent() const override { return true; }

  // What is due by now is heard.
  void pass_to(Instant now);
  Instant next() const;

  BusClients* clients = nullptr;  // who share the line
  bool is_cut = false;
  bool has_noise = false;
  // When the gateway asked for a position last, by unit.
  std::vector<Instant> asked_at;
  std::vector<Instant> asked_before;  // the time before that

 private:
  struct Sending {
    Instant begin;
    Instant end;
    std::vector<std::uint8_t> bytes;
    std::size_t heard = 0;  // of them
    std::size_t piece = 0;  // so many are heard before the others, at `piece_at`
    Instant piece_at{};
    Instant next() const { return heard < piece ? piece_at : end; }
    Device* answered = nullptr;  // soundly, where it arrives as it is
    bool is_spoilt = false;
    Device* said_by = nullptr;
    std::uint8_t unit = 0;
    // When its unit had been asked for a position, and whether somebody else had answered that when
    // the unit was asked again.
    Instant question{};
    bool is_second = false;
  };

  bool write(std::span<const std::uint8_t> frame, std::string& why) override;
  void answer(Device& device, std::span<const std::uint8_t> frame, bool is_clients, Instant asked);
  void spoil(Sending& sending);
  void note_question(std::uint8_t unit);
  void note_heard(const Sending& sending);
  void show_harm(Sending& sending, std::span<std::uint8_t> piece);
  Duration on_the_network();
  Duration time_of(std::size_t bytes) const {
    return static_cast<std::int64_t>(bytes) * character_;
  }

  const Duration character_;
  const Duration silence_;
  const Duration network_max_;
  const Duration timeout_;
  std::vector<Device*>& devices_;
  inputs::Random& random_;
  bool is_open_ = false;
  Instant now_{};
  std::vector<Sending> sendings_;
  std::vector<bool> has_answered_;   // by unit, since it was asked for a position
  std::vector<std::uint8_t> heard_;  // since the last question
};

}  // namespace etcm::simulation

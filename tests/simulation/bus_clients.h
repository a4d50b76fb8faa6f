// Programs that share a bus with the gateway. They ask its units as they like, also what the
// gateway asks; each request must have one answer, of its unit and to its question.
#pragma once

#include <deque>
#include <string>
#include <vector>

#include "device.h"
#include "etcm/port/line_clients.h"

namespace etcm::simulation {

class BusClients final : public port::LineClients {
 public:
  // As the settings have it: who has waited for so long is told that the bus is busy.
  static constexpr Duration wait_max = std::chrono::milliseconds(500);

  BusClients(const std::vector<Device*>& devices, std::uint8_t units, inputs::Random random)
      : devices_(devices), units_(units), random_(random) {}

  // So many requests come at once.
  void ask(std::size_t count);
  // There is always one that waits.
  bool is_flooding = false;
  // Those that have waited for too long are gone. The gateway has started anew: all are.
  void pass_to(Instant now);
  void forget_all();

  // Whether this is the request that the gateway has just taken; each is sent once.
  bool is_sending(std::uint8_t unit, std::span<const std::uint8_t> pdu);

  // What an answer was wrong with; empty: nothing.
  const std::string& wrong() const { return wrong_; }
  // A request is under way for so long.
  Duration under_way_for(Instant now) const { return is_under_way_ ? now - taken_at_ : Duration{}; }

  bool is_waiting() const override { return !is_under_way_ && !waiting_.empty(); }
  bool next(port::ClientRequest& request) override;
  void answer(std::span<const std::uint8_t> pdu) override;
  void refuse(port::ClientRefusal why) override;
  bool is_shared() const override { return true; }
  const port::ClientCounters& counters() const override { return counters_; }

 private:
  struct Request {
    std::uint8_t unit = 0;
    std::vector<std::uint8_t> pdu;
    Instant since{};
  };
  bool is_doubled(std::uint8_t unit) const;
  std::string look_at(std::span<const std::uint8_t> pdu) const;

  const std::vector<Device*>& devices_;
  const std::uint8_t units_;
  inputs::Random random_;
  Instant now_{};
  std::deque<Request> waiting_;
  Request under_way_;
  bool is_under_way_ = false;
  bool is_sent_ = false;
  Instant taken_at_{};
  std::string wrong_;
  port::ClientCounters counters_;
};

}  // namespace etcm::simulation

// A line with devices of other makers, for the gateway of fakes.h.
#pragma once

#include <gtest/gtest.h>

#include <cstdint>
#include <functional>
#include <map>
#include <optional>
#include <vector>

#include "etcm/port/node_bus.h"

namespace etcm::firmware {

// A line with devices: each has registers of its own, and answers what is asked of it after
// `latency`, one request at a time.
class DeviceBus final : public port::NodeBus {
 public:
  struct Asked {
    std::uint8_t address;
    port::RegisterKind kind;
    std::uint16_t first, count;
    port::Instant at;
    friend bool operator==(const Asked&, const Asked&) = default;
  };

  bool ready() const override { return !request_ && !is_closed; }
  bool is_one_line() const override { return true; }
  void start_read(const port::RegisterRead& read, port::Instant now) override {
    asked.push_back({read.address, read.kind, read.first, read.count, now});
    request_ = read;
    done_at_ = now + (is_silent(read.address) ? read.timeout : latency);
  }
  void start_write(const port::RegisterWrite& write, port::Instant) override {
    ADD_FAILURE() << "wrote to unit " << int{write.address};
  }
  void start_request(const port::UnitRequest& request, port::Instant) override {
    ADD_FAILURE() << "shared unit " << int{request.address};
  }
  void advance(port::Instant now) override { now_ = now; }
  bool take_answer(port::BusAnswer& answer) override {
    if (!request_ || now_ < done_at_) return false;
    answer = {.address = request_->address, .ticket = request_->ticket, .registers = {}};
    handed_.clear();
    if (is_silent(request_->address)) {
      answer.result = port::BusResult::timeout;
    } else {
      const auto& registers = devices.at(request_->address);
      for (unsigned at = request_->first; at < request_->first + unsigned{request_->count}; ++at) {
        const auto found = registers.find(static_cast<std::uint16_t>(at));
        if (found == registers.end()) {
          answer.result = port::BusResult::exception;
          answer.exception = 2;
          break;
        }
        handed_.push_back(found->second);
      }
    }
    answer.registers = handed_;
    request_.reset();
    if (on_answer) on_answer(asked.back());
    return true;
  }
  port::Instant next_deadline() const override { return request_ ? done_at_ : port::never; }

  void put(std::uint8_t unit, std::uint16_t first, const std::vector<std::uint16_t>& values) {
    for (std::size_t i = 0; i < values.size(); ++i) {
      devices[unit][static_cast<std::uint16_t>(first + i)] = values[i];
    }
  }
  void silence(std::uint8_t unit) { devices.erase(unit); }
  bool is_silent(std::uint8_t unit) const { return !devices.contains(unit); }

  port::Duration latency = std::chrono::milliseconds(5);
  bool is_closed = false;  // it takes no request
  std::map<std::uint8_t, std::map<std::uint16_t, std::uint16_t>> devices;
  std::vector<Asked> asked;
  std::function<void(const Asked&)> on_answer;

 private:
  std::optional<port::RegisterRead> request_;
  port::Instant done_at_{}, now_{};
  std::vector<std::uint16_t> handed_;
};

}  // namespace etcm::firmware

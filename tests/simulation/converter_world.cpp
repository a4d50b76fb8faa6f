#include "converter_world.h"

#include <utility>

namespace etcm::simulation {

using namespace std::chrono_literals;

namespace {
constexpr Duration on_the_line = 25ms;
constexpr std::uint8_t nobody_there = 0x0b;
}  // namespace

ConverterWorld::ConverterWorld(const ConverterHabits& habits, Duration timeout,
                               std::vector<Device*>& devices, inputs::Random& random)
    : asked_at(256),
      asked_before(256),
      habits_(habits),
      timeout_(timeout),
      devices_(devices),
      random_(random) {}

void ConverterWorld::connect(const port::Endpoint&, Instant, Duration) {
  if (is_cut_) {
    listener().on_lost("connection refused");
    return;
  }
  ++connection_;
  state_ = State::up;
  if (!habits_.keeps_queue) {
    queue_.clear();
    done_at_ = port::never;
  }
  listener().on_connected();
}

void ConverterWorld::advance(Instant) {}

void ConverterWorld::send(std::span<std::uint8_t> frame, std::uint16_t transaction,
                          std::uint8_t address, std::size_t pdu_bytes) {
  const auto pdu = frame.subspan(port::mbap_header_bytes, pdu_bytes);
  const bool is_clients = clients != nullptr && clients->is_sending(address, pdu);
  if (!is_clients && begins_a_sweep(pdu)) {
    asked_before[address] = std::exchange(asked_at[address], now_);
  }
  if (hangs || queue_.size() >= habits_.queue_max) return;
  queue_.push_back({.transaction = transaction,
                    .address = address,
                    .connection = connection_,
                    .sent_at = now_,
                    .is_clients = is_clients,
                    .pdu = {pdu.begin(), pdu.end()}});
  if (queue_.size() == 1) begin();
}

void ConverterWorld::close() { state_ = State::down; }

void ConverterWorld::cut(bool is_now_cut) {
  is_cut_ = is_now_cut;
  if (!is_cut_ || state_ == State::down) return;
  state_ = State::down;
  listener().on_lost("connection reset by peer");
}

void ConverterWorld::begin() {
  const Request& request = queue_.front();
  done_at_ = now_ + on_the_line + habits_.hold;
  said_.clear();
  answered_ = nullptr;
  // Of two with one address the first one is understood, and half of the time nobody.
  std::size_t answers = 0;
  for (Device* const device : devices_) {
    if (device->unit != request.address) continue;
    const auto said = device->hear(request.pdu, now_ + on_the_line / 2, timeout_, random_);
    if (!said || ++answers > 1 || said->after > habits_.hold) continue;
    const bool is_spoilt =
        (device->ailment == Ailment::noisy || device->ailment == Ailment::cut_off) &&
        random_.below(2) == 0;
    if (is_spoilt) continue;
    done_at_ = now_ + on_the_line + said->after;
    said_ = said->pdu;
    // It has waited behind others.
    if (said->is_sound && !request.is_clients && done_at_ < request.sent_at + timeout_)
      answered_ = device;
  }
  if (answers > 1 && random_.below(2) == 0) {
    said_.clear();
    answered_ = nullptr;
  }
  if (said_.empty()) done_at_ = now_ + on_the_line + habits_.hold;
}

void ConverterWorld::finish() {
  const Request request = std::move(queue_.front());
  queue_.pop_front();
  std::vector<std::uint8_t> said = std::move(said_);
  Device* const answered = answered_;
  done_at_ = port::never;
  if (!queue_.empty()) begin();
  if (said.empty()) {
    if (!habits_.says_nobody) return;
    said = {static_cast<std::uint8_t>(request.pdu[0] | 0x80), nobody_there};
  }
  if (state_ != State::up || hangs) return;
  if (answered != nullptr && request.connection == connection_) answered->note_answer(now_);
  listener().on_frame(
      {.transaction = request.transaction, .address = request.address, .pdu = said});
}

void ConverterWorld::pass_to(Instant now) {
  while (done_at_ <= now) {
    now_ = done_at_;
    finish();
  }
  now_ = now;
}

Instant ConverterWorld::next() const { return done_at_; }

}  // namespace etcm::simulation

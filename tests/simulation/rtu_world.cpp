#include "rtu_world.h"

#include <algorithm>
#include <utility>

namespace etcm::simulation {

using namespace std::chrono_literals;

namespace {

// The checksum of Modbus over Serial Line, section 6.2.2.
std::uint16_t checksum(std::span<const std::uint8_t> bytes) {
  std::uint16_t sum = 0xffff;
  for (const std::uint8_t byte : bytes) {
    sum = static_cast<std::uint16_t>(sum ^ byte);
    for (int bit = 0; bit < 8; ++bit) {
      sum = static_cast<std::uint16_t>(sum & 1 ? sum >> 1 ^ 0xa001 : sum >> 1);
    }
  }
  return sum;
}

}  // namespace

RtuWorld::RtuWorld(const port::SerialLine& line, Duration network_max, Duration timeout,
                   std::vector<Device*>& devices, inputs::Random& random)
    : asked_at(256),
      asked_before(256),
      character_(character_time(line)),
      silence_(frame_silence(line)),
      network_max_(network_max),
      timeout_(timeout),
      devices_(devices),
      random_(random),
      has_answered_(256) {}

bool RtuWorld::open(Instant, std::string& why) {
  is_open_ = !is_cut;
  if (is_open_) return true;
  why = "no such device";
  return false;
}

void RtuWorld::close() {
  // Devices go on talking; nobody hears it.
  is_open_ = false;
  forget_all();
}

bool RtuWorld::write(std::span<const std::uint8_t> frame, std::string& why) {
  if (is_cut) {
    why = "it is gone";
    return false;
  }
  heard_.clear();
  const Instant asked = now_ + on_the_network() + time_of(frame.size());
  const bool is_clients =
      clients != nullptr && clients->is_sending(frame[0], frame.subspan(1, frame.size() - 3));
  if (!is_clients && begins_a_sweep(frame.subspan(1, frame.size() - 3))) note_question(frame[0]);
  // Two who talk at once spoil each other's bytes.
  bool is_heard = true;
  for (Sending& sending : sendings_) {
    if (sending.begin < asked && asked - time_of(frame.size()) < sending.end) {
      spoil(sending);
      is_heard = false;
    }
  }
  if (has_noise && random_.below(8) == 0) is_heard = false;
  const auto body = frame.first(frame.size() - 2);
  const std::uint16_t sum = checksum(body);
  if (frame[frame.size() - 2] != (sum & 0xff) || frame.back() != sum >> 8) return true;
  for (Device* const device : devices_) {
    if (device->unit != frame[0]) continue;
    if (is_heard) answer(*device, frame, is_clients, asked);
    if (!is_heard && !is_clients) ++device->spoilt;
  }
  return true;
}

void RtuWorld::note_question(std::uint8_t unit) {
  for (Sending& sending : sendings_) {
    if (sending.unit == unit && has_answered_[unit]) sending.is_second = true;
  }
  has_answered_[unit] = false;
  asked_before[unit] = std::exchange(asked_at[unit], now_);
}

void RtuWorld::note_heard(const Sending& sending) {
  has_answered_[sending.unit] = true;
  sending.said_by->second_to = sending.is_second ? sending.question : port::never;
}

void RtuWorld::answer(Device& device, std::span<const std::uint8_t> frame, bool is_clients,
                      Instant asked) {
  const auto said = device.hear(frame.subspan(1, frame.size() - 3), asked, timeout_, random_);
  if (!said) return;
  Sending sending;
  sending.bytes.push_back(frame[0]);
  sending.bytes.insert(sending.bytes.end(), said->pdu.begin(), said->pdu.end());
  const std::uint16_t sum = checksum(sending.bytes);
  sending.bytes.push_back(static_cast<std::uint8_t>(sum));
  sending.bytes.push_back(static_cast<std::uint8_t>(sum >> 8));
  sending.begin = asked + silence_ + said->after;
  sending.end = sending.begin + time_of(sending.bytes.size());
  sending.answered = said->is_sound && !is_clients ? &device : nullptr;
  sending.said_by = &device;
  sending.unit = frame[0];
  sending.question = asked_at[frame[0]];
  if (device.ailment == Ailment::noisy && random_.below(2) == 0) spoil(sending);
  if (device.ailment == Ailment::cut_off && random_.below(2) == 0) {
    sending.bytes.resize(1 + random_.index(sending.bytes.size() - 1));
    sending.answered = nullptr;
    sending.is_spoilt = true;
  }
  if (has_noise && random_.below(4) == 0) {
    const std::size_t count = 1 + random_.index(6);
    for (std::size_t i = 0; i < count; ++i) {
      sending.bytes.insert(sending.bytes.begin(), static_cast<std::uint8_t>(random_.next()));
    }
    sending.answered = nullptr;
  }
  if (network_max_ > Duration{}) {
    sending.piece = random_.index(sending.bytes.size());
    sending.piece_at = sending.begin + time_of(sending.piece) + on_the_network();
    sending.end = std::max(sending.end, sending.piece_at) + on_the_network();
    if (sending.end - now_ > timeout_) sending.answered = nullptr;
  } else {
    // A port hands on what has come so far, which ends anywhere in an answer.
    const auto place = static_cast<std::uint64_t>(sending.begin.time_since_epoch() / 1us);
    sending.piece = place % sending.bytes.size();
    sending.piece_at = std::min(sending.end, sending.begin + time_of(sending.piece));
  }
  for (Sending& other : sendings_) {
    if (other.begin < sending.end && sending.begin < other.end) {
      spoil(other);
      spoil(sending);
    }
  }
  sendings_.push_back(std::move(sending));
}

// One burst of up to sixteen bits, which the checksum always shows; once, for two may undo it.
void RtuWorld::spoil(Sending& sending) {
  if (sending.answered != nullptr) ++sending.answered->spoilt;
  sending.answered = nullptr;
  if (sending.is_spoilt) return;
  sending.is_spoilt = true;
  const std::size_t left = sending.bytes.size() - sending.heard;
  if (left == 0) return;
  const std::size_t at = sending.heard + random_.index(left);
  const std::size_t next = std::min(at + 1, sending.bytes.size() - 1);
  sending.bytes[at] = static_cast<std::uint8_t>(sending.bytes[at] ^ (1 + random_.below(255)));
  if (next != at) {
    sending.bytes[next] = static_cast<std::uint8_t>(sending.bytes[next] ^ random_.below(256));
  }
}

// Where the bytes of two meet, one in 65536 of what comes of them has the right checksum by chance,
// and nobody could know: not here.
void RtuWorld::show_harm(Sending& sending, std::span<std::uint8_t> piece) {
  if (piece.empty()) return;
  constexpr std::size_t head = 3, sum = 2;
  heard_.insert(heard_.end(), piece.begin(), piece.end());
  for (std::size_t begin = 0; begin + head <= heard_.size(); ++begin) {
    const std::span rest = std::span(heard_).subspan(begin);
    const std::size_t size = head + rest[2] + sum;
    if ((rest[1] != read_holding && rest[1] != read_input) || size > rest.size()) continue;
    if (rest.size() - size >= piece.size()) continue;  // it was judged when it came
    const std::span frame = rest.first(size);
    if (checksum(frame) != 0) continue;
    // What one has sent as it is may have such a frame in the middle too.
    const bool is_sent =
        !sending.is_spoilt && std::search(sending.bytes.begin(), sending.bytes.end(), frame.begin(),
                                          frame.end()) != sending.bytes.end();
    if (is_sent) continue;
    const std::size_t behind = rest.size() - size;
    piece[piece.size() - 1 - behind] ^= 1;
    heard_[heard_.size() - 1 - behind] ^= 1;
    sending.answered = nullptr;
    break;
  }
}

void RtuWorld::pass_to(Instant now) {
  const auto is_sooner = [](const Sending& a, const Sending& b) { return a.next() < b.next(); };
  while (next() <= now) {
    const auto sending = std::min_element(sendings_.begin(), sendings_.end(), is_sooner);
    const bool is_whole = sending->heard >= sending->piece;
    const std::size_t upto = is_whole ? sending->bytes.size() : sending->piece;
    if (is_open_ && !is_cut) {
      const std::span piece(sending->bytes.data() + sending->heard, upto - sending->heard);
      show_harm(*sending, piece);
      hear(piece);
      if (is_whole && sending->answered != nullptr) sending->answered->note_answer(sending->end);
      if (is_whole && !sending->is_spoilt) note_heard(*sending);
    } else {
      sending->answered = nullptr;
    }
    sending->heard = upto;
    if (is_whole) sendings_.erase(sending);
  }
  now_ = now;
}

Instant RtuWorld::next() const {
  Instant next = port::never;
  for (const Sending& sending : sendings_) next = std::min(next, sending.next());
  return next;
}

Duration RtuWorld::on_the_network() {
  return network_max_ > Duration{}
             ? random_.below(static_cast<std::uint64_t>(network_max_ / 1ms)) * 1ms
             : Duration{};
}

}  // namespace etcm::simulation

// A converter that sends any bytes over its connection while the gateway asks: frames of any
// number, answers that are nearly right, and what is no Modbus.
#include <algorithm>
#include <array>
#include <deque>
#include <vector>

#include "bus_script.h"
#include "modbus/frame.h"
#include "modbus/tcp_bus.h"

namespace etcm::fuzz {
namespace {

using namespace std::chrono_literals;

// Cuts the bytes as a TCP connection does.
class HeldConnection final : public port::FrameConnection {
 public:
  State state() const override { return state_; }
  void connect(const port::Endpoint&, port::Instant, port::Duration) override {
    state_ = State::up;
    reader_.clear();
    listener().on_connected();
  }
  void advance(port::Instant) override {}
  port::Instant next_deadline() const override { return port::never; }
  void send(std::span<std::uint8_t> frame, std::uint16_t transaction, std::uint8_t unit,
            std::size_t pdu_bytes) override {
    const std::size_t size = port::write_header(frame, transaction, unit, pdu_bytes);
    sent.emplace_back(frame.begin(), frame.begin() + static_cast<std::ptrdiff_t>(size));
    if (sent.size() > 8) sent.pop_front();
  }
  void discard() override { reader_.clear(); }
  void close() override { state_ = State::down; }
  void abort() override { close(); }

  void lose() {
    if (state_ != State::up) return;
    close();
    listener().on_lost("it is gone");
  }
  void bring(std::span<const std::uint8_t> bytes) {
    while (state_ == State::up && !bytes.empty()) {
      const auto room = reader_.free_space();
      require(!room.empty(), "a reader without room");
      const std::size_t size = std::min(room.size(), bytes.size());
      std::copy_n(bytes.begin(), size, room.begin());
      reader_.received(size);
      bytes = bytes.subspan(size);
      take_frames();
    }
  }

  std::deque<std::vector<std::uint8_t>> sent;  // the last frames

 private:
  void take_frames() {
    port::Frame frame;
    while (state_ == State::up) {
      switch (reader_.next(frame)) {
        case port::FrameReader::Next::frame:
          listener().on_frame(frame);
          break;
        case port::FrameReader::Next::incomplete:
          return;
        case port::FrameReader::Next::broken:
          return lose();
      }
    }
  }

  State state_ = State::down;
  port::FrameReader reader_;
};

void answer_one(HeldConnection& connection, Input& input) {
  const std::uint8_t which = input.byte(), kind = input.byte();
  if (connection.sent.empty()) return;
  const std::vector<std::uint8_t>& request = connection.sent[which % connection.sent.size()];
  std::vector<std::uint8_t> answer(request.begin(), request.begin() + 8);
  if (kind % 8 == 0) {
    answer[7] |= port::exception_bit;
    answer.push_back(static_cast<std::uint8_t>(kind / 8));
  } else if (request[7] == 3 || request[7] == 4) {
    const std::size_t bytes = 2u * request[11];
    answer.push_back(static_cast<std::uint8_t>(bytes));
    answer.resize(answer.size() + bytes, kind);
  } else if (request.size() >= 12) {
    answer.insert(answer.end(), request.begin() + 8, request.begin() + 12);
  }
  const std::size_t length = answer.size() - 6;
  answer[4] = static_cast<std::uint8_t>(length >> 8);
  answer[5] = static_cast<std::uint8_t>(length);
  if (kind >= 200) answer[input.byte() % answer.size()] = input.byte();
  connection.bring(answer);
}

void make_step(BusScript& script, HeldConnection& connection, Input& input) {
  switch (input.byte() % 8) {
    case 0:
    case 1:
    case 2:
      script.ask(input);
      break;
    case 3:
    case 4:
      answer_one(connection, input);
      break;
    case 5:
      connection.bring(input.take(input.byte()));
      break;
    case 6:
      script.pass(input.byte() * 40ms);
      break;
    default:
      if (input.byte() % 4 == 0) connection.lose();
  }
  script.pass(2ms);
}

}  // namespace

void run(std::span<const std::uint8_t> bytes) {
  Input input(bytes);
  SilentLog log;
  HeldConnection connection;
  port::TcpBus bus(connection, log,
                   {.name = "yard",
                    .end = {.host = "127.0.0.1", .port = 502},
                    .outstanding_max = 1 + input.below(16),
                    .reconnect_interval = 1s});
  BusScript script(bus);
  script.pass(1ms);
  for (int step = 0; step < 200 && !input.is_empty(); ++step) make_step(script, connection, input);
  script.finish();
}

}  // namespace etcm::fuzz

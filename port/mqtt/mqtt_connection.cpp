#include "mqtt/mqtt_connection.h"

#include <algorithm>
#include <utility>

namespace etcm::port {

namespace {

using namespace std::chrono_literals;

// Buffers that go through in one step at the most: others wait for the loop.
constexpr int rounds_max = 16;
constexpr Duration wake_interval = 1s;
// Answers to packets that may wait in libmosquitto: who sends and does not read is not read from.
constexpr std::size_t unanswered_max = 1000;

}  // namespace

std::span<std::uint8_t> MqttConnection::Buffer::space() {
  std::copy(bytes_.begin() + static_cast<std::ptrdiff_t>(begin_),
            bytes_.begin() + static_cast<std::ptrdiff_t>(end_), bytes_.begin());
  end_ -= std::exchange(begin_, 0);
  return std::span(bytes_).subspan(end_);
}

MqttConnection::MqttConnection(EventLoop& loop, FileDescriptor socket, const TlsContext* tls,
                               const std::string& host, const MqttGreeting& greeting,
                               MosquittoClient::Listener& listener)
    : loop_(loop), stream_(std::move(socket), tls, host), client_(loop, greeting, listener) {
  loop_.add(stream_.descriptor(), *this, wants_read_, wants_write_);
}

MqttConnection::~MqttConnection() { loop_.remove(stream_.descriptor()); }

void MqttConnection::step(Instant now) {
  if (next_wake_ <= now) {
    next_wake_ = now + wake_interval;
    client_.wake();
  }
  has_more_ = true;
  for (int round = 0; round < rounds_max && has_more_ && !is_over(); ++round) {
    const bool has_sent = carry_out();
    const bool has_received = carry_in();
    has_more_ = has_sent || has_received;
  }
  if (!is_over()) watch();
}

// From libmosquitto to the network; whether any went.
bool MqttConnection::carry_out() {
  client_.write_packets();
  const std::size_t fetched = client_.fetch(out_.space());
  out_.add(fetched);
  const std::size_t sent = stream_.write(out_.content());
  out_.drop(sent);
  if (out_.is_empty() && !client_.has_queued()) unanswered_ = 0;
  return fetched + sent > 0;
}

// From the network to libmosquitto.
bool MqttConnection::carry_in() {
  std::size_t received = 0;
  std::size_t packets = 1;  // one whose end may have come
  if (in_.is_empty() && may_read()) {
    const std::span<std::uint8_t> space = in_.space();
    received = stream_.read(space);
    const std::size_t begun = guard_.packets_begun();
    if (!guard_.pass(space.first(received))) {
      guard_why_ = guard_.why();
      return false;
    }
    in_.add(received);
    packets += guard_.packets_begun() - begun;
    unanswered_ += guard_.packets_begun() - begun;
  }
  const std::size_t taken = client_.hand_over(in_.content());
  in_.drop(taken);
  client_.read_packets(packets);
  return received + taken > 0;
}

bool MqttConnection::may_read() const { return unanswered_ < unanswered_max; }

void MqttConnection::watch() {
  const bool wants_read = in_.is_empty() && may_read();
  const bool wants_write = stream_.wants_write();
  if (wants_read != wants_read_ || wants_write != wants_write_) {
    wants_read_ = wants_read;
    wants_write_ = wants_write;
    loop_.change(stream_.descriptor(), wants_read, wants_write);
  }
  client_.let_fetch(!out_.space().empty());
  has_more_ = has_more_ || (wants_read && stream_.has_pending());
}

std::string MqttConnection::why_over() const {
  if (guard_why_ != nullptr) return guard_why_;
  return stream_.is_lost() ? stream_.why_lost() : client_.why_over();
}

void MqttConnection::leave() {
  client_.leave();
  for (int round = 0; round < rounds_max && carry_out(); ++round) {
  }
}

}  // namespace etcm::port

// A connection to a broker, and the session of MQTT 5 on it: carries bytes between libmosquitto and
// the network, a bounded number in each step, and lets pass what a broker may send.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>

#include "mqtt/broker_stream.h"
#include "mqtt/mosquitto_client.h"
#include "mqtt/packet_guard.h"
#include "posix/event_loop.h"

namespace etcm::port {

class MqttConnection final : private EventHandler {
 public:
  // Over a socket that is connected; `loop`, `tls`, if not null, and `listener` must outlive it.
  // Throws std::runtime_error as MosquittoClient does.
  MqttConnection(EventLoop& loop, FileDescriptor socket, const TlsContext* tls,
                 const std::string& host, const MqttGreeting& greeting,
                 MosquittoClient::Listener& listener);
  ~MqttConnection();
  MqttConnection(const MqttConnection&) = delete;
  MqttConnection& operator=(const MqttConnection&) = delete;

  MosquittoClient& client() { return client_; }

  // Carries what there is, both ways.
  void step(Instant now);
  Instant next_deadline() const { return has_more_ ? Instant{} : next_wake_; }

  bool is_over() const { return stream_.is_lost() || client_.is_over() || guard_why_ != nullptr; }
  // Why; empty where the listener was told.
  std::string why_over() const;

  // Whether it broke off without a reason.
  bool is_cut() const { return guard_why_ == nullptr && stream_.is_cut(); }

  // Says good-bye; what the socket does not take at once is lost.
  void leave();

 private:
  // Bytes on their way through.
  class Buffer {
   public:
    std::span<std::uint8_t> space();
    std::span<const std::uint8_t> content() const {
      return std::span(bytes_).subspan(begin_, end_ - begin_);
    }
    bool is_empty() const { return begin_ == end_; }
    void add(std::size_t count) { end_ += count; }
    void drop(std::size_t count) { begin_ += count; }

   private:
    std::array<std::uint8_t, 16384> bytes_;
    std::size_t begin_ = 0;
    std::size_t end_ = 0;
  };

  void on_ready(bool, bool) override {}
  bool carry_out();
  bool carry_in();
  bool may_read() const;
  void watch();

  EventLoop& loop_;
  BrokerStream stream_;
  PacketGuard guard_{MosquittoClient::packet_bytes_max};
  MosquittoClient client_;
  std::size_t unanswered_ = 0;  // packets that came while what is sent waits
  Buffer out_;
  Buffer in_;
  const char* guard_why_ = nullptr;
  bool wants_read_ = true;
  bool wants_write_ = true;
  bool has_more_ = true;
  Instant next_wake_{};
};

}  // namespace etcm::port

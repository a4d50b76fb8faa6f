// One session of MQTT 5 by libmosquitto, from its greeting to its end.
//
// libmosquitto sees a connection within this machine and nothing of the network: what it writes is
// fetched here, and what the broker has sent is handed to it, after a look at it. So neither name
// servers nor TLS nor an address that swallows packets are ever waited for in it. A session that
// has ended takes all of libmosquitto's memory with it.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <string>

#include "etcm/port/message_broker.h"
#include "posix/event_loop.h"
#include "posix/file_descriptor.h"

struct mosquitto;

namespace etcm::port {

struct MqttWill {
  std::string topic;  // empty: there is none
  std::string payload;
  bool retained = false;
};

struct MqttGreeting {
  std::string client_id;
  std::string user;      // empty: none
  std::string password;  // empty: none
  std::uint16_t keep_alive_s = 60;
  MqttWill will;
};

class MosquittoClient final : private EventHandler {
 public:
  // All of it is called from within read_packets(), write_packets() and wake(), if nothing else is
  // said; reason codes are those of MQTT 5.
  class Listener {
   public:
    virtual void on_greeted(int reason) = 0;
    virtual void on_packet(const BrokerMessage& message) = 0;
    // Of a message that is sent at most once: it has left, maybe before publish() returns.
    virtual void on_published(int packet, int reason) = 0;
    virtual void on_subscribed(int packet, int reason) = 0;
    // The broker ends the session, and says why.
    virtual void on_farewell(int reason) = 0;

   protected:
    ~Listener() = default;
  };

  // The largest packet that a broker is told to send.
  static constexpr std::uint32_t packet_bytes_max =
      static_cast<std::uint32_t>(broker_message_bytes_max) + 1024;

  // Greets at once. Throws std::runtime_error where there is no memory, or no descriptor.
  MosquittoClient(EventLoop& loop, const MqttGreeting& greeting, Listener& listener);
  ~MosquittoClient();
  MosquittoClient(const MosquittoClient&) = delete;
  MosquittoClient& operator=(const MosquittoClient&) = delete;

  bool is_over() const { return is_over_; }
  // Empty where the broker has said it, by a farewell.
  const std::string& why_over() const { return why_over_; }

  // What goes to the broker: fetched from libmosquitto; 0 where there is nothing.
  std::size_t fetch(std::span<std::uint8_t> bytes);
  // What has come from the broker; returns how many were taken.
  std::size_t hand_over(std::span<const std::uint8_t> bytes);
  // Lets libmosquitto take in as many packets, as far as they are there whole, and write.
  void read_packets(std::size_t packets);
  void write_packets();
  // Whether something waits in it to be fetched later.
  bool has_queued() const;
  // Lets it send what is to be sent now and then; once a second.
  void wake();

  // While nobody fetches, what is there to fetch wakes nobody either.
  void let_fetch(bool is_wanted);

  enum class Sent : std::uint8_t {
    yes,
    later,    // not now
    refused,  // not ever: the broker has said that it takes nothing of this length
  };
  // `packet` is how the answer to it will be known.
  Sent publish(const BrokerMessage& message, int& packet);
  Sent subscribe(const std::string& filter, int& packet);
  // Says good-bye, so that the broker tells the last will at once; it is still to be fetched.
  void leave();

 private:
  class Callbacks;  // what libmosquitto calls
  struct Destroy {
    void operator()(mosquitto* client) const;
  };

  void on_ready(bool, bool) override {}
  void greet(const MqttGreeting& greeting);
  void connect_inside(std::uint16_t keep_alive_s);
  void take_greeting(int theirs, const FileDescriptor& socket);
  void check(int result);

  EventLoop& loop_;
  Listener& listener_;
  std::unique_ptr<mosquitto, Destroy> client_;
  std::vector<std::uint8_t> greeting_;  // that is still to be fetched
  FileDescriptor inside_;               // our end of the connection
  FileDescriptor theirs_;  // another descriptor of libmosquitto's end, which it may close
  bool is_fetch_wanted_ = true;
  bool is_over_ = false;
  std::string why_over_;
};

}  // namespace etcm::port

// A broker that is reached by MQTT 5, over TCP or TLS. The design, and what may hold up the loop
// for how long, is in README.md.
#pragma once

#include <array>
#include <optional>
#include <string>
#include <vector>

#include "etcm/port/endpoint.h"
#include "etcm/port/log.h"
#include "etcm/port/message_broker.h"
#include "mqtt/mqtt_connection.h"
#include "mqtt/mqtt_reason.h"
#include "mqtt/reconnect_pause.h"
#include "mqtt/tls_context.h"
#include "posix/event_loop.h"
#include "posix/tcp_connector.h"

namespace etcm::port {

struct MqttBrokerOptions {
  Endpoint end;
  std::string client_id;
  // By which it goes on where another client has taken its place as client_id: of one id a broker
  // has one client, and two that come back would throw each other out for ever. Empty: none.
  std::string spare_client_id{};
  std::string user;      // empty: none
  std::string password;  // empty: none
  Duration keep_alive{};
  std::optional<TlsOptions> tls;
};

class MqttBroker final : public MessageBroker,
                         private TcpConnector::Listener,
                         private MosquittoClient::Listener {
 public:
  // Messages that may be under way at a time; their bytes are at most broker_held_bytes_max.
  static constexpr std::size_t messages_max = 32;
  // What libmosquitto may hold of the heap, whatever the broker does, beside the copies of will and
  // filters: messages under way, one that is coming, answers that the broker does not take. With
  // TLS OpenSSL has its buffers beside it, some 32 KiB.
  static constexpr std::size_t heap_bytes_max = std::size_t{2} * 1024 * 1024;
  // From a connection to the broker's greeting.
  static constexpr Duration greeting_time_max = std::chrono::seconds(10);
  // A session that was up for so long is no failure when it ends.
  static constexpr Duration good_session = std::chrono::seconds(30);

  // Connects with the first step. `loop` and `log` must outlive it. Throws std::runtime_error as
  // TlsContext does.
  MqttBroker(EventLoop& loop, Log& log, const MqttBrokerOptions& options);
  // Says good-bye, and waits for nothing.
  ~MqttBroker();
  MqttBroker(const MqttBroker&) = delete;
  MqttBroker& operator=(const MqttBroker&) = delete;

  bool is_connected() const override { return is_connected_; }
  std::string_view why_down() const override { return why_down_; }
  const BrokerCounters& counters() const override { return counters_; }
  void set_listener(BrokerListener* listener) override { listener_ = listener; }
  void set_last_will(const BrokerMessage& message) override;
  void subscribe(std::span<const std::string> filters) override;
  bool publish(const BrokerMessage& message, std::uint32_t token) override;
  void step(Instant now) override;
  Instant next_deadline() const override;

 private:
  struct Message {
    bool is_free = true;
    // What is not told yet.
    bool is_refused = false;
    bool has_left = false;
    int packet = 0;
    std::uint32_t token = 0;
    std::size_t bytes = 0;
    std::string topic;
  };
  struct Filter {
    std::string text;
    bool is_sent = false;
    int packet = 0;
  };

  void on_socket(FileDescriptor socket) override;
  void on_failure(const char* why) override;
  void on_greeted(int reason) override;
  void on_packet(const BrokerMessage& message) override;
  void on_published(int packet, int reason) override;
  void on_subscribed(int packet, int reason) override;
  void on_farewell(int reason) override;

  void open_session();
  void begin();
  void end(const std::string& why);
  void send_filters();
  void tell_settled();
  bool has_under_way() const;
  void deliver(Message& message);
  void refuse(Message& message, const std::string& why);
  std::string why_lost();
  bool take_spare_id();
  std::string port_cure() const;
  std::string place() const { return "broker " + to_string(options_.end); }

  EventLoop& loop_;
  Log& log_;
  const MqttBrokerOptions options_;
  MqttNames names_;
  std::optional<TlsContext> tls_;
  BrokerListener* listener_ = nullptr;
  BrokerCounters counters_;
  MqttWill will_;
  std::vector<Filter> filters_;
  std::array<Message, messages_max> messages_;
  std::size_t bytes_under_way_ = 0;
  int left_at_once_ = 0;  // the last packet that had left before it was known

  enum class State : std::uint8_t { pausing, connecting, greeting, up };
  State state_ = State::pausing;
  TcpConnector connector_{loop_, *this};
  FileDescriptor socket_;  // that was connected, for the next step
  std::string failure_;    // what the next step is to end with
  bool is_greeted_ = false;
  bool is_connected_ = false;
  bool is_taken_over_ = false;
  bool may_be_taken_over_ = false;
  // One message at a time: the session before this one was cut with some under way.
  // Mosquitto 2.0.11 hangs up after a refusal, and where more has come by then, the refusal is
  // lost.
  bool is_careful_ = false;
  bool has_refused_ = false;  // in this session
  unsigned cuts_ = 0;         // short sessions in a row that ended without a word
  std::optional<MqttConnection> connection_;
  ReconnectPause pause_{options_.client_id};
  Instant now_{};
  Instant deadline_{};  // of the pause or the greeting
  Instant up_since_{};
  std::string why_down_;
  std::string told_;  // to the log
};

}  // namespace etcm::port

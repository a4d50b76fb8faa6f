#include "mqtt/mosquitto_client.h"

#include <fcntl.h>
#include <mosquitto.h>
#include <mqtt_protocol.h>
#include <sys/socket.h>

#include <algorithm>
#include <array>
#include <stdexcept>
#include <string_view>
#include <utility>

#include "posix/tcp_socket.h"

namespace etcm::port {

namespace {

// Messages that may be under way to us at a time: of a large site many come between two turns of a
// loop that has a mesh to make. They are not kept here.
constexpr int receive_maximum = 500;
constexpr int send_maximum = 64;
constexpr int inside_bytes = 65536;

struct Properties {
  mosquitto_property* list = nullptr;
  Properties() = default;
  Properties(const Properties&) = delete;
  Properties& operator=(const Properties&) = delete;
  ~Properties() { mosquitto_property_free_all(&list); }
};

void need(bool is_good, const char* what) {
  if (!is_good) throw std::runtime_error(what);
}

constexpr const char* no_memory = "no memory for a session";
constexpr const char* no_connection = "no connection within this machine, to 127.0.0.1";

}  // namespace

class MosquittoClient::Callbacks {
 public:
  static void set(mosquitto* client) {
    mosquitto_connect_v5_callback_set(client, &greeted);
    mosquitto_disconnect_v5_callback_set(client, &ended);
    mosquitto_message_v5_callback_set(client, &message);
    mosquitto_publish_v5_callback_set(client, &published);
    mosquitto_subscribe_v5_callback_set(client, &subscribed);
  }

 private:
  static MosquittoClient& of(void* self) { return *static_cast<MosquittoClient*>(self); }

  // What it does without would be left out without a word.
  static void greeted(mosquitto*, void* self, int reason, int,
                      const mosquitto_property* properties) noexcept {
    std::uint8_t retains = 1;
    std::uint8_t qos = 1;
    mosquitto_property_read_byte(properties, MQTT_PROP_RETAIN_AVAILABLE, &retains, false);
    mosquitto_property_read_byte(properties, MQTT_PROP_MAXIMUM_QOS, &qos, false);
    if (reason == MQTT_RC_SUCCESS && retains == 0) reason = MQTT_RC_RETAIN_NOT_SUPPORTED;
    if (reason == MQTT_RC_SUCCESS && qos == 0) reason = MQTT_RC_QOS_NOT_SUPPORTED;
    of(self).listener_.on_greeted(reason);
  }
  // Where libmosquitto itself ends a session, a function of it returns the reason too.
  static void ended(mosquitto*, void* self, int reason, const mosquitto_property*) noexcept {
    MosquittoClient& client = of(self);
    client.is_over_ = true;
    const bool is_of_broker =
        reason >= MQTT_RC_UNSPECIFIED || reason == MQTT_RC_NORMAL_DISCONNECTION;
    if (is_of_broker) client.listener_.on_farewell(reason);
  }
  static void message(mosquitto*, void* self, const mosquitto_message* message,
                      const mosquitto_property*) noexcept {
    const auto size = static_cast<std::size_t>(message->payloadlen);
    of(self).listener_.on_packet(
        {.topic = message->topic,
         .payload = std::string_view(static_cast<const char*>(message->payload), size),
         .retained = message->retain});
  }
  static void published(mosquitto*, void* self, int packet, int reason,
                        const mosquitto_property*) noexcept {
    of(self).listener_.on_published(packet, reason);
  }
  static void subscribed(mosquitto*, void* self, int packet, int count, const int* granted,
                         const mosquitto_property*) noexcept {
    of(self).listener_.on_subscribed(packet, count > 0 ? granted[0] : MQTT_RC_UNSPECIFIED);
  }
};

void MosquittoClient::Destroy::operator()(mosquitto* client) const { mosquitto_destroy(client); }

MosquittoClient::MosquittoClient(EventLoop& loop, const MqttGreeting& greeting, Listener& listener)
    : loop_(loop), listener_(listener) {
  static const bool is_ready = mosquitto_lib_init() == MOSQ_ERR_SUCCESS;
  need(is_ready, no_memory);
  client_.reset(mosquitto_new(greeting.client_id.c_str(), true, this));
  need(client_ != nullptr, no_memory);
  greet(greeting);
  connect_inside(greeting.keep_alive_s);
  loop_.add(inside_.get(), *this, true, false);
  loop_.add(theirs_.get(), *this, true, false);
}

MosquittoClient::~MosquittoClient() {
  loop_.remove(inside_.get());
  loop_.remove(theirs_.get());
}

void MosquittoClient::greet(const MqttGreeting& greeting) {
  mosquitto* const client = client_.get();
  Callbacks::set(client);
  bool is_good =
      mosquitto_int_option(client, MOSQ_OPT_PROTOCOL_VERSION, MQTT_PROTOCOL_V5) ==
          MOSQ_ERR_SUCCESS &&
      mosquitto_int_option(client, MOSQ_OPT_RECEIVE_MAXIMUM, receive_maximum) == MOSQ_ERR_SUCCESS &&
      mosquitto_int_option(client, MOSQ_OPT_SEND_MAXIMUM, send_maximum) == MOSQ_ERR_SUCCESS &&
      mosquitto_int_option(client, MOSQ_OPT_TCP_NODELAY, 1) == MOSQ_ERR_SUCCESS;
  if (!greeting.user.empty()) {
    is_good = is_good && mosquitto_username_pw_set(
                             client, greeting.user.c_str(),
                             greeting.password.empty() ? nullptr : greeting.password.c_str()) ==
                             MOSQ_ERR_SUCCESS;
  }
  const MqttWill& will = greeting.will;
  if (!will.topic.empty()) {
    is_good = is_good && mosquitto_will_set_v5(
                             client, will.topic.c_str(), static_cast<int>(will.payload.size()),
                             will.payload.data(), 1, will.retained, nullptr) == MOSQ_ERR_SUCCESS;
  }
  need(is_good, no_memory);
}

// libmosquitto connects to a port that is there for no longer than this takes; who else connects to
// it meanwhile is not the one. A pair of sockets then takes the place of that connection: each
// packet that libmosquitto sends and each of the four reads that it takes one in by cost half.
void MosquittoClient::connect_inside(std::uint16_t keep_alive_s) {
  constexpr int strangers_max = 16;
  Properties properties;
  need(mosquitto_property_add_int32(&properties.list, MQTT_PROP_MAXIMUM_PACKET_SIZE,
                                    packet_bytes_max) == MOSQ_ERR_SUCCESS &&
           // Reasons in words would come with answers whose memory it forgets.
           mosquitto_property_add_byte(&properties.list, MQTT_PROP_REQUEST_PROBLEM_INFORMATION,
                                       0) == MOSQ_ERR_SUCCESS,
       no_memory);
  const FileDescriptor listener = try_listen_tcp({.host = loopback_ipv4, .port = 0});
  need(listener.is_open() &&
           mosquitto_connect_bind_v5(client_.get(), "127.0.0.1", bound_address(listener.get()).port,
                                     keep_alive_s, nullptr, properties.list) == MOSQ_ERR_SUCCESS,
       no_connection);
  const int theirs = mosquitto_socket(client_.get());
  FileDescriptor socket;
  for (int i = 0; i <= strangers_max && !socket.is_open(); ++i) {
    SocketAddress peer;
    FileDescriptor accepted = accept_tcp(listener.get(), &peer);
    if (accepted.is_open() && peer == bound_address(theirs)) socket = std::move(accepted);
  }
  need(socket.is_open(), no_connection);
  take_greeting(theirs, socket);
  int ends[2];
  need(::socketpair(AF_UNIX, SOCK_STREAM | SOCK_NONBLOCK | SOCK_CLOEXEC, 0, ends) == 0,
       no_connection);
  inside_ = FileDescriptor(ends[0]);
  theirs_ = FileDescriptor(ends[1]);
  // What is on its way within the machine is bounded too.
  for (const int end : ends) {
    ::setsockopt(end, SOL_SOCKET, SO_SNDBUF, &inside_bytes, sizeof inside_bytes);
  }
  need(::dup3(theirs_.get(), theirs, O_CLOEXEC) == theirs, no_connection);
}

// What it has sent by then. Nothing else is on that connection, and its end is within this machine.
void MosquittoClient::take_greeting(int theirs, const FileDescriptor& socket) {
  ::shutdown(theirs, SHUT_WR);
  ::fcntl(socket.get(), F_SETFL, 0);
  std::array<std::uint8_t, 4096> bytes{};
  for (ssize_t count = 1; count > 0;) {
    count = ::recv(socket.get(), bytes.data(), bytes.size(), 0);
    if (count > 0) greeting_.insert(greeting_.end(), bytes.data(), bytes.data() + count);
  }
}

std::size_t MosquittoClient::fetch(std::span<std::uint8_t> bytes) {
  if (bytes.empty()) return 0;
  if (!greeting_.empty()) {
    const std::size_t taken = std::min(bytes.size(), greeting_.size());
    std::copy_n(greeting_.begin(), taken, bytes.begin());
    greeting_.erase(greeting_.begin(), greeting_.begin() + static_cast<std::ptrdiff_t>(taken));
    return taken;
  }
  const ssize_t count = ::recv(inside_.get(), bytes.data(), bytes.size(), 0);
  return count > 0 ? static_cast<std::size_t>(count) : 0;
}

std::size_t MosquittoClient::hand_over(std::span<const std::uint8_t> bytes) {
  if (bytes.empty() || is_over_) return 0;
  const ssize_t count = ::send(inside_.get(), bytes.data(), bytes.size(), MSG_NOSIGNAL);
  return count > 0 ? static_cast<std::size_t>(count) : 0;
}

void MosquittoClient::read_packets(std::size_t packets) {
  for (std::size_t i = 0; i < packets && !is_over_; ++i) {
    check(mosquitto_loop_read(client_.get(), 1));
  }
}

void MosquittoClient::write_packets() {
  if (!is_over_ && mosquitto_want_write(client_.get())) {
    check(mosquitto_loop_write(client_.get(), 1));
  }
}

bool MosquittoClient::has_queued() const {
  return !is_over_ && mosquitto_want_write(client_.get());
}

void MosquittoClient::wake() {
  if (!is_over_) check(mosquitto_loop_misc(client_.get()));
}

void MosquittoClient::let_fetch(bool is_wanted) {
  if (is_fetch_wanted_ == is_wanted) return;
  is_fetch_wanted_ = is_wanted;
  loop_.change(inside_.get(), is_wanted, false);
}

MosquittoClient::Sent MosquittoClient::publish(const BrokerMessage& message, int& packet) {
  if (is_over_) return Sent::later;
  const std::string topic(message.topic);
  switch (mosquitto_publish_v5(client_.get(), &packet, topic.c_str(),
                               static_cast<int>(message.payload.size()), message.payload.data(),
                               message.at_most_once ? 0 : 1, message.retained, nullptr)) {
    case MOSQ_ERR_SUCCESS:
      return Sent::yes;
    case MOSQ_ERR_OVERSIZE_PACKET:
    case MOSQ_ERR_INVAL:
    case MOSQ_ERR_MALFORMED_UTF8:
      return Sent::refused;
    default:
      return Sent::later;
  }
}

MosquittoClient::Sent MosquittoClient::subscribe(const std::string& filter, int& packet) {
  if (is_over_) return Sent::later;
  const int result = mosquitto_subscribe_v5(client_.get(), &packet, filter.c_str(), 1, 0, nullptr);
  return result == MOSQ_ERR_SUCCESS ? Sent::yes : Sent::later;
}

void MosquittoClient::leave() {
  if (is_over_) return;
  mosquitto_disconnect_v5(client_.get(), MQTT_RC_DISCONNECT_WITH_WILL_MSG, nullptr);
  is_over_ = true;
}

void MosquittoClient::check(int result) {
  if (result == MOSQ_ERR_SUCCESS) return;
  is_over_ = true;
  if (why_over_.empty()) {
    why_over_ = result == MOSQ_ERR_KEEPALIVE ? "it does not answer any more"
                                             : std::string("no sound MQTT 5 comes from it (") +
                                                   mosquitto_strerror(result) + ")";
  }
}

}  // namespace etcm::port

#include "mqtt/mqtt_broker.h"

#include <algorithm>
#include <stdexcept>
#include <utility>

namespace etcm::port {

namespace {

constexpr int failure_least = 0x80;  // of the reason codes

}  // namespace

MqttBroker::MqttBroker(EventLoop& loop, Log& log, const MqttBrokerOptions& options)
    : loop_(loop),
      log_(log),
      options_(options),
      names_{.client_id = options.client_id, .user = options.user} {
  if (!options_.tls) return;
  tls_.emplace(*options_.tls);
  names_.tls_name = tls_->own_name();
}

MqttBroker::~MqttBroker() {
  if (connection_) connection_->leave();
}

void MqttBroker::set_last_will(const BrokerMessage& message) {
  will_ = {.topic = std::string(message.topic),
           .payload = std::string(message.payload),
           .retained = message.retained};
}

void MqttBroker::subscribe(std::span<const std::string> filters) {
  for (const std::string& text : filters) {
    const auto is_same = [&](const Filter& filter) { return filter.text == text; };
    if (std::none_of(filters_.begin(), filters_.end(), is_same)) filters_.push_back({.text = text});
  }
}

bool MqttBroker::publish(const BrokerMessage& message, std::uint32_t token) {
  if (!is_connected_) return false;
  const std::size_t bytes = message.topic.size() + message.payload.size();
  if (bytes_under_way_ + bytes > broker_held_bytes_max) return false;
  if (is_careful_ && has_under_way()) return false;
  const auto free = std::find_if(messages_.begin(), messages_.end(),
                                 [](const Message& place) { return place.is_free; });
  if (free == messages_.end()) return false;
  int packet = 0;
  left_at_once_ = 0;
  const MosquittoClient::Sent sent = connection_->client().publish(message, packet);
  if (sent == MosquittoClient::Sent::later) return false;
  free->is_free = false;
  free->is_refused = sent == MosquittoClient::Sent::refused;
  free->has_left = sent == MosquittoClient::Sent::yes && left_at_once_ == packet;
  free->packet = packet;
  free->token = token;
  free->bytes = bytes;
  free->topic = message.topic;
  bytes_under_way_ += bytes;
  counters_.held_bytes_most = std::max(counters_.held_bytes_most, std::uint64_t{bytes_under_way_});
  return true;
}

void MqttBroker::step(Instant now) {
  now_ = now;
  connector_.advance(now);
  if (socket_.is_open()) open_session();
  if (is_connected_) send_filters();
  if (connection_) {
    connection_->step(now);
    if (failure_.empty() && connection_->is_over()) failure_ = why_lost();
  }
  tell_settled();
  if (failure_.empty() && is_greeted_ && !is_connected_) begin();
  if (failure_.empty() && state_ == State::greeting && deadline_ <= now) {
    failure_ = "connected, but it does not answer" + port_cure();
  }
  if (!failure_.empty()) end(std::exchange(failure_, {}));
  if (state_ == State::pausing && deadline_ <= now) {
    state_ = State::connecting;
    connector_.start(options_.end, now);
  }
}

Instant MqttBroker::next_deadline() const {
  if (socket_.is_open() || !failure_.empty()) return {};
  const bool is_told_soon =
      std::any_of(messages_.begin(), messages_.end(), [](const Message& message) {
        return !message.is_free && (message.is_refused || message.has_left);
      });
  const bool asks =
      is_connected_ && std::any_of(filters_.begin(), filters_.end(),
                                   [](const Filter& filter) { return !filter.is_sent; });
  if (is_told_soon || asks) return {};
  const bool has_deadline = state_ == State::pausing || state_ == State::greeting;
  return std::min({connector_.next_deadline(), has_deadline ? deadline_ : never,
                   connection_ ? connection_->next_deadline() : never});
}

std::string MqttBroker::why_lost() {
  std::string why = connection_->why_over();
  if (!connection_->is_cut()) return why;
  if (state_ == State::greeting) return why + " before it answered" + port_cure();
  if (has_refused_) return why + " after it has refused a message";
  // Some brokers say nothing to a client whose name another one takes.
  may_be_taken_over_ = cuts_++ > 0 && now_ - up_since_ < good_session;
  return may_be_taken_over_
             ? why + ", again and again; another client may have come as '" + names_.client_id +
                   "': give each gateway a name of its own; or the broker lets it tell nothing: "
                   "look at its log and its access list"
             : why;
}

// Where its place was taken, or may have been. False: it has no other id to go on by.
bool MqttBroker::take_spare_id() {
  const bool has_spare =
      !options_.spare_client_id.empty() && names_.client_id == options_.client_id;
  if (!has_spare) return false;
  names_.client_id = options_.spare_client_id;
  cuts_ = 0;
  pause_.shorten();
  return true;
}

std::string MqttBroker::port_cure() const {
  return tls_ ? "; give the port of a broker for MQTT over TLS (usually 8883)"
              : "; give the port of a broker for MQTT, and tls_ca or psk_file where it wants TLS";
}

void MqttBroker::on_socket(FileDescriptor socket) { socket_ = std::move(socket); }

void MqttBroker::on_failure(const char* why) { failure_ = why; }

void MqttBroker::open_session() {
  const auto keep_alive = std::chrono::duration_cast<std::chrono::seconds>(options_.keep_alive);
  state_ = State::greeting;
  deadline_ = now_ + greeting_time_max;
  is_greeted_ = false;
  try {
    connection_.emplace(loop_, std::move(socket_), tls_ ? &*tls_ : nullptr, options_.end.host,
                        MqttGreeting{.client_id = names_.client_id,
                                     .user = options_.user,
                                     .password = options_.password,
                                     .keep_alive_s = static_cast<std::uint16_t>(keep_alive.count()),
                                     .will = will_},
                        static_cast<MosquittoClient::Listener&>(*this));
  } catch (const std::runtime_error& error) {
    failure_ = error.what();
  }
}

void MqttBroker::on_greeted(int reason) {
  if (reason < failure_least) {
    is_greeted_ = true;
    return;
  }
  failure_ = explain_refusal(reason, names_);
  // The first id may be the one that is let in alone.
  if (std::exchange(names_.client_id, options_.client_id) != options_.client_id) {
    pause_.lengthen();
  }
}

// The session stands.
void MqttBroker::begin() {
  state_ = State::up;
  is_connected_ = true;
  up_since_ = now_;
  has_refused_ = false;
  why_down_.clear();
  told_.clear();
  ++counters_.connections;
  log_.write(Level::info, place() + ": connected as " + names_.client_id);
  send_filters();
  if (listener_ != nullptr) listener_->on_connected(now_);
}

void MqttBroker::end(const std::string& why) {
  const bool is_cut = connection_ && connection_->is_cut();
  if (is_connected_) is_careful_ = is_cut && (has_refused_ || has_under_way());
  connection_.reset();
  socket_.close();
  connector_.stop();
  for (Message& message : messages_) message.is_free = true;
  for (Filter& filter : filters_) filter.is_sent = false;
  bytes_under_way_ = 0;
  is_greeted_ = false;
  ++counters_.failures;
  why_down_ = place() + ": " + why;
  if (std::exchange(told_, why) != why) {
    log_.write(Level::warning, why_down_ + "; trying again");
  }
  if (is_connected_ && now_ - up_since_ >= good_session) {
    pause_.note_lasting();
    cuts_ = 0;
  }
  const bool was_taken = std::exchange(is_taken_over_, false);
  const bool may_be = std::exchange(may_be_taken_over_, false) || was_taken;
  const bool goes_on = may_be && take_spare_id();
  if (was_taken && !goes_on) pause_.lengthen();
  state_ = State::pausing;
  deadline_ = now_ + pause_.take();
  if (std::exchange(is_connected_, false) && listener_ != nullptr) {
    listener_->on_disconnected(why_down_, now_);
  }
}

void MqttBroker::send_filters() {
  for (Filter& filter : filters_) {
    if (filter.is_sent) continue;
    filter.is_sent =
        connection_->client().subscribe(filter.text, filter.packet) == MosquittoClient::Sent::yes;
  }
}

void MqttBroker::on_packet(const BrokerMessage& message) {
  if (!is_connected_) return;
  ++counters_.received;
  if (listener_ != nullptr) listener_->on_message(message, now_);
}

void MqttBroker::on_published(int packet, int reason) {
  left_at_once_ = packet;
  const auto found = std::find_if(messages_.begin(), messages_.end(), [&](const Message& message) {
    return !message.is_free && !message.is_refused && message.packet == packet;
  });
  if (found == messages_.end()) return;
  if (reason >= failure_least) return refuse(*found, explain_denial(reason, names_));
  deliver(*found);
}

// What was known when it was published, for whoever published it did not expect an answer then.
void MqttBroker::tell_settled() {
  for (Message& message : messages_) {
    if (message.is_free) continue;
    if (message.has_left) {
      deliver(message);
    } else if (message.is_refused) {
      refuse(message, "it takes no message of " + std::to_string(message.bytes) +
                          " bytes; raise its maximum packet size");
    }
  }
}

void MqttBroker::deliver(Message& message) {
  message.is_free = true;
  bytes_under_way_ -= message.bytes;
  ++counters_.delivered;
  if (listener_ != nullptr) listener_->on_delivered(message.token, now_);
}

bool MqttBroker::has_under_way() const {
  return std::any_of(messages_.begin(), messages_.end(),
                     [](const Message& message) { return !message.is_free; });
}

void MqttBroker::refuse(Message& message, const std::string& why) {
  has_refused_ = true;
  message.is_free = true;
  bytes_under_way_ -= message.bytes;
  ++counters_.refused;
  const std::string line = place() + ": message for " + message.topic + " is refused: " + why;
  log_.write(Level::error, line);
  if (listener_ != nullptr) listener_->on_refused(message.token, line, now_);
}

void MqttBroker::on_subscribed(int packet, int reason) {
  if (reason < failure_least) return;
  const auto found = std::find_if(filters_.begin(), filters_.end(), [&](const Filter& filter) {
    return filter.is_sent && filter.packet == packet;
  });
  if (found == filters_.end()) return;
  log_.write(Level::error, place() + ": it gives no messages of " + found->text + ": " +
                               explain_denial(reason, names_));
}

void MqttBroker::on_farewell(int reason) {
  is_taken_over_ = is_taken_over(reason);
  failure_ = explain_farewell(reason, names_);
}

}  // namespace etcm::port

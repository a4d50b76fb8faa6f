#include "firmware/app/broker_link.h"

#include <algorithm>
#include <array>
#include <cstdio>
#include <iterator>
#include <random>
#include <stdexcept>
#include <string>

#include "firmware/config/secret_file.h"

namespace etcm::firmware {

namespace {

// What it was built without.
std::string lacking(const MqttSettings& mqtt) {
#ifndef ETCM_WITH_MQTT
  static_cast<void>(mqtt);
  return "the settings have [mqtt], but this gateway was built without libmosquitto; install "
         "libmosquitto-dev and libssl-dev and build it again, or take [mqtt] out";
#elif !defined(ETCM_WITH_SPARKPLUG)
  if (!mqtt.sparkplug.empty()) {
    return "[mqtt] has sparkplug, but this gateway was built without nanopb; install nanopb and "
           "libnanopb-dev and build it again, or take sparkplug out";
  }
  return {};
#else
  static_cast<void>(mqtt);
  return {};
#endif
}

}  // namespace

#ifdef ETCM_WITH_MQTT

namespace {

using namespace std::chrono_literals;

constexpr port::Duration keep_alive_most = 65535s;  // MQTT has 16 bits for it

std::string content_of(const std::string& path,
                       std::string (*read)(const std::string&, std::string&)) {
  if (path.empty()) return {};
  std::string why;
  std::string content = read(path, why);
  if (content.empty()) throw std::runtime_error("[mqtt]: " + why);
  return content;
}

bool lacks_credential(const MqttSettings& mqtt) {
  const std::string* const files[] = {&mqtt.password_file, &mqtt.psk_file, &mqtt.tls_ca,
                                      &mqtt.tls_certificate, &mqtt.tls_key};
  return std::any_of(std::begin(files), std::end(files), [](const std::string* path) {
    std::string why;
    return is_credential(*path) && read_secret(*path, why).empty();
  });
}

// That nobody else comes upon, or knows.
std::string any_number_text() {
  std::random_device chance;
  std::array<char, 16> text{};
  std::snprintf(text.data(), text.size(), "%08x", chance());
  return text.data();
}

port::MqttBrokerOptions options_of(const MqttSettings& mqtt) {
  port::MqttBrokerOptions options{.end = mqtt.broker,
                                  .client_id = mqtt.site + ":" + mqtt.name,
                                  .user = mqtt.user,
                                  .password = content_of(mqtt.password_file, read_secret),
                                  .keep_alive = std::min(mqtt.keep_alive, keep_alive_most),
                                  .tls = {}};
  if (!mqtt.tls_ca.empty() || !mqtt.psk_file.empty()) {
    options.tls = port::TlsOptions{.ca = mqtt.tls_ca,
                                   .certificate = mqtt.tls_certificate,
                                   .key = mqtt.tls_key,
                                   .psk_identity = mqtt.psk_identity,
                                   .psk = content_of(mqtt.psk_file, read_key)};
  }
  return options;
}

}  // namespace

std::string broker_mistake(const Settings& settings, bool is_check) {
  if (!settings.mqtt) return {};
  std::string what = lacking(*settings.mqtt);
  if (!what.empty() || (is_check && lacks_credential(*settings.mqtt))) return what;
  try {
    const port::MqttBrokerOptions options = options_of(*settings.mqtt);
    if (options.tls) static_cast<void>(port::TlsContext(*options.tls));
  } catch (const std::runtime_error& error) {
    what = error.what();
  }
  return what;
}

BrokerLink::BrokerLink(const Settings& settings, port::EventLoop& loop, port::Log& log) {
  if (!settings.mqtt) return;
  if (const std::string what = lacking(*settings.mqtt); !what.empty()) {
    throw std::runtime_error(what);
  }
  port::MqttBrokerOptions options = options_of(*settings.mqtt);
  options.spare_client_id = options.client_id + ":" + any_number_text();
  broker_ = std::make_unique<port::MqttBroker>(loop, log, options);
  if (settings.mqtt->sparkplug.empty()) return;
  // Two edge nodes of one name would only confuse their host.
  options.spare_client_id.clear();
  options.client_id += ":sparkplug";
  sparkplug_ = std::make_unique<port::MqttBroker>(loop, log, options);
}

port::MessageBroker* BrokerLink::broker() { return broker_.get(); }

port::MessageBroker* BrokerLink::sparkplug() { return sparkplug_.get(); }

void BrokerLink::step(port::Instant now) {
  if (broker_) broker_->step(now);
  if (sparkplug_) sparkplug_->step(now);
}

port::Instant BrokerLink::next_deadline() const {
  return std::min(broker_ ? broker_->next_deadline() : port::never,
                  sparkplug_ ? sparkplug_->next_deadline() : port::never);
}

#else

std::string broker_mistake(const Settings& settings, bool) {
  return settings.mqtt ? lacking(*settings.mqtt) : std::string();
}

BrokerLink::BrokerLink(const Settings& settings, port::EventLoop&, port::Log&) {
  if (settings.mqtt) throw std::runtime_error(lacking(*settings.mqtt));
}

port::MessageBroker* BrokerLink::broker() { return nullptr; }

port::MessageBroker* BrokerLink::sparkplug() { return nullptr; }

void BrokerLink::step(port::Instant) {}

port::Instant BrokerLink::next_deadline() const { return port::never; }

#endif

}  // namespace etcm::firmware

#include "http/farewell.h"

#include <sys/socket.h>

#include <algorithm>
#include <cerrno>
#include <utility>

namespace etcm::port {

Farewell::~Farewell() {
  for (Place& place : places_) close(place);
}

void Farewell::say(FileDescriptor socket, std::string response, Instant now) {
  const auto before = [](const Place& a, const Place& b) {
    return a.socket.is_open() != b.socket.is_open() ? !a.socket.is_open() : a.until < b.until;
  };
  Place& place = *std::min_element(places_.begin(), places_.end(), before);
  close(place);
  place.owner = this;
  place.socket = std::move(socket);
  place.response = std::move(response);
  place.until = now + time;
  loop_.add(place.socket.get(), place, true, false);
}

void Farewell::answer(Place& place) {
  char byte;
  const ssize_t asked = ::recv(place.socket.get(), &byte, sizeof byte, MSG_PEEK | MSG_DONTWAIT);
  if (asked < 0 && (errno == EAGAIN || errno == EINTR)) return;
  if (asked <= 0 || ::send(place.socket.get(), place.response.data(), place.response.size(),
                           MSG_NOSIGNAL | MSG_DONTWAIT) < 0) {
    return close(place);
  }
  ::shutdown(place.socket.get(), SHUT_WR);
  // What it asks stays unread, and would make it ready for ever.
  loop_.remove(place.socket.get());
  place.response.clear();
}

void Farewell::close(Place& place) {
  if (!place.socket.is_open()) return;
  if (!place.response.empty()) loop_.remove(place.socket.get());
  place.socket.close();
  place.response.clear();
  place.until = never;
}

void Farewell::advance(Instant now) {
  for (Place& place : places_) {
    if (place.until <= now) close(place);
  }
}

Instant Farewell::next_deadline() const {
  return std::min_element(places_.begin(), places_.end(),
                          [](const Place& a, const Place& b) { return a.until < b.until; })
      ->until;
}

std::string not_allowed_response(const HostAddress& host, const std::vector<Network>& allowed,
                                 const std::string& place) {
  std::string list;
  for (const Network& network : allowed) list += '"' + to_string(network) + "\", ";
  const std::string text =
      "403: this gateway does not show its page to " + host_text(host) +
      ".\n\n"
      "Ask whoever looks after the gateway, and send this page along. To let " +
      host_text(host) + " in, they write this line below\n`listen` of [http] in " +
      (place.empty() ? "the settings of the gateway" : place) +
      ", in place of an `allow` that is there:\n\n"
      "    allow = [" +
      list + '"' + host_text(host) +
      "\"]\n\n"
      "and have the gateway read it again:\n\n"
      "    sudo systemctl reload etcm-gateway\n\n"
      "Then load this page again, twice if need be.\n";
  return "HTTP/1.1 403 Forbidden\r\n"
         "Content-Type: text/plain; charset=utf-8\r\n"
         "Content-Length: " +
         std::to_string(text.size()) +
         "\r\n"
         "Cache-Control: no-store\r\n"
         "Connection: close\r\n\r\n" +
         text;
}

}  // namespace etcm::port

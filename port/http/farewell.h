// The last word to browsers that are not let in: a few bytes once they ask, and then some time in
// which nothing that comes is read. A socket that is closed with the request unread would be reset,
// and the browser would show that in place of the answer. Who has not asked is told nothing: a
// browser opens connections in advance, and would take what lies there for the answer to what it
// asks later, when it may be let in.
#pragma once

#include <array>
#include <string>
#include <vector>

#include "etcm/port/clock.h"
#include "etcm/port/socket_address.h"
#include "posix/event_loop.h"
#include "posix/file_descriptor.h"

namespace etcm::port {

class Farewell {
 public:
  // Of more at a time than `places`, the one that has been there longest is closed.
  static constexpr std::size_t places = 4;
  static constexpr Duration time = std::chrono::seconds(2);

  // `loop` must outlive this.
  explicit Farewell(EventLoop& loop) : loop_(loop) {}
  ~Farewell();
  Farewell(const Farewell&) = delete;
  Farewell& operator=(const Farewell&) = delete;

  // Sends what goes at once, which is all but to a peer that takes nothing.
  void say(FileDescriptor socket, std::string response, Instant now);
  void advance(Instant now);
  Instant next_deadline() const;

 private:
  struct Place final : EventHandler {
    Farewell* owner = nullptr;
    FileDescriptor socket;
    std::string response;  // empty: it was sent
    Instant until = never;
    void on_ready(bool, bool) override { owner->answer(*this); }
  };

  void answer(Place& place);
  void close(Place& place);

  EventLoop& loop_;
  std::array<Place, places> places_{};
};

// An answer with status 403 that ends its connection: who may look, whom to ask, and how to let
// `host` in. `place`: where that is written, "gateway.toml, line 12"; may be empty.
std::string not_allowed_response(const HostAddress& host, const std::vector<Network>& allowed,
                                 const std::string& place = {});

}  // namespace etcm::port

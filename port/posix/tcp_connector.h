// Makes a connection to where an endpoint leads. A name is looked up anew for each; its addresses
// are tried one after the other, each for a while. Nothing here waits.
#pragma once

#include <cstddef>
#include <optional>
#include <string>

#include "etcm/port/clock.h"
#include "etcm/port/endpoint.h"
#include "posix/event_loop.h"
#include "posix/name_resolver.h"

namespace etcm::port {

class TcpConnector final : private EventHandler {
 public:
  class Listener {
   public:
    virtual void on_socket(FileDescriptor socket) = 0;
    // None could be made, with the reason, and the cure where there is one; valid during the call.
    virtual void on_failure(const char* why) = 0;

   protected:
    ~Listener() = default;
  };

  // An address is tried for so long, or for as long as start() says where that is longer: a packet
  // that is lost is sent again after a second.
  static constexpr Duration connect_time_max = std::chrono::seconds(3);
  // The resolver is waited for so long. glibc asks two name servers twice within that.
  static constexpr Duration lookup_time_max = std::chrono::seconds(20);

  // `loop` and `listener` must outlive it. A thread looks names up, from the first one on.
  TcpConnector(EventLoop& loop, Listener& listener) : loop_(loop), listener_(listener) {}
  ~TcpConnector();
  TcpConnector(const TcpConnector&) = delete;
  TcpConnector& operator=(const TcpConnector&) = delete;

  // Starts anew; the listener may be called at once.
  void start(const Endpoint& end, Instant now, Duration time_max = connect_time_max);
  // Gives up, and says nothing.
  void stop();

  // Passes on from what has taken too long.
  void advance(Instant now);
  Instant next_deadline() const { return state_ == State::idle ? never : deadline_; }

 private:
  enum class State : std::uint8_t { idle, lookup, connecting };

  void on_ready(bool can_read, bool can_write) override;
  void look_up();
  void take_hosts(const FoundHosts& found);
  void try_hosts();
  void drop_socket();
  void note_failure(const std::string& why);
  void fail(std::string why);
  void watch_resolver(bool is_watched);

  EventLoop& loop_;
  Listener& listener_;
  State state_ = State::idle;
  Endpoint end_;
  Duration time_max_{};
  Instant deadline_{};  // of the lookup or the attempt; long past where that begins with advance()
  bool begins_ = false;

  std::optional<NameResolver> resolver_;
  bool is_watched_ = false;
  FoundHosts hosts_;
  std::size_t next_host_ = 0;
  FileDescriptor socket_;
  std::string failure_;  // of the last address
};

}  // namespace etcm::port

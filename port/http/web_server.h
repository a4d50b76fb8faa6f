// Serves a WebSite over HTTP, read-only: GET and HEAD, anything else is status 405.
//
// libmicrohttpd reads requests and writes answers, in turns taken by the event loop: no thread, and
// no client that is slow, silent or malicious holds up anybody. Each has so long for a request and
// so long to take an answer, whatever it does meanwhile; then its connection is closed.
//
// One address may have so many connections as posix/address_share.h says; further ones are closed.
//
// Memory: what a connection needs is bounded by connection_memory and given back when it closes;
// there are at most clients_max. libmicrohttpd allocates it, and a small description of each
// answer.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "etcm/port/log.h"
#include "etcm/port/service_counters.h"
#include "etcm/port/web_site.h"
#include "http/farewell.h"
#include "posix/acceptor.h"
#include "posix/event_loop.h"

struct MHD_Connection;
struct MHD_Daemon;

namespace etcm::port {

struct WebServerOptions {
  SocketAddress listen;
  std::uint32_t clients_max = 0;  // connections; further ones wait until one closes
  Duration request_time_max = std::chrono::seconds(15);  // idle before a request included
  Duration answer_time_max = std::chrono::seconds(60);
};

class WebServer final : private EventHandler, private AcceptHandler {
 public:
  // A request line with all its headers has to fit, and what an answer's next bytes go through.
  static constexpr std::size_t connection_memory = 16384;

  // Listens at once; where it cannot, it tries again (posix/acceptor.h). `loop` and `site` must
  // outlive this. Counts in `counters`, which must outlive this too.
  WebServer(EventLoop& loop, WebSite& site, const WebServerOptions& options,
            ServiceCounters& counters);
  ~WebServer();
  WebServer(const WebServer&) = delete;
  WebServer& operator=(const WebServer&) = delete;

  // Who may connect from now on; at first everybody. Hangs up on those who no longer may. Who is
  // rejected is told how to be let in, whatever it asks for, and is said in the log, which must
  // outlive this. `place`: where the settings have it, for who is rejected.
  void allow(std::vector<Network> networks, Log& log, std::string place = {});
  // By which names it may be asked for from now on, beside its addresses (host_check.h); at first
  // by any. Who asks by another one has status 421 and is told why.
  void expect_names(std::vector<std::string> names);

  // Does what has become possible: takes requests, sends a part of each answer under way.
  void advance(Instant now);
  Instant next_deadline() const;

  const Acceptor& acceptor() const { return acceptor_; }
  SocketAddress address() const { return acceptor_.address(); }

 private:
  class Callbacks;  // what libmicrohttpd calls

  // A connection, or a place for one.
  struct Client {
    WebServer* server = nullptr;
    int descriptor = -1;
    HostAddress host;
    bool is_free = true;
    bool is_reading = false;  // an answer of the site
    Instant overdue{};
  };
  struct StopDaemon {
    void operator()(MHD_Daemon* daemon) const;
  };

  void on_ready(bool can_read, bool can_write) override;
  void accepted(FileDescriptor socket, const SocketAddress& peer) override;
  void exhausted(const char* why) override;
  void close_overdue();
  bool has_its_share(const HostAddress& host) const;
  void turn_away(const HostAddress& host, const std::string& why);
  void report_misdirected(const HostAddress& host, const std::string& name);
  void hang_up(Client& client);
  static bool has_gone(const Client& client);

  EventLoop& loop_;
  WebSite& site_;
  const WebServerOptions options_;
  Log* log_ = nullptr;
  ServiceCounters& counters_;
  std::vector<Network> allowed_{everybody};
  std::string place_of_allowed_;
  std::optional<std::vector<std::string>> names_;
  std::vector<Client> clients_;
  std::unique_ptr<MHD_Daemon, StopDaemon> daemon_;
  int descriptor_ = -1;  // ready when the daemon has something to do
  Farewell farewell_{loop_};
  bool is_ready_ = false;
  Instant now_{};
  Instant overdue_check_{};
  Acceptor acceptor_;
};

}  // namespace etcm::port

#include "http/web_server.h"

#include <microhttpd.h>
#include <strings.h>
#include <sys/socket.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <charconv>
#include <cstring>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <system_error>
#include <utility>

#include "http/host_check.h"
#include "posix/address_share.h"
#include "posix/exhaustion.h"

namespace etcm::port {

namespace {

constexpr Duration overdue_check_interval = std::chrono::seconds(1);
constexpr std::size_t piece_size = 8192;

// "\"0123456789abcdef\"", and its end.
using Tag = std::array<char, 20>;

Tag tag_of(std::uint64_t version) {
  Tag tag{'"'};
  char* const end = std::to_chars(tag.data() + 1, tag.data() + tag.size() - 2, version, 16).ptr;
  *end = '"';
  return tag;
}

// Whether one of the tags of If-None-Match is this one, or any is. A proxy may have made it a weak
// one (RFC 9110, 13.1.2).
bool holds_tag(std::string_view list, std::string_view tag) {
  while (!list.empty()) {
    std::string_view each = list.substr(0, list.find(','));
    list.remove_prefix(std::min(each.size() + 1, list.size()));
    each.remove_prefix(std::min(each.find_first_not_of(" \t"), each.size()));
    each = each.substr(0, each.find_last_not_of(" \t") + 1);
    if (each.starts_with("W/")) each.remove_prefix(2);
    if (each == tag || each == "*") return true;
  }
  return false;
}

struct DestroyResponse {
  void operator()(MHD_Response* response) const { MHD_destroy_response(response); }
};
using Response = std::unique_ptr<MHD_Response, DestroyResponse>;

Response empty_response() {
  return Response(MHD_create_response_from_buffer(0, nullptr, MHD_RESPMEM_PERSISTENT));
}

// What every answer says: nothing is kept without asking again, and a page has nothing but what
// comes from here.
bool add_common_headers(MHD_Response* response) {
  constexpr std::array<std::pair<const char*, const char*>, 4> headers{{
      {MHD_HTTP_HEADER_CACHE_CONTROL, "no-cache"},
      {"X-Content-Type-Options", "nosniff"},
      {"Referrer-Policy", "no-referrer"},
      {"Content-Security-Policy",
       "default-src 'self'; frame-ancestors 'none'; base-uri 'none'; form-action 'none'"},
  }};
  return std::all_of(headers.begin(), headers.end(), [&](const auto& header) {
    return MHD_add_response_header(response, header.first, header.second) == MHD_YES;
  });
}

}  // namespace

// Where something cannot be had, MHD_NO closes the connection and nothing else.
class WebServer::Callbacks {
 public:
  static MHD_Result request(void* self, MHD_Connection* connection, const char* path,
                            const char* method, const char*, const char*, std::size_t* upload_size,
                            void** has_begun) {
    auto& server = *static_cast<WebServer*>(self);
    Client* const client = client_of(connection);
    if (client == nullptr || client->is_reading) return MHD_NO;
    // Content of a question means nothing (RFC 9110, 9.3.1).
    if (std::exchange(*upload_size, 0) > 0) return MHD_YES;
    const std::string_view verb = method;
    const bool is_read = verb == MHD_HTTP_METHOD_GET || verb == MHD_HTTP_METHOD_HEAD;
    // The first call comes with the headers: who is answered then is not listened to any more.
    if (is_read && *has_begun == nullptr) {
      *has_begun = client;
      return MHD_YES;
    }
    ++server.counters_.requests;
    client->overdue = server.now_ + server.options_.answer_time_max;
    if (server.names_) {
      AskedHost asked{.names = *server.names_, .unknown = {}};
      MHD_get_connection_values(connection, MHD_HEADER_KIND, &look_for_host, &asked);
      if (asked.unknown) return answer_misdirected(server, *client, connection, *asked.unknown);
    }
    if (!is_read) {
      ++server.counters_.rejected;
      const Response response = empty_response();
      if (!response || !add_common_headers(response.get()) ||
          MHD_add_response_header(response.get(), MHD_HTTP_HEADER_ALLOW, "GET, HEAD") != MHD_YES) {
        return MHD_NO;
      }
      return MHD_queue_response(connection, MHD_HTTP_METHOD_NOT_ALLOWED, response.get());
    }
    return answer_by_site(server, *client, connection, path, verb == MHD_HTTP_METHOD_HEAD);
  }

  static void connection_changed(void* self, MHD_Connection* connection, void** context,
                                 MHD_ConnectionNotificationCode what) {
    auto& server = *static_cast<WebServer*>(self);
    if (what == MHD_CONNECTION_NOTIFY_STARTED) {
      const auto place =
          std::find_if(server.clients_.begin(), server.clients_.end(),
                       [](const Client& client) { return client.is_free && !client.is_reading; });
      if (place == server.clients_.end()) return;
      place->is_free = false;
      place->descriptor =
          MHD_get_connection_info(connection, MHD_CONNECTION_INFO_CONNECTION_FD)->connect_fd;
      place->host =
          from_native(
              MHD_get_connection_info(connection, MHD_CONNECTION_INFO_CLIENT_ADDRESS)->client_addr)
              .host;
      place->overdue = server.now_ + server.options_.request_time_max;
      *context = &*place;
      if (++server.counters_.clients == server.clients_.size()) server.acceptor_.hold();
    } else if (auto* const client = static_cast<Client*>(*context)) {
      client->is_free = true;
      client->descriptor = -1;
      --server.counters_.clients;
      server.acceptor_.resume();
    }
  }

  // A path is a text that ends with NUL: what stands behind one would be left out of it.
  static std::size_t unescape(void*, MHD_Connection*, char* text) {
    const std::string_view escaped = text;
    return escaped.find("%00") == escaped.npos ? MHD_http_unescape(text) : escaped.size();
  }

  // The next request of the connection has its own time.
  static void completed(void* self, MHD_Connection* connection, void**,
                        MHD_RequestTerminationCode) {
    auto& server = *static_cast<WebServer*>(self);
    if (Client* const client = client_of(connection)) {
      client->overdue = server.now_ + server.options_.request_time_max;
    }
  }

 private:
  static std::size_t place_of(const WebServer& server, const Client& client) {
    return static_cast<std::size_t>(&client - server.clients_.data());
  }

  static Client* client_of(MHD_Connection* connection) {
    const MHD_ConnectionInfo* const info =
        MHD_get_connection_info(connection, MHD_CONNECTION_INFO_SOCKET_CONTEXT);
    return info == nullptr ? nullptr : static_cast<Client*>(info->socket_context);
  }

  struct AskedHost {
    std::span<const std::string> names;
    std::optional<RequestedHost> unknown;
  };

  // A request without one is no browser's.
  static MHD_Result look_for_host(void* self, MHD_ValueKind, const char* key, const char* value) {
    if (::strcasecmp(key, MHD_HTTP_HEADER_HOST) != 0) return MHD_YES;
    auto& asked = *static_cast<AskedHost*>(self);
    RequestedHost host = check_host(value == nullptr ? "" : value, asked.names);
    if (!host.is_known) asked.unknown = std::move(host);
    return MHD_YES;
  }

  static MHD_Result answer_misdirected(WebServer& server, const Client& client,
                                       MHD_Connection* connection, const RequestedHost& host) {
    ++server.counters_.rejected;
    server.report_misdirected(client.host, host.name);
    const std::string text = unknown_host_text(host);
    // Which is copied, so it is not written to.
    const Response response(MHD_create_response_from_buffer(
        text.size(), const_cast<char*>(text.data()), MHD_RESPMEM_MUST_COPY));
    if (!response || !add_common_headers(response.get()) ||
        MHD_add_response_header(response.get(), MHD_HTTP_HEADER_CONTENT_TYPE,
                                "text/plain; charset=utf-8") != MHD_YES) {
      return MHD_NO;
    }
    return MHD_queue_response(connection, web_status::misdirected, response.get());
  }

  static MHD_Result answer_by_site(WebServer& server, Client& client, MHD_Connection* connection,
                                   const char* path, bool is_head) {
    const WebAnswer answer = server.site_.begin(place_of(server, client), path);
    client.is_reading = true;
    if (answer.status >= 400) ++server.counters_.rejected;
    const Tag tag = tag_of(answer.version);
    const char* const known =
        MHD_lookup_connection_value(connection, MHD_HEADER_KIND, MHD_HTTP_HEADER_IF_NONE_MATCH);
    const bool is_known = answer.version != 0 && known != nullptr && holds_tag(known, tag.data());
    if (is_known) end_reading(&client);
    const Response response = is_known
                                  ? empty_response()
                                  : Response(MHD_create_response_from_callback(
                                        MHD_SIZE_UNKNOWN, piece_size, read, &client, end_reading));
    if (!response) {
      if (!is_known) end_reading(&client);
      return MHD_NO;
    }
    // From here on the response ends the reading when it goes, whatever happens.
    if (!add_common_headers(response.get()) ||
        // In chunks libmicrohttpd would send the last one of a content that is not there.
        (is_head && !is_known &&
         MHD_set_response_options(response.get(), MHD_RF_HTTP_VERSION_1_0_ONLY, MHD_RO_END) !=
             MHD_YES) ||
        (answer.version != 0 &&
         MHD_add_response_header(response.get(), MHD_HTTP_HEADER_ETAG, tag.data()) != MHD_YES) ||
        MHD_add_response_header(response.get(), MHD_HTTP_HEADER_CONTENT_TYPE, answer.media_type) !=
            MHD_YES) {
      return MHD_NO;
    }
    return MHD_queue_response(connection, is_known ? MHD_HTTP_NOT_MODIFIED : answer.status,
                              response.get());
  }

  static ssize_t read(void* self, std::uint64_t, char* out, std::size_t room) {
    auto& client = *static_cast<Client*>(self);
    WebServer& server = *client.server;
    const std::size_t count = server.site_.read(place_of(server, client), {out, room});
    return count == 0 ? ssize_t{MHD_CONTENT_READER_END_OF_STREAM} : static_cast<ssize_t>(count);
  }

  static void end_reading(void* self) {
    auto& client = *static_cast<Client*>(self);
    client.server->site_.end(place_of(*client.server, client));
    client.is_reading = false;
  }
};

void WebServer::StopDaemon::operator()(MHD_Daemon* daemon) const { MHD_stop_daemon(daemon); }

WebServer::WebServer(EventLoop& loop, WebSite& site, const WebServerOptions& options,
                     ServiceCounters& counters)
    : loop_(loop),
      site_(site),
      options_(options),
      counters_(counters),
      clients_(options.clients_max),
      acceptor_(loop, *this, options.listen) {
  for (Client& client : clients_) client.server = this;
  // It is handed its connections: left to accept them itself, it would try all the time where there
  // are no descriptors.
  errno = 0;
  daemon_.reset(MHD_start_daemon(
      MHD_USE_EPOLL | MHD_USE_NO_LISTEN_SOCKET, 0, nullptr, nullptr, &Callbacks::request, this,
      MHD_OPTION_CONNECTION_LIMIT, static_cast<unsigned>(options.clients_max),
      MHD_OPTION_CONNECTION_MEMORY_LIMIT, connection_memory, MHD_OPTION_NOTIFY_CONNECTION,
      &Callbacks::connection_changed, this, MHD_OPTION_NOTIFY_COMPLETED, &Callbacks::completed,
      this, MHD_OPTION_UNESCAPE_CALLBACK, &Callbacks::unescape, nullptr, MHD_OPTION_END));
  if (!daemon_) throw std::system_error(errno, std::generic_category(), "no web server");
  descriptor_ = MHD_get_daemon_info(daemon_.get(), MHD_DAEMON_INFO_EPOLL_FD)->epoll_fd;
  loop_.add(descriptor_, *this, true, false);
  counters_.is_listening = acceptor_.is_listening();
}

WebServer::~WebServer() {
  loop_.remove(descriptor_);
  // While all that its callbacks use is there.
  daemon_.reset();
}

void WebServer::allow(std::vector<Network> networks, Log& log, std::string place) {
  log_ = &log;
  place_of_allowed_ = std::move(place);
  allowed_ = std::move(networks);
  for (Client& client : clients_) {
    if (!client.is_free && !any_contains(allowed_, client.host)) hang_up(client);
  }
}

void WebServer::expect_names(std::vector<std::string> names) { names_ = std::move(names); }

void WebServer::accepted(FileDescriptor socket, const SocketAddress& peer) {
  if (!any_contains(allowed_, peer.host)) {
    farewell_.say(std::move(socket), not_allowed_response(peer.host, allowed_, place_of_allowed_),
                  now_);
    return turn_away(
        peer.host, "its network is not in allow of [http]; add it there if it may see everything");
  }
  if (has_its_share(peer.host)) {
    return turn_away(peer.host, "it has " + std::to_string(places_of_one_address(clients_.size())) +
                                    " connections, as many as one address may have of "
                                    "clients_max in [http]; raise that if it is a proxy");
  }
  const NativeAddress address = to_native(peer);
  // It has the socket from here on, and closes it where it has no room for it.
  MHD_add_connection(daemon_.get(), socket.release(), address.get(), address.size);
}

void WebServer::exhausted(const char* why) {
  if (log_ == nullptr) return;
  log_->write(Level::error, std::string("no further browser can connect: ") + why + "; " +
                                descriptors_cure +
                                ", or lower clients_max in "
                                "[server] and [http]");
}

bool WebServer::has_its_share(const HostAddress& host) const {
  const auto count = std::count_if(clients_.begin(), clients_.end(), [&](const Client& client) {
    return !client.is_free && client.host == host;
  });
  return static_cast<std::size_t>(count) >= places_of_one_address(clients_.size());
}

void WebServer::turn_away(const HostAddress& host, const std::string& why) {
  ++counters_.rejected;
  if (log_ == nullptr) return;
  log_->write(Level::warning, "a browser at " + host_text(host) + " is rejected: " + why);
}

void WebServer::report_misdirected(const HostAddress& host, const std::string& name) {
  if (log_ == nullptr) return;
  log_->write(Level::warning, "a browser at " + host_text(host) + " asks for the page by " +
                                  (name.empty() ? "what is no name" : "the name " + name) +
                                  " and is told nothing: add it to names of [http] if it is right; "
                                  "else another site tries to read the page through that browser");
}

void WebServer::on_ready(bool, bool) { is_ready_ = true; }

void WebServer::advance(Instant now) {
  now_ = now;
  acceptor_.advance(now);
  farewell_.advance(now);
  counters_.is_listening = acceptor_.is_listening();
  if (overdue_check_ <= now) {
    close_overdue();
    overdue_check_ = now + overdue_check_interval;
  }
  MHD_UNSIGNED_LONG_LONG timeout_ms = 0;
  const bool is_due = MHD_get_timeout(daemon_.get(), &timeout_ms) == MHD_YES && timeout_ms == 0;
  if (!is_ready_ && !is_due) return;
  is_ready_ = false;
  MHD_run(daemon_.get());
}

Instant WebServer::next_deadline() const {
  MHD_UNSIGNED_LONG_LONG timeout_ms = 0;
  const bool is_due = MHD_get_timeout(daemon_.get(), &timeout_ms) == MHD_YES && timeout_ms == 0;
  if (is_ready_ || is_due) return now_;
  return std::min({acceptor_.next_deadline(), farewell_.next_deadline(),
                   counters_.clients > 0 ? overdue_check_ : never});
}

// Went away before it had said what it wants, of which the daemon may hear nothing.
bool WebServer::has_gone(const Client& client) {
  char byte;
  return !client.is_reading &&
         ::recv(client.descriptor, &byte, sizeof byte, MSG_PEEK | MSG_DONTWAIT) == 0;
}

void WebServer::close_overdue() {
  for (Client& client : clients_) {
    if (client.is_free || (client.overdue > now_ && !has_gone(client))) continue;
    hang_up(client);
  }
}

// The daemon finds its end of the connection shut, and closes it as it does for any client that
// went away.
void WebServer::hang_up(Client& client) {
  ::shutdown(client.descriptor, SHUT_RDWR);
  client.overdue = never;
  ++counters_.rejected;
}

}  // namespace etcm::port

#include "posix/tcp_connector.h"

#include <cerrno>
#include <cstring>
#include <system_error>
#include <utility>

#include "posix/exhaustion.h"
#include "posix/tcp_socket.h"

namespace etcm::port {

namespace {

constexpr const char* unreachable_cure =
    "; check its address, cable and power, and the network between";

std::string with_cure(int error) {
  std::string why = std::strerror(error);
  switch (error) {
    case ECONNREFUSED:
      return why +
             "; nothing listens there: check address and port, that it runs, and that it takes one "
             "more connection";
    case EHOSTUNREACH:
    case ENETUNREACH:
    case ETIMEDOUT:
      return why + unreachable_cure;
    default:
      return is_out_of_descriptors(error) ? why + "; " + descriptors_cure : why;
  }
}

}  // namespace

TcpConnector::~TcpConnector() { stop(); }

void TcpConnector::start(const Endpoint& end, Instant now, Duration time_max) {
  stop();
  if (resolver_ && end.host != end_.host) resolver_.reset();
  end_ = end;
  time_max_ = time_max;
  if (has_name(end)) {
    state_ = State::lookup;
    deadline_ = now + lookup_time_max;
    return look_up();
  }
  state_ = State::connecting;
  take_hosts(find_hosts(end.host.c_str(), true));
  // Whoever starts it lets time pass before it waits; what began at once has begun now.
  if (std::exchange(begins_, false)) deadline_ = now + time_max_;
}

void TcpConnector::stop() {
  watch_resolver(false);
  drop_socket();
  begins_ = false;
  state_ = State::idle;
}

void TcpConnector::look_up() {
  try {
    if (!resolver_) resolver_.emplace(end_.host);
  } catch (const std::system_error& error) {
    return fail("cannot look its name up: " + error.code().message() +
                "; raise LimitNOFILE and TasksMax of the service");
  }
  watch_resolver(true);
  resolver_->start();
}

void TcpConnector::watch_resolver(bool is_watched) {
  if (is_watched == is_watched_) return;
  is_watched_ = is_watched;
  if (is_watched) {
    loop_.add(resolver_->descriptor(), *this, true, false);
  } else {
    loop_.remove(resolver_->descriptor());
  }
}

void TcpConnector::on_ready(bool, bool) {
  if (state_ == State::lookup) {
    const auto found = resolver_->take();
    if (!found) return;
    watch_resolver(false);
    state_ = State::connecting;
    return take_hosts(*found);
  }
  const int error = connect_error(socket_.get());
  loop_.remove(socket_.get());
  FileDescriptor socket = std::move(socket_);
  if (error != 0) {
    note_failure(with_cure(error));
    return try_hosts();
  }
  begins_ = false;
  state_ = State::idle;
  listener_.on_socket(std::move(socket));
}

void TcpConnector::take_hosts(const FoundHosts& found) {
  hosts_ = found;
  next_host_ = 0;
  if (found.count > 0) return try_hosts();
  const std::string why = found.why_none != nullptr ? found.why_none : "it has no address";
  fail(has_name(end_) ? why + "; correct the name, or look at the name server: `getent hosts " +
                            end_.host + "` asks it"
                      : why + "; look at the name of the interface (`ip link` lists them)");
}

// The next address on which an attempt can be started.
void TcpConnector::try_hosts() {
  while (next_host_ < hosts_.count) {
    socket_ = connect_tcp({.host = hosts_.hosts[next_host_++], .port = end_.port});
    if (socket_.is_open()) {
      loop_.add(socket_.get(), *this, false, true);
      begins_ = true;
      deadline_ = Instant{};
      return;
    }
    note_failure(with_cure(errno));
  }
  fail(failure_);
}

void TcpConnector::note_failure(const std::string& why) {
  failure_ = why;
  if (has_name(end_)) failure_ = host_text(hosts_.hosts[next_host_ - 1]) + ": " + failure_;
}

void TcpConnector::drop_socket() {
  if (socket_.is_open()) loop_.remove(socket_.get());
  socket_.close();
}

void TcpConnector::fail(std::string why) {
  begins_ = false;
  state_ = State::idle;
  listener_.on_failure(why.c_str());
}

void TcpConnector::advance(Instant now) {
  if (state_ == State::idle) return;
  if (std::exchange(begins_, false)) deadline_ = now + time_max_;
  if (now < deadline_) return;
  if (state_ == State::lookup) {
    watch_resolver(false);
    return fail("its name is looked up for longer than " +
                std::to_string(lookup_time_max / std::chrono::seconds(1)) +
                " s; look at the name server: `getent hosts " + end_.host + "` asks it");
  }
  drop_socket();
  note_failure(std::string("no answer to the attempt to connect") + unreachable_cure);
  try_hosts();
  if (std::exchange(begins_, false)) deadline_ = now + time_max_;
}

}  // namespace etcm::port

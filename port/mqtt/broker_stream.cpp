#include "mqtt/broker_stream.h"

#include <openssl/err.h>
#include <openssl/ssl.h>
#include <openssl/x509v3.h>
#include <sys/socket.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <utility>

#include "etcm/port/socket_address.h"

namespace etcm::port {

namespace {

// Who has to be named in the certificate.
bool expect_host(SSL* ssl, const std::string& host) {
  const std::string address = host.substr(0, host.find('%'));
  if (parse_host_address(address)) {
    return X509_VERIFY_PARAM_set1_ip_asc(SSL_get0_param(ssl), address.c_str()) == 1;
  }
  SSL_set_hostflags(ssl, X509_CHECK_FLAG_NO_PARTIAL_WILDCARDS);
  return SSL_set1_host(ssl, host.c_str()) == 1 && SSL_set_tlsext_host_name(ssl, host.c_str()) == 1;
}

int clamped(std::size_t size) { return static_cast<int>(std::min<std::size_t>(size, 1u << 20)); }

}  // namespace

void BrokerStream::Free::operator()(ssl_st* ssl) const { SSL_free(ssl); }

BrokerStream::BrokerStream(FileDescriptor socket, const TlsContext* tls, const std::string& host)
    : socket_(std::move(socket)) {
  if (tls == nullptr) return;
  peer_.emplace(TlsPeer{.options = tls->options(), .host = host});
  ssl_.reset(SSL_new(tls->get()));
  if (!ssl_ || SSL_set_fd(ssl_.get(), socket_.get()) != 1 || !expect_host(ssl_.get(), host)) {
    lose("no memory for TLS");
    return;
  }
  SSL_set_app_data(ssl_.get(), &*peer_);
  SSL_set_connect_state(ssl_.get());
}

// The other side hears that nothing was cut off. What it has not read yet is not waited for.
BrokerStream::~BrokerStream() {
  if (!ssl_ || is_lost_ || SSL_in_init(ssl_.get())) return;
  ERR_clear_error();
  SSL_shutdown(ssl_.get());
  ERR_clear_error();
}

std::size_t BrokerStream::read(std::span<std::uint8_t> bytes) {
  if (is_lost_ || bytes.empty()) return 0;
  std::size_t taken = 0;
  if (ssl_) {
    ERR_clear_error();
    taken = settle(SSL_read(ssl_.get(), bytes.data(), clamped(bytes.size())), false);
  } else {
    const ssize_t count = ::recv(socket_.get(), bytes.data(), bytes.size(), 0);
    if (count > 0) taken = static_cast<std::size_t>(count);
    if (count == 0) note_cut(0, false);
    if (count < 0 && errno != EAGAIN && errno != EINTR) note_cut(errno, false);
  }
  if (taken == 0 && write_error_ && !is_lost_) note_cut(*write_error_, false);
  return taken;
}

std::size_t BrokerStream::write(std::span<const std::uint8_t> bytes) {
  if (is_lost_ || write_error_ || bytes.empty()) return 0;
  if (ssl_) {
    ERR_clear_error();
    return settle(SSL_write(ssl_.get(), bytes.data(), clamped(bytes.size())), true);
  }
  const ssize_t count = ::send(socket_.get(), bytes.data(), bytes.size(), MSG_NOSIGNAL);
  write_wants_write_ = count < 0 && errno == EAGAIN;
  if (count >= 0) return static_cast<std::size_t>(count);
  if (errno != EAGAIN && errno != EINTR) note_cut(errno, true);
  return 0;
}

std::size_t BrokerStream::settle(int result, bool is_write) {
  const int system_error = errno;
  bool& wants_write = is_write ? write_wants_write_ : read_wants_write_;
  wants_write = false;
  if (result > 0) return static_cast<std::size_t>(result);
  switch (SSL_get_error(ssl_.get(), result)) {
    case SSL_ERROR_WANT_READ:
      break;
    case SSL_ERROR_WANT_WRITE:
      wants_write = true;
      break;
    case SSL_ERROR_ZERO_RETURN:
      note_cut(0, is_write);
      break;
    case SSL_ERROR_SYSCALL:
      note_cut(system_error, is_write);
      break;
    default:
      if (ERR_GET_REASON(ERR_peek_error()) == SSL_R_UNEXPECTED_EOF_WHILE_READING) {
        note_cut(0, is_write);
      } else {
        lose(explain_tls_failure(*peer_));
      }
  }
  ERR_clear_error();
  return 0;
}

void BrokerStream::note_cut(int error, bool is_write) {
  if (is_write) {
    write_error_ = error;
    return;
  }
  is_cut_ = true;
  lose(error == 0 ? "connection closed by the other side" : std::strerror(error));
}

bool BrokerStream::has_pending() const { return ssl_ && SSL_has_pending(ssl_.get()) == 1; }

void BrokerStream::lose(std::string why) {
  if (std::exchange(is_lost_, true)) return;
  why_lost_ = std::move(why);
}

}  // namespace etcm::port

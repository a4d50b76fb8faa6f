// Bytes to and from a broker, over a TCP connection as it is or with TLS over it. Nothing here
// waits: a handshake goes on whenever something is read or written.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>

#include "mqtt/tls_failure.h"
#include "posix/file_descriptor.h"

struct ssl_st;

namespace etcm::port {

class BrokerStream {
 public:
  // Over a socket that is connected and does not block. `tls`, if not null, must outlive this; the
  // other side must prove to be `host`, a name or an address.
  BrokerStream(FileDescriptor socket, const TlsContext* tls, const std::string& host);
  ~BrokerStream();
  BrokerStream(const BrokerStream&) = delete;
  BrokerStream& operator=(const BrokerStream&) = delete;

  int descriptor() const { return socket_.get(); }

  // How many bytes were taken in or sent; 0: none at present, or it is lost.
  std::size_t read(std::span<std::uint8_t> bytes);
  std::size_t write(std::span<const std::uint8_t> bytes);

  // Whether the last read or write waits until the socket can be written to.
  bool wants_write() const { return read_wants_write_ || write_wants_write_; }
  // Whether bytes have come that the socket does not show any more.
  bool has_pending() const;

  bool is_lost() const { return is_lost_; }
  // Whether the other side broke off, and said nothing.
  bool is_cut() const { return is_cut_; }
  // What happened, and the cure where there is one.
  const std::string& why_lost() const { return why_lost_; }

 private:
  struct Free {
    void operator()(ssl_st* ssl) const;
  };

  std::size_t settle(int result, bool is_write);
  void note_cut(int error, bool is_write);
  void lose(std::string why);

  FileDescriptor socket_;
  std::optional<TlsPeer> peer_;
  std::unique_ptr<ssl_st, Free> ssl_;
  bool read_wants_write_ = false;
  bool write_wants_write_ = false;
  // Nothing can be written any more: what the other side has said before is read first.
  std::optional<int> write_error_;
  bool is_lost_ = false;
  bool is_cut_ = false;
  std::string why_lost_;
};

}  // namespace etcm::port

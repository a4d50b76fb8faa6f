// What libmodbus replies to whole requests about registers.
//
// modbus_reply() sends a reply as it makes it. Here it goes into a pair of sockets and is taken out
// again, so that sending to clients, who may be slow, stays with who knows when they can take more.
// It does not look how long a request is, so only what frame.h has parsed may reach it.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>

#include "posix/file_descriptor.h"

struct _modbus;  // libmodbus's modbus_t

namespace etcm::port {

class Replies {
 public:
  // Throws std::system_error where the system has no sockets left.
  Replies();

  // The PDU of the reply to a request that parse_read_request() takes: of `registers`, the first of
  // which has the address `first`, or the exception that not all that was asked for is there.
  // Returns the bytes written to `answer` (pdu_bytes_max); 0 where the system has no memory left.
  std::size_t to_read(std::span<const std::uint8_t> request, std::uint16_t first,
                      std::span<const std::uint16_t> registers, std::span<std::uint8_t> answer);

  // The same to a request that parse_write_request() takes; what it writes stands in `registers`.
  std::size_t to_write(std::span<const std::uint8_t> request, std::uint16_t first,
                       std::span<std::uint16_t> registers, std::span<std::uint8_t> answer);

 private:
  struct Free {
    void operator()(_modbus* context) const;
  };

  std::size_t reply(std::span<const std::uint8_t> request, std::uint16_t first,
                    std::uint16_t* registers, std::size_t count, std::span<std::uint8_t> answer);

  std::unique_ptr<_modbus, Free> context_;
  FileDescriptor in_;   // libmodbus sends into this one
  FileDescriptor out_;  // and here it comes out
};

}  // namespace etcm::port

#include "modbus/replies.h"

#include <modbus/modbus.h>
#include <sys/socket.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <system_error>

#include "modbus/frame.h"

namespace etcm::port {

void Replies::Free::operator()(_modbus* context) const { modbus_free(context); }

// Nothing is ever connected to the address.
Replies::Replies() : context_(modbus_new_tcp("127.0.0.1", MODBUS_TCP_DEFAULT_PORT)) {
  std::array<int, 2> pair{-1, -1};
  if (context_ == nullptr ||
      ::socketpair(AF_UNIX, SOCK_SEQPACKET | SOCK_NONBLOCK | SOCK_CLOEXEC, 0, pair.data()) != 0) {
    throw std::system_error(errno, std::generic_category(), "no sockets for replies");
  }
  in_ = FileDescriptor(pair[0]);
  out_ = FileDescriptor(pair[1]);
  modbus_set_socket(context_.get(), in_.get());
}

std::size_t Replies::to_read(std::span<const std::uint8_t> request, std::uint16_t first,
                             std::span<const std::uint16_t> registers,
                             std::span<std::uint8_t> answer) {
  // Its table is for all functions; these two do not change it.
  return reply(request, first, const_cast<std::uint16_t*>(registers.data()), registers.size(),
               answer);
}

std::size_t Replies::to_write(std::span<const std::uint8_t> request, std::uint16_t first,
                              std::span<std::uint16_t> registers, std::span<std::uint8_t> answer) {
  return reply(request, first, registers.data(), registers.size(), answer);
}

std::size_t Replies::reply(std::span<const std::uint8_t> request, std::uint16_t first,
                           std::uint16_t* registers, std::size_t count,
                           std::span<std::uint8_t> answer) {
  modbus_mapping_t table{};
  table.start_registers = table.start_input_registers = first;
  table.nb_registers = table.nb_input_registers = static_cast<int>(count);
  table.tab_registers = table.tab_input_registers = registers;
  std::array<std::uint8_t, frame_bytes_max> frame;
  std::copy(request.begin(), request.end(), frame.begin() + mbap_header_bytes);
  const std::size_t size = write_header(frame, 0, 0, request.size());
  if (modbus_reply(context_.get(), frame.data(), static_cast<int>(size), &table) < 0) return 0;
  const ssize_t replied = ::recv(out_.get(), frame.data(), frame.size(), 0);
  if (replied <= static_cast<ssize_t>(mbap_header_bytes)) return 0;
  const auto pdu = std::span(frame).first(static_cast<std::size_t>(replied));
  std::copy(pdu.begin() + mbap_header_bytes, pdu.end(), answer.begin());
  return pdu.size() - mbap_header_bytes;
}

}  // namespace etcm::port

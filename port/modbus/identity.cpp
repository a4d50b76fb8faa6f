#include "modbus/identity.h"

#include <modbus/modbus.h>

#include <algorithm>

#include "modbus/frame.h"

namespace etcm::port {

static_assert(report_server_id == MODBUS_FC_REPORT_SLAVE_ID);

namespace {

constexpr std::uint8_t is_running = 0xff;
constexpr std::uint8_t more_follows = 0xff;
// What we can be asked for: the basic objects, as a stream or one by one.
constexpr std::uint8_t conformity = 0x81;
constexpr std::uint8_t server_id = 'E';

constexpr std::uint8_t category_basic = 1;
constexpr std::uint8_t category_extended = 3;
constexpr std::uint8_t one_object = 4;

constexpr std::size_t identification_header_bytes = 7;
constexpr std::size_t object_header_bytes = 2;
constexpr std::size_t text_bytes_max = 240;

std::uint8_t* append(std::string_view text, std::uint8_t* to) {
  return std::copy(text.begin(), text.end(), to);
}

std::size_t write_server_id_answer(std::span<std::uint8_t> answer, const Identity& identity) {
  answer[0] = report_server_id;
  answer[2] = server_id;
  answer[3] = is_running;
  std::size_t size = 4;
  const std::string_view product = identity.product().substr(0, text_bytes_max / 2);
  const std::string_view version = identity.version().substr(0, text_bytes_max / 2);
  append(product, &answer[size]);
  size += product.size();
  answer[size++] = ' ';
  append(version, &answer[size]);
  size += version.size();
  answer[1] = static_cast<std::uint8_t>(size - 2);
  return size;
}

std::size_t write_identification_answer(std::span<std::uint8_t> answer,
                                        std::span<const std::uint8_t> request,
                                        const Identity& identity) {
  const std::uint8_t category = request[2];
  std::size_t object = request[3];
  if (category < category_basic || category > one_object) {
    return write_exception(answer, encapsulated_interface, MODBUS_EXCEPTION_ILLEGAL_DATA_VALUE);
  }
  if (object >= identity.objects.size()) {
    if (category == one_object) {
      return write_exception(answer, encapsulated_interface, MODBUS_EXCEPTION_ILLEGAL_DATA_ADDRESS);
    }
    object = 0;
  }
  answer[0] = encapsulated_interface;
  answer[1] = read_device_identification;
  answer[2] = category;
  answer[3] = conformity;
  answer[4] = answer[5] = answer[6] = 0;
  std::size_t size = identification_header_bytes;
  for (; object < identity.objects.size(); ++object) {
    const std::string_view text = identity.objects[object].substr(0, text_bytes_max);
    if (size + object_header_bytes + text.size() > pdu_bytes_max) {
      answer[4] = more_follows;
      answer[5] = static_cast<std::uint8_t>(object);
      break;
    }
    answer[size] = static_cast<std::uint8_t>(object);
    answer[size + 1] = static_cast<std::uint8_t>(text.size());
    append(text, &answer[size + object_header_bytes]);
    size += object_header_bytes + text.size();
    ++answer[6];
    if (category == one_object) break;
  }
  return size;
}

}  // namespace

std::size_t write_identity_answer(std::span<std::uint8_t> answer,
                                  std::span<const std::uint8_t> request, const Identity& identity) {
  if (request[0] == report_server_id) {
    return request.size() == 1
               ? write_server_id_answer(answer, identity)
               : write_exception(answer, request[0], MODBUS_EXCEPTION_ILLEGAL_DATA_VALUE);
  }
  if (request[0] != encapsulated_interface || request.size() < 2 ||
      request[1] != read_device_identification) {
    return 0;
  }
  return request.size() == 4
             ? write_identification_answer(answer, request, identity)
             : write_exception(answer, request[0], MODBUS_EXCEPTION_ILLEGAL_DATA_VALUE);
}

std::size_t write_server_id_request(std::span<std::uint8_t> pdu) {
  pdu[0] = report_server_id;
  return 1;
}

std::optional<std::span<const std::uint8_t>> parse_server_id_answer(
    std::span<const std::uint8_t> pdu) {
  if (pdu.size() < 2 || pdu[0] != report_server_id || pdu[1] != pdu.size() - 2) return std::nullopt;
  return pdu.subspan(2);
}

std::size_t write_identification_request(std::span<std::uint8_t> pdu, std::uint8_t first) {
  pdu[0] = encapsulated_interface;
  pdu[1] = read_device_identification;
  pdu[2] = category_basic;
  pdu[3] = first;
  return 4;
}

std::optional<std::uint8_t> parse_identification_answer(std::span<const std::uint8_t> pdu,
                                                        Identity& identity) {
  if (pdu.size() < identification_header_bytes || pdu[0] != encapsulated_interface ||
      pdu[1] != read_device_identification || pdu[2] > category_extended) {
    return std::nullopt;
  }
  Identity found = identity;
  std::size_t at = identification_header_bytes;
  for (int left = pdu[6]; left > 0; --left) {
    if (at + object_header_bytes > pdu.size()) return std::nullopt;
    const std::size_t object = pdu[at];
    const std::size_t length = pdu[at + 1];
    at += object_header_bytes;
    if (length > pdu.size() - at) return std::nullopt;
    if (object < found.objects.size()) {
      found.objects[object] = {reinterpret_cast<const char*>(pdu.data() + at), length};
    }
    at += length;
  }
  if (at != pdu.size()) return std::nullopt;
  identity = found;
  const auto all = static_cast<std::uint8_t>(found.objects.size());
  return pdu[4] == more_follows ? std::min(pdu[5], all) : all;
}

}  // namespace etcm::port

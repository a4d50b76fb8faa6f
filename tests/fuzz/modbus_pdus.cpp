// What is said of a PDU, a frame or a stream of bytes by itself, whichever end it comes from.
#include <algorithm>
#include <array>
#include <optional>
#include <vector>

#include "fuzz_target.h"
#include "modbus/client_request.h"
#include "modbus/frame.h"
#include "modbus/identity.h"
#include "modbus/question.h"
#include "modbus/replies.h"
#include "modbus/rtu_frame.h"

namespace etcm::fuzz {
namespace {

constexpr port::Identity identity{{"Maker", "mesh server", "1.2"}};

// As the server of the mesh does it (modbus/register_server.cpp).
void reply(std::span<const std::uint8_t> pdu) {
  static port::Replies replies;
  std::array<std::uint16_t, 200> registers{};
  std::array<std::uint8_t, port::pdu_bytes_max> answer{};
  std::uint8_t exception = 0;
  if (port::write_identity_answer(answer, pdu, identity) != 0) return;
  if (port::parse_read_request(pdu, exception)) {
    const std::size_t size = replies.to_read(pdu, 100, registers, answer);
    require(size >= 2 && size <= answer.size(), "a reply of no length");
  } else {
    require(exception != 0, "a request is refused without an exception");
  }
  if (port::parse_write_request(pdu, exception)) {
    const std::size_t size = replies.to_write(pdu, 100, registers, answer);
    require(size >= 2 && size <= answer.size(), "a reply of no length");
  }
}

void read_answers(std::span<const std::uint8_t> pdu) {
  std::array<std::uint16_t, 125> registers;
  std::uint8_t exception = 0;
  for (const std::uint8_t function : {std::uint8_t{3}, std::uint8_t{4}}) {
    const std::size_t count = pdu.size() < 2 ? 1 : std::clamp<std::size_t>(pdu[1] / 2, 1, 125);
    static_cast<void>(
        port::parse_read_answer(pdu, function, std::span(registers).first(count), exception));
  }
  static_cast<void>(port::parse_write_answer(pdu, {.first = 1, .count = 2}, exception));
  port::Identity read;
  if (const auto next = port::parse_identification_answer(pdu, read)) {
    require(*next <= read.objects.size(), "an object beyond the last");
  }
  static_cast<void>(port::parse_server_id_answer(pdu));
}

void judge(std::uint8_t address, std::span<const std::uint8_t> pdu) {
  port::ClientRules rules{.units = {}, .may_write = pdu.size() % 2 == 0};
  for (std::size_t unit = 1; unit < 100; ++unit) rules.units.set(unit);
  const port::RtuQuestion question = port::question_of(pdu);
  if (port::judge(address, pdu, rules) != 0) return;
  require(address != 0 && pdu.size() <= port::pdu_bytes_max, "what may not be sent is sent");
  require(rules.may_write || !port::is_write_request(pdu), "what may not be written is written");
  require(port::answer_bytes(question) <= port::pdu_bytes_max, "an answer is too long");
  require(port::are_answered_alike(question, question), "a question is not like itself");
}

void cut_stream(std::span<const std::uint8_t> bytes, std::size_t piece) {
  port::FrameReader reader;
  while (!bytes.empty()) {
    const auto room = reader.free_space();
    require(!room.empty(), "a reader without room");
    const std::size_t size = std::min({room.size(), bytes.size(), piece});
    std::copy_n(bytes.begin(), size, room.begin());
    reader.received(size);
    bytes = bytes.subspan(size);
    port::Frame frame;
    port::FrameReader::Next next;
    while ((next = reader.next(frame)) == port::FrameReader::Next::frame) {
      require(frame.pdu.size() <= port::pdu_bytes_max, "a PDU is too long");
      if (frame.pdu.empty()) continue;
      judge(frame.address, frame.pdu);
      reply(frame.pdu);
    }
    if (next == port::FrameReader::Next::broken) return;
  }
}

void find_rtu(std::span<const std::uint8_t> bytes) {
  std::size_t from = 0;
  while (const auto answer = port::find_rtu_answer(bytes, from)) {
    require(answer->end > from && answer->end <= bytes.size(), "an answer ends nowhere");
    require(!answer->pdu.empty(), "an answer without a PDU");
    from = answer->end;
  }
}

}  // namespace

void run(std::span<const std::uint8_t> bytes) {
  Input input(bytes);
  const std::uint8_t choice = input.byte();
  // In memory that ends where it does.
  const std::span<const std::uint8_t> rest = input.rest();
  const std::vector<std::uint8_t> given(rest.begin(), rest.end());
  if (choice % 4 == 0) return cut_stream(given, 1u + choice / 4);
  if (choice % 4 == 1) return find_rtu(given);
  if (given.empty() || given.size() > port::pdu_bytes_max) return;
  judge(choice, given);
  reply(given);
  read_answers(given);
  if (given.size() < 12) return;
  const auto request = std::span(given).first(6), answer = std::span(given).subspan(6);
  static_cast<void>(port::answers(answer, port::question_of(request)));
}

}  // namespace etcm::fuzz

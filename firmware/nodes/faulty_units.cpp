#include "firmware/nodes/faulty_units.h"

#include <algorithm>
#include <string_view>

#include "firmware/protocol/modbus_exception.h"

namespace etcm::firmware {

std::optional<port::Instant> faulty_since(const Poller& poller, UnitIndex unit, port::Instant from,
                                          port::Duration patience, port::Instant now) {
  const UnitCounters& counters = poller.counters(unit);
  if (poller.is_sound(unit) || !poller.is_listed(unit) || !counters.has_answered()) {
    return std::nullopt;
  }
  if (counters.heard_fault == UnitFault::unbelieved &&
      counters.unbelieved_for == ReadingFault::none) {
    return std::nullopt;
  }
  // One that is asked seldom, or not heard each time, is faulty as long as it said nothing better.
  const bool is_heard =
      poller.is_up(poller.bus_of(unit)) &&
      (is_of_an_answer(counters.last_fault) ||
       (counters.heard_fault_at != port::Instant{} && now - counters.heard_fault_at <= patience));
  const port::Instant since = std::max(counters.sound_at, from);
  if (!is_heard || now - since <= patience) return std::nullopt;
  return since;
}

namespace {

// "WHAT: CURE", and one without a cure.
void split(std::string_view sentence, std::string_view else_cure, FaultText& text) {
  const std::size_t at = sentence.find(": ");
  text.what << ": " << sentence.substr(0, at);
  text.cure << (at == std::string_view::npos ? else_cure : sentence.substr(at + 2));
}

}  // namespace

FaultText explain_fault(const Poller& poller, UnitIndex unit) {
  const UnitCounters& counters = poller.counters(unit);
  FaultText text;
  text.what << poller.name(unit);
  switch (counters.heard_fault) {
    case UnitFault::exception: {
      const ExceptionText why = explain_exception(counters.exception, poller.is_node(unit));
      text.what << " answers with exception " << counters.exception << ": " << why.meaning;
      text.cure << why.cure;
      return text;
    }
    case UnitFault::unbelieved:
      split(explain_unbelieved(counters),
            "look at what it answers, with etcm-bus probe or etcm-bus read", text);
      return text;
    case UnitFault::jumped:
      text.what << ": its position jumps farther than speed_max allows, each time elsewhere";
      text.cure << "give it a greater speed_max if it is right (etcm-bus probe, some times in a "
                   "row)";
      return text;
    case UnitFault::torn:
      text.what << ": it changes its registers while they are read, each time";
      text.cure << "look at its firmware: registers 4 and 11 around each change";
      return text;
    case UnitFault::none:
    case UnitFault::timeout:
    case UnitFault::link_lost:
    case UnitFault::bad_answer:
      break;
  }
  text.what << ": its answers are garbled, or of the wrong unit, function or length";
  text.cure << "look for a second unit with its address, another speed, and noise on the line";
  return text;
}

}  // namespace etcm::firmware

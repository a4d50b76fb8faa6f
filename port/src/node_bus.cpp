#include "etcm/port/node_bus.h"

namespace etcm::port {

const char* to_string(BusResult result) noexcept {
  switch (result) {
    case BusResult::ok:
      return "ok";
    case BusResult::timeout:
      return "no answer in time";
    case BusResult::exception:
      return "exception";
    case BusResult::bad_answer:
      return "answer garbled, or of the wrong unit, function or length";
    case BusResult::link_lost:
      return "connection lost";
  }
  return "";
}

}  // namespace etcm::port

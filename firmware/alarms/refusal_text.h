// What is kept out of the mesh, for a person, and the alarm that it is.
#pragma once

#include <optional>
#include <string_view>

#include "firmware/alarms/alarm.h"
#include "firmware/gateway/gateway.h"
#include "firmware/logging/text_line.h"

namespace etcm::firmware {

// Of "what is wrong; what to do about it".
struct Sentence {
  std::string_view what;
  std::string_view cure;
};
Sentence parts_of(std::string_view sentence);

struct RefusalText {
  AlarmKey key;
  TextLine what;
  TextLine cure;
};
// None: the settings have no such feature any more.
std::optional<RefusalText> refusal_text(const Gateway& gateway, const QuarantineEntry& entry);

}  // namespace etcm::firmware

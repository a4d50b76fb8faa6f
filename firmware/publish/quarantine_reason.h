// Why something is in quarantine, as numbers for programs: published with the registers, so none
// ever gets another meaning.
#pragma once

#include <cstdint>
#include <span>

#include "firmware/nodes/doubt.h"
#include "firmware/site/refusal.h"

namespace etcm::firmware {

struct QuarantineReason {
  std::uint16_t code;
  Refusal refusal;
  Doubt doubt;
  const char* meaning;  // for the guide
};

std::span<const QuarantineReason> quarantine_reasons();

// other_reason where the table has none.
inline constexpr std::uint16_t other_reason = 255;
std::uint16_t reason_code(const Refusal& refusal, Doubt doubt);

}  // namespace etcm::firmware

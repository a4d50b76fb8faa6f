// Why something is in quarantine, as numbers for programs: published with the registers, so none
// ever gets another meaning.
#pragma once

#include <cstdint>
#include <span>

#include "firmware/nodes/identity_conflict.h"
#include "firmware/site/rejection.h"

namespace etcm::firmware {

struct QuarantineReason {
  std::uint16_t code;
  Rejection rejection;
  IdentityConflict conflict;
  const char* meaning;  // for the guide
};

std::span<const QuarantineReason> quarantine_reasons();

// other_reason where the table has none.
inline constexpr std::uint16_t other_reason = 255;
std::uint16_t reason_code(const Rejection& rejection, IdentityConflict conflict);

}  // namespace etcm::firmware

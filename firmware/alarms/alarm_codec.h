// The book of alarms in bytes. How they get to the disk is the store's business.
//
// All numbers are little-endian, and everything follows the one before without gaps:
//   u32 version of this form, 1
//   u32 count of alarms: first those that have ended, the oldest first, then those that are on
//   alarm: u32 number, u8 kind, u8 flags (1 is on, 2 is acknowledged, 4 has ended
//          less than recurrence_pause before this was written), u8 why it is on no longer
//          (AlarmEnd; earlier gateways have 0 there), u8 0, u64 subject,
//          u32 times, i64 since, i64 until, both in ms since 1970 (UTC; 0: not known), u16 bytes of
//          the text, u16 of the cure, and both
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "firmware/alarms/alarm_book.h"

namespace etcm::firmware {

inline constexpr std::uint32_t saved_alarms_version = 1;
// More bytes no book has.
inline constexpr std::size_t saved_alarms_size_max =
    8 + (open_alarms_max + kept_alarms_max) * (44 + Alarm::text_max);

// Replaces `bytes`. `unix_now_ms`: the time of day at `now`, 0 where it is not known.
void encode_alarms(const AlarmBook& book, port::Instant now, std::int64_t unix_now_ms,
                   std::vector<std::byte>& bytes);

// Into an empty book. Returns what is wrong with the bytes, as in "it is cut off", and the book may
// have some of them then; empty where nothing is. `unix_now_ms` as above: what ended less than
// recurrence_pause ago may go on. A clock that was set back less than that is no matter.
std::string decode_alarms(std::span<const std::byte> bytes, port::Instant now,
                          std::int64_t unix_now_ms, AlarmBook& book);

}  // namespace etcm::firmware

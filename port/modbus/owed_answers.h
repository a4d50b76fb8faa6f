// What a unit may still answer on a line whose answers carry no number, and what it may therefore
// be asked: nothing whose answer would look like one that is still under way.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>

#include "etcm/port/clock.h"
#include "modbus/question.h"

namespace etcm::port {

// An answer may come so long after the wait for it has ended.
inline constexpr Duration late_answer_max = std::chrono::seconds(5);
// However slow a unit has been, it may come no later than this.
inline constexpr Duration late_answer_longest = std::chrono::minutes(1);

// Of one unit.
class OwedAnswers {
 public:
  // Questions it can remember.
  static constexpr std::size_t count_max = 8;

  // From when on the question may be asked: when its answer, and no other, will be what looks like
  // one. At once where that is not later than now.
  Instant free_at(const RtuQuestion& question) const;

  // When a question that is answered alike was asked in vain, if one is remembered, however long
  // ago and even if its answer has come.
  std::optional<Instant> asked_at(const RtuQuestion& question) const;

  // Until when an answer with this function may come; the origin: none was owed.
  Instant owed_until(std::uint8_t function) const;

  // The question is asked now; what was owed to one like it is not remembered any more. REQUIRES:
  // it is free.
  void forget(const RtuQuestion& question);
  // It was waited for in vain; its answer may come until then.
  void add(const RtuQuestion& question, Instant asked_at, Instant until);

  // An answer to it has come that nobody waited for, and that was not owed: another one like it may
  // come until then.
  void add_unasked(const RtuQuestion& question, Instant now, Instant until);

  // Something came that was not waited for. Returns when it was asked for, where that is certain,
  // and that answer is no longer owed. An exception tells no count, so it may be for several; and
  // what was owed until a minute ago is for nothing that is remembered.
  std::optional<Instant> take(std::span<const std::uint8_t> pdu, Instant now);

 private:
  struct Owed {
    RtuQuestion question;
    Instant asked_at{};
    Instant until{};
    bool is_remembered = false;
    bool has_come = false;
  };
  const Owed* find(const RtuQuestion& question) const;
  // Where one that is answered alike is remembered; else what will be forgotten first.
  Owed& place_for(const RtuQuestion& question);

  std::array<Owed, count_max> owed_{};
};

}  // namespace etcm::port

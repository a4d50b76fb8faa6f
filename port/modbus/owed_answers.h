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

// Two that answer at one unit are taken for gone when only one was heard for so long.
inline constexpr Duration doubled_for = std::chrono::minutes(1);

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

  // It was answered in time. Where two answer at the unit, its other answer may come for so long.
  void note_answered(const RtuQuestion& question, Instant asked_at, Instant now, Duration latest);

  // An answer to it has come that nobody waited for, and that was not owed: another one like it may
  // come for so long. Where it was answered no longer ago, two answer at the unit, so all that was
  // answered may be answered once more, and so may what will be in the next doubled_for.
  void add_unasked(const RtuQuestion& question, Instant now, Duration latest);

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
    bool was_answered = false;  // in time: only another one's answer may come
  };
  const Owed* find(const RtuQuestion& question) const;
  // Where one that is answered alike is remembered; else what will be forgotten first.
  Owed& place_for(const RtuQuestion& question);

  // It is remembered only for the case that two answer.
  static bool is_settled(const Owed& owed) { return owed.was_answered && owed.until == Instant{}; }

  std::array<Owed, count_max> owed_{};
  Instant doubled_until_{};
};

}  // namespace etcm::port

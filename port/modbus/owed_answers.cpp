#include "modbus/owed_answers.h"

#include <algorithm>

namespace etcm::port {

const OwedAnswers::Owed* OwedAnswers::find(const RtuQuestion& question) const {
  const auto found = std::find_if(owed_.begin(), owed_.end(), [&](const Owed& owed) {
    return owed.is_remembered && !is_settled(owed) && are_answered_alike(owed.question, question);
  });
  return found == owed_.end() ? nullptr : &*found;
}

Instant OwedAnswers::free_at(const RtuQuestion& question) const {
  if (const Owed* const owed = find(question)) return owed->until;
  // To be remembered it needs room.
  Instant room_at = never;
  for (const Owed& owed : owed_) {
    room_at = std::min(room_at, owed.is_remembered ? owed.until : Instant{});
  }
  return room_at;
}

std::optional<Instant> OwedAnswers::asked_at(const RtuQuestion& question) const {
  const Owed* const owed = find(question);
  return owed == nullptr ? std::nullopt : std::optional(owed->asked_at);
}

Instant OwedAnswers::owed_until(std::uint8_t function) const {
  Instant until{};
  for (const Owed& owed : owed_) {
    if (owed.is_remembered && owed.question.function == function) {
      until = std::max(until, owed.until);
    }
  }
  return until;
}

void OwedAnswers::forget(const RtuQuestion& question) {
  for (Owed& owed : owed_) {
    if (are_answered_alike(owed.question, question)) owed.is_remembered = false;
  }
}

void OwedAnswers::add(const RtuQuestion& question, Instant asked_at, Instant until) {
  place_for(question) = {
      .question = question, .asked_at = asked_at, .until = until, .is_remembered = true};
}

void OwedAnswers::note_answered(const RtuQuestion& question, Instant asked_at, Instant now,
                                Duration latest) {
  place_for(question) = {.question = question,
                         .asked_at = asked_at,
                         .until = now < doubled_until_ ? now + latest : Instant{},
                         .is_remembered = true,
                         .has_come = true,
                         .was_answered = true};
}

void OwedAnswers::add_unasked(const RtuQuestion& question, Instant now, Duration latest) {
  const auto may_be_answered_again = [&](const Owed& owed) {
    return owed.is_remembered && owed.was_answered && now <= owed.asked_at + latest;
  };
  Owed& like_it = place_for(question);
  if (may_be_answered_again(like_it) && are_answered_alike(like_it.question, question)) {
    doubled_until_ = now + doubled_for;
    for (Owed& owed : owed_) {
      if (may_be_answered_again(owed)) owed.until = now + latest;
    }
    return;
  }
  // Nobody knows when it was asked for, so the next one tells no latency.
  like_it = {.question = question,
             .asked_at = now,
             .until = now + latest,
             .is_remembered = true,
             .has_come = true};
}

OwedAnswers::Owed& OwedAnswers::place_for(const RtuQuestion& question) {
  Owed* place = nullptr;
  for (Owed& owed : owed_) {
    if (owed.is_remembered && are_answered_alike(owed.question, question)) return owed;
    const auto end_of = [](const Owed& other) {
      return other.is_remembered ? other.until : Instant::min();
    };
    if (place == nullptr || end_of(owed) < end_of(*place)) place = &owed;
  }
  return *place;
}

std::optional<Instant> OwedAnswers::take(std::span<const std::uint8_t> pdu, Instant now) {
  const bool is_exception = (pdu[0] & exception_bit) != 0;
  const std::uint8_t function = pdu[0] & static_cast<std::uint8_t>(~exception_bit);
  Owed* found = nullptr;
  for (Owed& owed : owed_) {
    if (!owed.is_remembered || owed.has_come || owed.question.function != function) continue;
    if (owed.until + late_answer_longest < now) continue;
    if (!is_exception && !answers(pdu, owed.question)) continue;
    if (found != nullptr) return std::nullopt;
    found = &owed;
  }
  if (found == nullptr) return std::nullopt;
  found->has_come = true;
  found->until = Instant{};
  return found->asked_at;
}

}  // namespace etcm::port

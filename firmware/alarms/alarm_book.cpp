#include "firmware/alarms/alarm_book.h"

#include <algorithm>
#include <utility>

namespace etcm::firmware {

AlarmBook::AlarmBook() {
  slots_.reserve(open_alarms_max);
  by_key_.reserve(open_alarms_max);
  free_.reserve(open_alarms_max);
  ended_.reserve(kept_alarms_max);
}

std::vector<std::uint32_t>::const_iterator AlarmBook::place_of(AlarmKey key) const {
  return std::lower_bound(
      by_key_.begin(), by_key_.end(), key,
      [this](std::uint32_t slot, AlarmKey wanted) { return slots_[slot].alarm.key < wanted; });
}

bool AlarmBook::is_at(std::vector<std::uint32_t>::const_iterator place, AlarmKey key) const {
  return place != by_key_.end() && slots_[*place].alarm.key == key;
}

const Alarm* AlarmBook::find_on(AlarmKey key) const {
  const auto place = place_of(key);
  return is_at(place, key) && slots_[*place].alarm.is_on ? &slots_[*place].alarm : nullptr;
}

AlarmBook::Slot* AlarmBook::add(std::vector<std::uint32_t>::const_iterator place) {
  if (by_key_.size() == open_alarms_max) return nullptr;
  std::uint32_t slot = 0;
  if (free_.empty()) {
    slot = static_cast<std::uint32_t>(slots_.size());
    slots_.emplace_back();
  } else {
    slot = free_.back();
    free_.pop_back();
    slots_[slot] = {};
  }
  by_key_.insert(place, slot);
  return &slots_[slot];
}

void AlarmBook::begin_look(port::Instant now) {
  now_ = now;
  wants_look_ = false;
  ++look_;
  untold_in_look_ = 0;
}

void AlarmBook::hold(AlarmKey key, port::Instant since, std::string_view text,
                     std::string_view cure) {
  const port::Instant begin = since == port::Instant{} ? now_ : std::min(since, now_);
  const auto place = place_of(key);
  Slot* slot = is_at(place, key) ? &slots_[*place] : add(place);
  if (slot == nullptr) {
    ++untold_in_look_;
    return;
  }
  slot->look = look_;
  slot->is_dismissed = false;
  Alarm& alarm = slot->alarm;
  const bool is_reworded = alarm.set_words(text, cure);
  if (alarm.is_on) {
    is_reworded_ = is_reworded_ || is_reworded;
    return;
  }
  if (alarm.number == 0) {
    alarm.number = ++last_number_;
    alarm.key = key;
  } else {
    ++alarm.times;
  }
  alarm.severity = severity_of(key.kind);
  alarm.is_on = true;
  alarm.since = {.at = begin};
  alarm.until = {};
  alarm.end = AlarmEnd::unknown;
  ++events_ever_;
}

void AlarmBook::dismiss(AlarmKey key) {
  const auto place = place_of(key);
  if (is_at(place, key)) slots_[*place].is_dismissed = wants_look_ = true;
}

void AlarmBook::end(Slot& slot, AlarmEnd why) {
  slot.ended_at = now_;
  slot.alarm.is_on = false;
  slot.alarm.end = why;
  slot.alarm.until = {.at = now_};
  ++events_ever_;
}

void AlarmBook::close_look() {
  auto kept = by_key_.begin();
  for (const std::uint32_t number : by_key_) {
    const Slot& slot = slots_[number];
    if (!slot.alarm.is_on && now_ - slot.ended_at > recurrence_pause) {
      append_ended(slot.alarm);
      free_.push_back(number);
    } else {
      *kept++ = number;
    }
  }
  by_key_.erase(kept, by_key_.end());
  untold_ = untold_in_look_;
  if (is_reworded_ && (rewordings_ == 0 || now_ - reworded_at_ >= words_pause)) {
    ++rewordings_;
    is_reworded_ = false;
    reworded_at_ = now_;
  }
  count();
}

void AlarmBook::append_ended(const Alarm& alarm) {
  ++ended_ever_;
  if (ended_.size() < kept_alarms_max) {
    ended_.push_back(alarm);
    return;
  }
  ended_[first_] = alarm;
  first_ = (first_ + 1) % kept_alarms_max;
}

void AlarmBook::count() {
  on_ = unacknowledged_ = 0;
  std::fill(std::begin(by_severity_), std::end(by_severity_), 0);
  for (const std::uint32_t number : by_key_) {
    const Alarm& alarm = slots_[number].alarm;
    if (!alarm.is_on) continue;
    ++on_;
    ++by_severity_[static_cast<std::size_t>(alarm.severity)];
    if (!alarm.is_acknowledged) ++unacknowledged_;
  }
}

bool AlarmBook::acknowledge(std::uint32_t number) {
  for (const std::uint32_t slot : by_key_) {
    Alarm& alarm = slots_[slot].alarm;
    if (alarm.number != number || !alarm.is_on) continue;
    if (!std::exchange(alarm.is_acknowledged, true)) {
      ++events_ever_;
      ++acknowledged_ever_;
      --unacknowledged_;
    }
    return true;
  }
  return false;
}

std::uint32_t AlarmBook::acknowledge_all() {
  std::uint32_t changed = 0;
  for (const std::uint32_t slot : by_key_) {
    Alarm& alarm = slots_[slot].alarm;
    if (alarm.is_on && !std::exchange(alarm.is_acknowledged, true)) ++changed;
  }
  events_ever_ += changed;
  acknowledged_ever_ += changed;
  unacknowledged_ = 0;
  return changed;
}

bool AlarmBook::restore(const Alarm& alarm) {
  if (alarm.is_on) return add_restored(alarm) != nullptr;
  last_number_ = std::max(last_number_, alarm.number);
  append_ended(alarm);
  return true;
}

bool AlarmBook::restore_lately(const Alarm& alarm, port::Instant ended_at) {
  Slot* const slot = add_restored(alarm);
  if (slot == nullptr) return false;
  slot->ended_at = ended_at;
  return true;
}

AlarmBook::Slot* AlarmBook::add_restored(const Alarm& alarm) {
  const auto place = place_of(alarm.key);
  Slot* const slot = is_at(place, alarm.key) ? nullptr : add(place);
  if (slot == nullptr) return nullptr;
  last_number_ = std::max(last_number_, alarm.number);
  slot->alarm = alarm;
  count();
  return slot;
}

}  // namespace etcm::firmware

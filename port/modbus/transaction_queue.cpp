#include "modbus/transaction_queue.h"

#include <algorithm>
#include <utility>

namespace etcm::port {

namespace {

// A hold that has shrunk to this is none.
constexpr Duration hold_least = std::chrono::milliseconds(100);

}  // namespace

TransactionQueue::TransactionQueue(std::uint32_t window_max)
    : window_max_(window_max), window_(window_max) {
  entries_.reserve(window_max + remembered_max + 1);
}

std::size_t TransactionQueue::waiting_count() const {
  return static_cast<std::size_t>(
      std::count_if(entries_.begin(), entries_.end(),
                    [](const Entry& entry) { return entry.state == State::waiting; }));
}

std::uint32_t TransactionQueue::taken_count() const {
  return static_cast<std::uint32_t>(
      std::count_if(entries_.begin(), entries_.end(), [](const Entry& entry) {
        return entry.state == State::waiting || entry.state == State::held;
      }));
}

bool TransactionQueue::has_room() const { return taken_count() < window_; }

Duration TransactionQueue::patience(const TcpRequest& request) const {
  const Duration of_line = slow_count_ < slow_units_of_a_line ? Duration{} : least_patience_;
  return std::max({request.timeout, patience_[request.address], of_line});
}

Instant TransactionQueue::deadline(const Entry& entry, bool is_silent) const {
  if (is_silent) return entry.request.sent_at + patience(entry.request);
  return entry.head_at == never ? never : entry.head_at + patience(entry.request);
}

bool TransactionQueue::is_owed(std::uint16_t transaction) const {
  return std::any_of(entries_.begin(), entries_.end(),
                     [&](const Entry& entry) { return entry.owes(transaction); });
}

void TransactionQueue::add(const TcpRequest& request, Instant now) {
  forget_some();
  entries_.push_back({.request = request});
  start_heads(now);
}

std::optional<TcpRequest> TransactionQueue::answer(std::uint16_t transaction, bool is_of_unit) {
  const auto found = std::find_if(entries_.begin(), entries_.end(),
                                  [&](const Entry& entry) { return entry.owes(transaction); });
  if (found == entries_.end()) return std::nullopt;
  const bool is_waited_for = found->state == State::waiting;
  is_heard_ = true;
  found->is_of_unit = is_of_unit;
  found->state = is_waited_for ? State::answered : State::answered_late;
  for (auto behind = found + 1; behind != entries_.end(); ++behind) behind->has_moved_up = true;
  return is_waited_for ? std::optional(found->request) : std::nullopt;
}

void TransactionQueue::advance(Instant now) {
  for (std::size_t i = 0; i < entries_.size();) {
    if (entries_[i].state < State::answered) {
      ++i;
    } else {
      take_answer(i, now);
      entries_.erase(entries_.begin() + static_cast<std::ptrdiff_t>(i));
    }
  }
  for (Entry& entry : entries_) {
    if (entry.state != State::held || entry.until > now) continue;
    entry.state = State::remembered;
    shrink_hold();
  }
  start_heads(now);
}

void TransactionQueue::take_answer(std::size_t index, Instant now) {
  const Entry answered = entries_[index];
  const Instant begun = answered.head_at == never ? answered.request.sent_at : answered.head_at;
  const Duration latency = now - begun;
  const bool is_late = answered.state == State::answered_late;
  overtake(index, now, !is_late && now - answered.request.sent_at <= answered.request.timeout);
  if (is_late && answered.is_of_unit && latency <= patience(answered.request)) {
    held_up_.set(answered.request.address);
  }
  if (is_late && latency > patience(answered.request)) {
    learn(answered, latency);
  } else if (!is_late && ++in_time_ >= grows_after) {
    in_time_ = 0;
    window_ = std::min(window_ + 1, window_max_);
  }
  // Its timeout is too short all the same.
  if (!is_late && patience_[answered.request.address] > Duration{} &&
      latency > answered.request.timeout) {
    note_late({.address = answered.request.address, .has_come = true, .latency = latency});
  }
  for (std::size_t i = index + 1; i < entries_.size(); ++i) {
    Entry& behind = entries_[i];
    const bool has_moved_up = std::exchange(behind.has_moved_up, false);
    if (!has_moved_up || !is_queue() || behind.is_overtaken) continue;
    // It has been waiting for this.
    if (behind.head_at != never) behind.head_at = now;
  }
}

// Those before an answered request are not what it waited for, or will not be answered any more: a
// converter may have given up the first one just before it took this, so it is in good time for
// both of them that shows that there is no queue.
void TransactionQueue::overtake(std::size_t index, Instant now, bool is_in_time) {
  Instant first_head = never;
  std::uint8_t first = 0;
  for (std::size_t i = 0; i < index; ++i) {
    Entry& entry = entries_[i];
    if (!blocks(entry)) continue;
    if (entry.head_at < first_head) {
      first_head = entry.head_at;
      first = entry.request.address;
    }
    entry.is_overtaken = true;
    if (entry.state == State::held) entry.state = State::remembered;
  }
  if (first_head == never || !is_queue()) return;
  if (is_in_time) {
    if (now - first_head > entries_[index].request.timeout) return;
    is_proven_ = false;
    hold_ = Duration{};
  } else {
    note_late({.address = first, .has_come = false, .latency = now - first_head});
    prove(now - first_head);
  }
}

void TransactionQueue::learn(const Entry& late, Duration latency) {
  Duration& learned = patience_[late.request.address];
  const Duration needed = std::min(latency + latency / 4, learned_patience_max);
  if (learned == Duration{}) ++slow_count_;
  learned = std::max(learned, needed);
  least_patience_ = slow_count_ == 1 ? learned : std::min(least_patience_, learned);
  note_late({.address = late.request.address, .has_come = true, .latency = latency});
  if (!late.is_overtaken) prove(latency);
}

// Nothing came, so the line was free before. What a slow answer has taught is not for ever: each
// wait in vain costs all others what it says.
void TransactionQueue::shrink_hold() {
  if (is_proven_) {
    hold_ = std::max(std::min(hold_, hold_unheard), hold_ / 2);
  } else {
    hold_ = hold_ / 2 < hold_least ? Duration{} : hold_ / 2;
  }
}

void TransactionQueue::note_late(const LateTransaction& late) {
  if (!late_ || late_->latency < late.latency) late_ = late;
}

void TransactionQueue::prove(Duration latency) {
  const Duration hold = std::min(latency + latency / 2, hold_max);
  hold_ = is_proven_ ? std::max(hold_, hold) : hold;
  is_proven_ = true;
  in_time_ = 0;
  window_ = std::max(1u, window_ / 2);
}

void TransactionQueue::start_heads(Instant now) {
  bool is_behind = false;
  for (Entry& entry : entries_) {
    if (entry.head_at == never && !(is_behind && is_queue())) entry.head_at = now;
    is_behind = is_behind || blocks(entry);
  }
}

std::optional<TcpRequest> TransactionQueue::give_up(Instant now, bool is_silent) {
  const auto found = std::find_if(entries_.begin(), entries_.end(), [&](const Entry& entry) {
    return entry.state == State::waiting && deadline(entry, is_silent) <= now;
  });
  if (found == entries_.end()) return std::nullopt;
  const bool has_others = std::any_of(
      found + 1, entries_.end(), [](const Entry& entry) { return entry.state == State::waiting; });
  const bool is_held =
      is_queue() && !is_silent && !found->is_overtaken && (is_proven_ || has_others);
  found->state = is_held ? State::held : State::remembered;
  if (!is_heard_) hold_ = std::min(hold_, hold_unheard);
  found->until = now + hold_;
  start_heads(now);
  return found->request;
}

std::optional<TcpRequest> TransactionQueue::abandon() {
  for (; !entries_.empty(); entries_.erase(entries_.begin())) {
    if (entries_.front().state != State::waiting) continue;
    const TcpRequest request = entries_.front().request;
    entries_.erase(entries_.begin());
    return request;
  }
  return std::nullopt;
}

Instant TransactionQueue::next_deadline() const {
  Instant next = never;
  for (const Entry& entry : entries_) {
    if (entry.state >= State::answered) return Instant{};
    if (entry.state == State::waiting) next = std::min(next, deadline(entry, false));
    if (entry.state == State::held) next = std::min(next, entry.until);
  }
  return next;
}

std::optional<LateTransaction> TransactionQueue::take_late() {
  return std::exchange(late_, std::nullopt);
}

std::optional<std::uint8_t> TransactionQueue::take_held_up() {
  for (std::size_t address = 0; held_up_.any() && address < held_up_.size(); ++address) {
    if (!held_up_.test(address)) continue;
    held_up_.reset(address);
    return static_cast<std::uint8_t>(address);
  }
  return std::nullopt;
}

// Of those that are only remembered, the last ones.
void TransactionQueue::forget_some() {
  const auto remembered = std::count_if(entries_.begin(), entries_.end(), [](const Entry& entry) {
    return entry.state == State::remembered;
  });
  if (static_cast<std::size_t>(remembered) < remembered_max) return;
  const auto oldest = std::find_if(entries_.begin(), entries_.end(), [](const Entry& entry) {
    return entry.state == State::remembered;
  });
  entries_.erase(oldest);
}

}  // namespace etcm::port

// Of entries that come in any order the least, as many as the caller has room for, in order.
#pragma once

#include <cstddef>
#include <span>

namespace etcm::internal {

// The span is a heap with the greatest entry on top until sort(). `precedes` is a strict order.
// Not the heap of <algorithm>, which a compiler takes for something that throws: a C program would
// need a run-time of C++.
template <class Entry, class Precedes>
class LeastEntries {
 public:
  LeastEntries(std::span<Entry> out, Precedes precedes) noexcept : out_(out), precedes_(precedes) {}

  // O(log n).
  void offer(const Entry& entry) noexcept {
    if (!is_full()) {
      rise(entry);
    } else if (!out_.empty() && precedes_(entry, out_.front())) {
      sink(entry, count_);
    }
  }

  bool is_full() const noexcept { return count_ == out_.size(); }
  // Of those that are kept; there is one.
  const Entry& greatest() const noexcept { return out_.front(); }

  // After the last one is offered. O(n log n).
  void sort() noexcept {
    for (std::size_t left = count_; left > 1; --left) {
      const Entry last = out_[left - 1];
      out_[left - 1] = out_[0];
      sink(last, left - 1);
    }
  }

 private:
  // One more, from the end upwards.
  void rise(const Entry& entry) noexcept {
    std::size_t at = count_++;
    for (; at != 0 && precedes_(out_[(at - 1) / 2], entry); at = (at - 1) / 2) {
      out_[at] = out_[(at - 1) / 2];
    }
    out_[at] = entry;
  }

  // In place of the greatest of the first `count`, from the top downwards.
  void sink(const Entry& entry, std::size_t count) noexcept {
    std::size_t at = 0;
    for (std::size_t below = 1; below < count; below = 2 * at + 1) {
      if (below + 1 < count && precedes_(out_[below], out_[below + 1])) ++below;
      if (!precedes_(entry, out_[below])) break;
      out_[at] = out_[below];
      at = below;
    }
    out_[at] = entry;
  }

  std::span<Entry> out_;
  Precedes precedes_;
  std::size_t count_ = 0;
};

}  // namespace etcm::internal

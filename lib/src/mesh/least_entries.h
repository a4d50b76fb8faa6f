// Of entries that come in any order the least, as many as the caller has room for, in order.
#pragma once

#include <algorithm>
#include <cstddef>
#include <span>

namespace etcm::internal {

// The span is a heap with the greatest entry on top until sort(). `precedes` is a strict order.
template <class Entry, class Precedes>
class LeastEntries {
 public:
  LeastEntries(std::span<Entry> out, Precedes precedes) noexcept : out_(out), precedes_(precedes) {}

  // O(log n).
  void offer(const Entry& entry) noexcept {
    if (!is_full()) {
      out_[count_++] = entry;
    } else {
      if (out_.empty() || !precedes_(entry, out_.front())) return;
      std::pop_heap(out_.begin(), out_.end(), precedes_);
      out_.back() = entry;
    }
    const auto kept = out_.first(count_);
    std::push_heap(kept.begin(), kept.end(), precedes_);
  }

  bool is_full() const noexcept { return count_ == out_.size(); }
  // Of those that are kept; there is one.
  const Entry& greatest() const noexcept { return out_.front(); }

  // After the last one is offered. O(n log n).
  void sort() noexcept {
    const auto kept = out_.first(count_);
    std::sort_heap(kept.begin(), kept.end(), precedes_);
  }

 private:
  std::span<Entry> out_;
  Precedes precedes_;
  std::size_t count_ = 0;
};

}  // namespace etcm::internal

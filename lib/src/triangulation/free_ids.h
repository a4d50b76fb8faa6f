// The ids below an end that nobody has. The least is given out first, so which one comes next can
// be told from those that are in use.
//
// They are a heap: the least is at its root, and below each of them hang two heaps, the left one
// with no fewer ids (Cho and Sahni 1998). So the way down its right side is logarithmic, two heaps
// become one along theirs in a single pass, and no id needs to know what is above it. It lies in
// the records of those ids, which nobody reads: it takes no memory.
#pragma once

#include <cstddef>

#include "etcm/types.h"

namespace etcm::internal {

// Record i begins at `first` + i * `stride`, and is aligned to an id.
struct FreeRecords {
  std::byte* first;
  std::size_t stride;
};

class FreeIds {
 public:
  bool is_empty() const noexcept { return least_ == VertexId::none_value; }
  IdValue count(FreeRecords records) const noexcept;
  // O(log n) each. Takes an id that is not in it.
  void add(FreeRecords records, IdValue id) noexcept;
  // The least. It must not be empty.
  IdValue take(FreeRecords records) noexcept;
  // Keeps those below the end. O(n log n).
  void keep_below(FreeRecords records, IdValue end) noexcept;

 private:
  IdValue least_ = VertexId::none_value;
};

}  // namespace etcm::internal

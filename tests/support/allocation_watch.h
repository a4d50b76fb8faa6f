// Counts what is allocated while a watch is alive: by operator new in any form, and by the C
// functions called from the program itself (they are wrapped when the test is linked, see
// tests/support/CMakeLists.txt; a call from inside a shared library is not seen).
#pragma once

#include <cstddef>

namespace etcm::test {

class AllocationWatch {
 public:
  AllocationWatch() noexcept;
  ~AllocationWatch();
  AllocationWatch(const AllocationWatch&) = delete;
  AllocationWatch& operator=(const AllocationWatch&) = delete;

  std::size_t allocations() const noexcept;
  // By operator new alone: what was taken and not given back, as large as the heap makes it.
  // Less than 0 where more was given back.
  std::ptrdiff_t held_bytes() const noexcept;
};

}  // namespace etcm::test

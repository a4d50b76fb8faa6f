#include "support/allocation_watch.h"

#include <malloc.h>

#include <atomic>
#include <cstdlib>
#include <new>

namespace {

// What other threads allocate counts too.
std::atomic<bool> watching = false;
std::atomic<std::size_t> counted = 0;
std::atomic<std::ptrdiff_t> held = 0;

void count() noexcept {
  if (watching) ++counted;
}

// With what the heap keeps beside it.
std::ptrdiff_t size_in_heap(void* memory) noexcept {
  if (memory == nullptr) return 0;
  return static_cast<std::ptrdiff_t>(malloc_usable_size(memory) + sizeof(std::size_t));
}

void* taken(void* memory) noexcept {
  if (watching) held += size_in_heap(memory);
  return memory;
}

void give_back(void* memory) noexcept {
  if (watching) held -= size_in_heap(memory);
  std::free(memory);
}

}  // namespace

extern "C" {
// The linker gives these names their meaning: --wrap turns each call of malloc into one of
// __wrap_malloc, and __real_malloc into malloc itself.
// NOLINTBEGIN(bugprone-reserved-identifier)
void* __real_malloc(std::size_t size);
void* __real_calloc(std::size_t items, std::size_t size);
void* __real_realloc(void* memory, std::size_t size);
void* __real_aligned_alloc(std::size_t alignment, std::size_t size);

void* __wrap_malloc(std::size_t size) {
  count();
  return __real_malloc(size);
}
void* __wrap_calloc(std::size_t items, std::size_t size) {
  count();
  return __real_calloc(items, size);
}
void* __wrap_realloc(void* memory, std::size_t size) {
  count();
  return __real_realloc(memory, size);
}
void* __wrap_aligned_alloc(std::size_t alignment, std::size_t size) {
  count();
  return __real_aligned_alloc(alignment, size);
}
// NOLINTEND(bugprone-reserved-identifier)
}

// The other forms of operator new end in these two; the matching deletes are defined because a
// program that replaces one must replace the other.
void* operator new(std::size_t size) {
  count();
  if (void* memory = __real_malloc(size == 0 ? 1 : size)) return taken(memory);
  throw std::bad_alloc();
}
void* operator new(std::size_t size, std::align_val_t alignment) {
  count();
  const auto step = static_cast<std::size_t>(alignment);
  void* const memory = __real_aligned_alloc(step, (size + step - 1) / step * step);
  if (memory != nullptr) return taken(memory);
  throw std::bad_alloc();
}
// As std::stable_sort asks.
void* operator new(std::size_t size, const std::nothrow_t&) noexcept {
  count();
  return taken(__real_malloc(size == 0 ? 1 : size));
}
void operator delete(void* memory) noexcept { give_back(memory); }
void operator delete(void* memory, const std::nothrow_t&) noexcept { give_back(memory); }
void operator delete(void* memory, std::size_t) noexcept { give_back(memory); }
void operator delete(void* memory, std::align_val_t) noexcept { give_back(memory); }
void operator delete(void* memory, std::size_t, std::align_val_t) noexcept { give_back(memory); }

namespace etcm::test {

AllocationWatch::AllocationWatch() noexcept {
  counted = 0;
  held = 0;
  watching = true;
}
AllocationWatch::~AllocationWatch() { watching = false; }
std::size_t AllocationWatch::allocations() const noexcept { return counted; }
std::ptrdiff_t AllocationWatch::held_bytes() const noexcept { return held; }

}  // namespace etcm::test

// An array in memory that lies there already.
#pragma once

#include <cstddef>
#include <new>
#include <type_traits>

namespace etcm::internal {

// Begins `count` elements there without a value: nothing is written. Not `new T[count]`, which asks
// the run-time of C++ what to do where so many are more than memory can be.
template <class T>
T* begin_array(void* at, std::size_t count) noexcept {
  static_assert(std::is_trivially_default_constructible_v<T>);
  auto* const bytes = static_cast<std::byte*>(at);
  for (std::size_t i = 0; i < count; ++i) ::new (bytes + i * sizeof(T)) T;
  return std::launder(reinterpret_cast<T*>(bytes));
}

}  // namespace etcm::internal

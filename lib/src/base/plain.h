// Functions of programs, which may be C's.
#pragma once

namespace etcm::internal {

// The function as one that throws nothing. Who calls it then provides for no exception, for which a
// C program would need a run-time of C++; what throws all the same ends the program, as before.
template <class Result, class... Arguments>
[[gnu::always_inline]] inline auto plain(Result (*function)(Arguments...)) noexcept {
  return reinterpret_cast<Result (*)(Arguments...) noexcept>(function);
}

}  // namespace etcm::internal

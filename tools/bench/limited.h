// Runs a measurement in a process of its own, so that one that hangs or dies costs a row, not the
// table.
#pragma once

#include <algorithm>
#include <chrono>
#include <cstddef>
#include <functional>
#include <optional>
#include <span>
#include <type_traits>

namespace etcm::bench {

// Runs `measure` in a child, which writes its answer into `result`. False when it died or did not
// end within the limit; `result` is then undefined.
bool run_in_child(std::chrono::milliseconds limit, std::span<std::byte> result,
                  const std::function<void(std::span<std::byte>)>& measure);

template <class Measure>
auto run_limited(std::chrono::milliseconds limit, const Measure& measure)
    -> std::optional<decltype(measure())> {
  using Result = decltype(measure());
  static_assert(std::is_trivially_copyable_v<Result>, "the answer goes through a pipe");
  Result result{};
  const bool done = run_in_child(limit, std::as_writable_bytes(std::span(&result, 1)),
                                 [&](std::span<std::byte> answer) {
                                   const Result measured = measure();
                                   const auto bytes = std::as_bytes(std::span(&measured, 1));
                                   std::copy(bytes.begin(), bytes.end(), answer.begin());
                                 });
  if (!done) return std::nullopt;
  return result;
}

}  // namespace etcm::bench

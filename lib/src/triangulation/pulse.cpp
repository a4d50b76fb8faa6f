#include "triangulation/pulse.h"

namespace etcm::internal {

void Pulse::beat() noexcept {
  left_ = KeepAlive::units_between;
  if (hook_.call != nullptr) hook_.call(hook_.context);
}

void sum_up(Checksum& sum, const std::byte* bytes, std::size_t count, Pulse& pulse) noexcept {
  // Of whole words, so that a part does not end one.
  constexpr std::size_t part = 256;
  for (; count > part; count -= part, bytes += part) {
    sum.add(bytes, part);
    pulse.pass(part / 32);
  }
  sum.add(bytes, count);
  pulse.pass(part / 32);
}

}  // namespace etcm::internal

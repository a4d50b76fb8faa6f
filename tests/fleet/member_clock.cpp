#include "member_clock.h"

#include <array>
#include <chrono>
#include <ctime>

namespace etcm::test {

using std::chrono::milliseconds;
using std::chrono::seconds;

void MemberClock::boot(inputs::Random& random, port::Instant time) {
  constexpr std::uint64_t moment_ms = 20'000, years_ms = 100'000'000'000;
  booted_at_ = time;
  origin_ = milliseconds(1 + random.below(random.below(2) == 0 ? moment_ms : years_ms));
  rate_ppm_ = random.between(-rate_ppm_max, rate_ppm_max);
  jump(random);
}

void MemberClock::jump(inputs::Random& random) {
  constexpr std::int64_t now_s = 1'800'000'000, year_s = 31'556'952;
  switch (random.below(4)) {
    case 0:
      day_s_.reset();
      break;
    case 1:
      day_s_ = 0;
      break;
    default:
      day_s_ = now_s + random.between(-10, 10) * year_s + random.between(-100, 100);
  }
}

port::Instant MemberClock::at(port::Instant time) const {
  const port::Duration passed = time - booted_at_;
  return port::Instant{} + origin_ + passed + passed / 1'000'000 * rate_ppm_;
}

std::string MemberClock::time_of_day(port::Instant time) const {
  if (!day_s_) return "";
  const std::time_t seconds_then =
      static_cast<std::time_t>(*day_s_ + (time - booted_at_) / seconds(1));
  std::tm parts{};
  gmtime_r(&seconds_then, &parts);
  std::array<char, 32> text{};
  const std::size_t size = std::strftime(text.data(), text.size(), "%Y-%m-%dT%H:%M:%SZ", &parts);
  return {text.data(), size};
}

}  // namespace etcm::test

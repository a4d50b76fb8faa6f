// How many instructions pass, by the system timer of a machine whose clock follows them: QEMU with
// -icount shift=0 takes a nanosecond for each, and a tick is one of the board's clock, 25 MHz.
#pragma once

#include <cstdint>

namespace etcm::test {

class InstructionClock {
 public:
  void start() noexcept {
    reload() = timer_bits;
    current() = 0;
    control() = enabled | of_the_processor;
    last_ = timer_bits;
    ticks_ = 0;
    longest_ = 0;
  }
  // For a hook that is called meanwhile. Between two of these, start and stop included, there are
  // less than 671 million instructions.
  void look() noexcept {
    const std::uint32_t now = current();
    const std::uint32_t passed = (last_ - now) & timer_bits;
    if (passed > longest_) longest_ = passed;
    ticks_ += passed;
    last_ = now;
  }
  void stop() noexcept {
    look();
    control() = 0;
  }
  std::uint64_t instructions() const noexcept { return ticks_ * tick; }
  // The most between two looks, start and stop included.
  std::uint64_t longest() const noexcept { return longest_ * tick; }

 private:
  static constexpr std::uint64_t tick = 40;
  static constexpr std::uint32_t timer_bits = 0x00ffffff;
  static constexpr std::uint32_t enabled = 1, of_the_processor = 4;

  static volatile std::uint32_t& at(std::uintptr_t address) noexcept {
    return *reinterpret_cast<volatile std::uint32_t*>(address);
  }
  static volatile std::uint32_t& control() noexcept { return at(0xE000E010); }
  static volatile std::uint32_t& reload() noexcept { return at(0xE000E014); }
  static volatile std::uint32_t& current() noexcept { return at(0xE000E018); }

  std::uint32_t last_ = 0;
  std::uint64_t longest_ = 0;
  std::uint64_t ticks_ = 0;
};

}  // namespace etcm::test

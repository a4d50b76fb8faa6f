// The registers that one sweep of a device found.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

namespace etcm::firmware {

// Neighbouring registers, by the address on the wire.
struct RegisterSpan {
  std::uint16_t first = 0;
  std::uint16_t count = 0;

  constexpr unsigned end() const { return unsigned{first} + count; }
  friend constexpr bool operator==(const RegisterSpan&, const RegisterSpan&) = default;
};

class Sweep {
 public:
  // `registers` are those of the blocks, one block after the other. Both must outlive this.
  Sweep(std::span<const RegisterSpan> blocks, std::span<const std::uint16_t> registers)
      : blocks_(blocks), registers_(registers) {}

  // Empty where no block has them all.
  std::span<const std::uint16_t> at(RegisterSpan span) const {
    std::size_t before = 0;
    for (const RegisterSpan block : blocks_) {
      if (span.first >= block.first && span.end() <= block.end()) {
        return registers_.subspan(before + span.first - block.first, span.count);
      }
      before += block.count;
    }
    return {};
  }

 private:
  std::span<const RegisterSpan> blocks_;
  std::span<const std::uint16_t> registers_;
};

}  // namespace etcm::firmware

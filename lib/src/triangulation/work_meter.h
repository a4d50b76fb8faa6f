// The work of one call that changes the mesh, against its limit.
//
// What has been changed may have to be taken back, and that takes work too: room for it is kept
// from the time of the change on. So a call that is refused stays within its limit, going back
// included; and what a call needs is the most that it has done and kept together.
#pragma once

#include <cstdint>

#include "etcm/work.h"

namespace etcm::internal {

// For walks without a limit.
inline constexpr std::uint32_t any_steps = 0xffff'ffffu;

// Counting is out of line: it is called from many places, and 64 bits are long on small machines.
class WorkMeter {
 public:
  void start(Work limit) noexcept;
  // The same of a call that does not go back, but clears the mesh.
  void start_anew(Work limit) noexcept;
  // From here on what has been changed is taken back, whatever the limit.
  void go_back() noexcept;

  // What was changed has been taken back, and the call goes on.
  void go_on(Work limit) noexcept {
    limit_ = limit.units;
    is_going_back_ = false;
    settle();
  }

  // How many steps a walk that changes nothing may take.
  [[nodiscard]] std::uint32_t left() const noexcept;
  // Whether so much more may be done. Where not, the call is over but for going back; has_room()
  // only asks.
  [[nodiscard]] bool fits(std::uint64_t units) noexcept;
  [[nodiscard]] bool has_room(std::uint64_t units) const noexcept {
    return done_ + kept_ + units <= limit_;
  }
  // Takes note of a walk: of at most left() steps, or of more, and then it was given up.
  [[nodiscard]] bool spend(std::uint32_t units) noexcept;
  // The same, and room for going the same way so many times when the change is taken back.
  [[nodiscard]] bool spend(std::uint32_t units, std::uint32_t times_back) noexcept;
  // The same of what is to be done, all or nothing.
  [[nodiscard]] bool spend_whole(std::uint64_t units) noexcept;
  // Of what is done anyway.
  void add(std::uint64_t units) noexcept;
  // For going back.
  void keep(std::uint64_t units) noexcept;
  [[nodiscard]] std::uint64_t to_keep(std::uint64_t units) const noexcept { return units & keeps_; }
  // What has been changed stays.
  void settle() noexcept { kept_ = slack; }
  [[nodiscard]] bool is_over() const noexcept { return is_over_; }

  // See Mesh::work_done().
  [[nodiscard]] Work result() const noexcept {
    return {is_going_back_ || is_over_ || peak_ < done_ ? done_ : peak_};
  }

 private:
  // For what is added to what has been done before it is asked for.
  static constexpr std::uint64_t slack = 24;

  std::uint64_t limit_ = Work::unlimited().units;
  std::uint64_t done_ = 0;
  std::uint64_t kept_ = 0;
  std::uint64_t peak_ = 0;
  std::uint64_t keeps_ = ~std::uint64_t{0};
  bool is_over_ = false;
  bool is_going_back_ = false;
};

}  // namespace etcm::internal

// The work of one call that changes the mesh, against its limit.
//
// What has been changed may have to be taken back, and that takes work too: room for it is kept
// from the time of the change on. So a call that is refused stays within its limit, going back
// included; and what a call needs is the most that it has done and kept together.
#pragma once

#include <cstddef>
#include <cstdint>

#include "etcm/work.h"

namespace etcm::internal {

// Wide enough for what a machine's memory holds, and one register.
using Units = std::size_t;

// For walks without a limit.
inline constexpr std::uint32_t any_steps = 0xffff'ffffu;

// Counting is out of line: it is called from many places.
class WorkMeter {
 public:
  void start(Work limit) noexcept;
  // The same of a call that does not go back, but clears the mesh.
  void start_anew(Work limit) noexcept;
  // From here on what has been changed is taken back, whatever the limit.
  void go_back() noexcept;

  // What was changed has been taken back, and the call goes on.
  void go_on(Work limit) noexcept {
    limit_ = units_of(limit);
    is_going_back_ = false;
    settle();
  }

  // How many steps a walk that changes nothing may take.
  [[nodiscard]] std::uint32_t left() const noexcept;
  // Whether so much more may be done. Where not, the call is over but for going back; has_room()
  // only asks.
  [[nodiscard]] bool fits(Units units) noexcept;
  [[nodiscard]] bool has_room(Units units) const noexcept {
    const Units taken = done_ + kept_;
    return taken <= limit_ && units <= limit_ - taken;
  }
  // Takes note of a walk: of at most left() steps, or of more, and then it was given up.
  [[nodiscard]] bool spend(std::uint32_t units) noexcept;
  // The same, and room for going the same way so many times when the change is taken back.
  [[nodiscard]] bool spend(std::uint32_t units, std::uint32_t times_back) noexcept;
  // The same of what is to be done, all or nothing.
  [[nodiscard]] bool spend_whole(Units units) noexcept;
  // Of what is done anyway.
  void add(Units units) noexcept;
  // For going back.
  void keep(Units units) noexcept;
  [[nodiscard]] Units to_keep(Units units) const noexcept { return units & keeps_; }
  // What has been changed stays.
  void settle() noexcept { kept_ = slack; }
  [[nodiscard]] bool is_over() const noexcept { return is_over_; }

  // See Mesh::work_done().
  [[nodiscard]] Work result() const noexcept {
    return {is_going_back_ || is_over_ || peak_ < done_ ? done_ : peak_};
  }

 private:
  // A limit that is too much for the machine is none.
  static Units units_of(Work limit) noexcept {
    constexpr Units most = ~Units{0};
    return limit.units < most ? static_cast<Units>(limit.units) : most;
  }

  // For what is added to what has been done before it is asked for.
  static constexpr Units slack = 24;

  Units limit_ = units_of(Work::unlimited());
  Units done_ = 0;
  Units kept_ = 0;
  Units peak_ = 0;
  Units keeps_ = ~Units{0};
  bool is_over_ = false;
  bool is_going_back_ = false;
};

}  // namespace etcm::internal

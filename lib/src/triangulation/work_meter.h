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

class WorkMeter;

// How many steps a walk may take, and who is told while it goes on: nobody, where a mesh is only
// read.
struct Walk {
  std::uint32_t steps_most = any_steps;
  WorkMeter* meter = nullptr;
};

// It is counted in many places: a small machine has no room for it in each.
#ifdef __OPTIMIZE_SIZE__
#define ETCM_COUNTING [[gnu::noinline]]
#else
#define ETCM_COUNTING
#endif

class WorkMeter {
 public:
  // The hook must outlive the call.
  void start(Work limit, const KeepAlive& keep_alive) noexcept;
  // The same of a call that does not go back, but clears the mesh.
  void start_anew(Work limit, const KeepAlive& keep_alive) noexcept;
  // From here on what has been changed is taken back, whatever the limit.
  void go_back() noexcept;

  // What was changed has been taken back, and the call goes on.
  void go_on(Work limit) noexcept {
    limit_ = units_of(limit);
    is_going_back_ = false;
    settle();
  }

  // How many steps a walk that changes nothing may take.
  [[nodiscard]] ETCM_COUNTING std::uint32_t left() const noexcept {
    if (limit_ <= taken_) return 0;
    const Units units = limit_ - taken_;
    return units < any_steps ? static_cast<std::uint32_t>(units) : any_steps - 1;
  }
  // The same, for the walk.
  [[nodiscard]] Walk walk() noexcept { return {left(), this}; }
  // Of one that is taken whatever the limit.
  [[nodiscard]] Walk whole_walk() noexcept { return {any_steps, this}; }
  // Whether so much more may be done. Where not, the call is over but for going back; has_room()
  // only asks.
  [[nodiscard]] ETCM_COUNTING bool fits(Units units) noexcept {
    // What is done while going back is in the room that was kept.
    if (!is_going_back_ && taken_ + units > peak_) peak_ = taken_ + units;
    if (has_room(units)) return true;
    is_over_ = true;
    return false;
  }
  [[nodiscard]] bool has_room(Units units) const noexcept {
    return taken_ <= limit_ && units <= limit_ - taken_;
  }
  // Takes note of a walk: of at most left() steps, or of more, and then it was given up.
  [[nodiscard]] ETCM_COUNTING bool spend(std::uint32_t units) noexcept {
    const bool is_whole = fits(units);
    taken_ += is_whole ? units : left();
    look();
    return is_whole;
  }
  // The same of what is to be done, all or nothing.
  [[nodiscard]] ETCM_COUNTING bool spend_whole(Units units) noexcept {
    const bool is_whole = fits(units);
    if (is_whole) taken_ += units;
    look();
    return is_whole;
  }
  // Of what is done anyway.
  ETCM_COUNTING void add(Units units) noexcept {
    taken_ += units;
    look();
  }
  // Takes note of what is done, and is not counted, or has been before or will be after it.
  ETCM_COUNTING void pass(Units units) noexcept {
    next_beat_ -= units < next_beat_ ? units : next_beat_;
    look();
  }
  // The same of a long list, an entry of which has this index.
  ETCM_COUNTING void pass_entry(std::size_t index) noexcept {
    if (index % entries_between == 0) pass(2 * entries_between);
  }
  // For going back.
  ETCM_COUNTING void keep(Units units) noexcept {
    kept_ += to_keep(units);
    taken_ += to_keep(units);
  }
  // The same, before what may have to be taken back is done. False: it must not be.
  [[nodiscard]] bool may_keep(Units units) noexcept {
    keep(units);
    return fits(0);
  }
  [[nodiscard]] Units to_keep(Units units) const noexcept { return keeps_ ? units : 0; }
  [[nodiscard]] bool keeps() const noexcept { return keeps_; }
  // What has been changed stays.
  void settle() noexcept {
    // The units that are no longer kept will pass once more.
    next_beat_ -= kept_ - slack < next_beat_ ? kept_ - slack : next_beat_;
    taken_ = done() + slack;
    kept_ = slack;
  }
  [[nodiscard]] bool is_over() const noexcept { return is_over_; }
  [[nodiscard]] bool is_going_back() const noexcept { return is_going_back_; }

  // While somebody else's function runs, nobody may change the mesh.
  template <class Function>
  auto call_out(Function function) noexcept {
    const Out out(calls_out_);
    return function();
  }
  [[nodiscard]] bool is_calling_out() const noexcept { return calls_out_ != 0; }

  // From here on used() and needed() are these.
  void tell(Work used, Work needed) noexcept {
    *this = WorkMeter{};
    taken_ = units_of(used);
    peak_ = units_of(needed);
  }
  // See Mesh::work_used() and Mesh::work_needed().
  [[nodiscard]] Work used() const noexcept { return {done()}; }
  [[nodiscard]] Work needed() const noexcept {
    return {is_going_back_ || is_over_ || peak_ < done() ? done() : peak_};
  }

 private:
  struct Out {
    explicit Out(std::uint8_t& c) noexcept : calls(c) { ++calls; }
    Out(const Out&) = delete;
    Out& operator=(const Out&) = delete;
    ~Out() { --calls; }
    std::uint8_t& calls;
  };

  void look() noexcept {
    if (taken_ >= next_beat_) [[unlikely]]
      beat();
  }
  void beat() noexcept;

  Units done() const noexcept { return taken_ - kept_; }
  // A limit that is too much for the machine is none.
  static Units units_of(Work limit) noexcept {
    constexpr Units most = ~Units{0};
    return limit.units < most ? static_cast<Units>(limit.units) : most;
  }

  // For what is added to what has been done before it is asked for.
  static constexpr Units slack = 24;
  static constexpr std::size_t entries_between = 32;

  Units limit_ = units_of(Work::unlimited());
  Units taken_ = 0;  // what has been done, and what is kept
  Units kept_ = 0;
  Units peak_ = 0;
  Units next_beat_ = ~Units{0};  // the units taken at which the hook is due
  const KeepAlive* keep_alive_ = nullptr;
  std::uint8_t calls_out_ = 0;
  bool keeps_ = true;
  bool is_over_ = false;
  bool is_going_back_ = false;
};

#undef ETCM_COUNTING

// The steps of a walk as it goes on. They are counted when it has ended; only the hook is due
// before.
class WalkBound {
 public:
  static constexpr std::uint32_t steps_between = 64;
  // A step may take as long as two units: three signs, and wide integers that settle them.
  static constexpr std::uint32_t units_between = 2 * steps_between;

  explicit WalkBound(const Walk& walk, std::uint32_t most = any_steps) noexcept
      : most_(walk.steps_most < most ? walk.steps_most : most),
        pause_(walk.meter != nullptr && steps_between < most_ ? steps_between : most_),
        meter_(walk.meter) {}
  // One comparison, but for every so many.
  [[nodiscard]] bool is_passed(std::uint32_t steps) noexcept {
    return steps > pause_ && !goes_on();
  }

 private:
  bool goes_on() noexcept;

  std::uint32_t most_;
  std::uint32_t pause_;
  WorkMeter* meter_;
};

}  // namespace etcm::internal

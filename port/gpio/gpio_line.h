// One requested line, by whichever libgpiod there is: gpio_line_v1.cpp is for 1.6, gpio_line_v2.cpp
// for 2.1 and later, whose calls have nothing in common.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>

namespace etcm::port {

enum class LineUse : std::uint8_t { input, output };

struct LineRequest {
  // The line's name as the board's maker gave it, or CHIP:OFFSET. Chips are renumbered from boot to
  // boot, names are not.
  std::string name;
  LineUse use = LineUse::input;
  bool is_active_low = false;
};

class GpioLine {
 public:
  // An output starts inactive. Throws std::runtime_error: which line, why, and the cure.
  explicit GpioLine(const LineRequest& request);
  // An output is inactive once more before it is given back.
  ~GpioLine();
  GpioLine(const GpioLine&) = delete;
  GpioLine& operator=(const GpioLine&) = delete;

  // Where the line has gone with its chip nothing, and false, and errno tells.
  std::optional<bool> is_active() const;
  bool set_active(bool active);

  // Of an input: readable when the level has changed.
  int descriptor() const;
  // Takes what is to be read there; what it says is not asked, the level is. False where the line
  // has gone with its chip, and errno tells: from then on the descriptor is ready all the time, and
  // the line inactive.
  bool discard_events();

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace etcm::port

// A bus with one question at a time under way, and the wait for its answer: for a tool that has
// nothing else to do meanwhile. The gateway's buses never wait, and ask what they decide; a person
// at a laptop asks any function of any unit.
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <stdexcept>
#include <string>

#include "etcm/port/clock.h"
#include "etcm/port/endpoint.h"
#include "etcm/port/serial_line.h"
#include "posix/event_loop.h"
#include "posix/steady_clock.h"
#include "posix/stop_signal.h"

namespace etcm::bus {

// The port or the connection cannot be had, or went away. what() is one line, with the cure.
class LinkError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

// The user wants it to end: SIGINT or SIGTERM came while it waited.
class Interrupted {};

enum class Outcome : std::uint8_t {
  answer,
  silence,  // nothing came in time
  garbled,  // something came, but no whole answer of this unit to this function
};

struct Reply {
  Outcome outcome = Outcome::silence;
  std::span<const std::uint8_t> pdu;  // with Outcome::answer; valid until the next question
  port::Duration took{};              // from the end of the question to the end of the answer
};

class Link {
 public:
  virtual ~Link() = default;

  // Whether it can be asked at once: on a line whose answers carry no number, what is answered like
  // a question that was waited for in vain is not asked before that answer can come no more.
  virtual bool may_ask(std::uint8_t, std::span<const std::uint8_t>) const { return true; }

  // Asks the unit, as soon as it may, and waits, for the answer to begin within `timeout`. Throws
  // LinkError, Interrupted.
  virtual Reply ask(std::uint8_t unit, std::span<const std::uint8_t> request,
                    port::Duration timeout) = 0;

  // Where it leads, for messages: "/dev/ttyUSB0 at 19200 baud, even parity".
  virtual const std::string& name() const = 0;

  // What to check when no unit answers at all.
  virtual const char* advice() const = 0;

  // Waits without asking. Throws Interrupted.
  virtual void pause(port::Duration duration) = 0;
};

// Whether frames are shown as they go and come, on the standard error: sent "[03][04]", heard
// "<03><04>", as mbpoll shows them.
enum class Frames : std::uint8_t { hidden, shown };

std::unique_ptr<Link> open_serial_link(const port::SerialLine& line, Frames frames);

// Looks a name up and connects.
std::unique_ptr<Link> open_tcp_link(const port::Endpoint& end, Frames frames);

// What both links show them with.
class FrameDisplay {
 public:
  explicit FrameDisplay(Frames frames) : is_shown_(frames == Frames::shown) {}
  void sent(std::span<const std::uint8_t> frame) const { show(frame, '[', ']'); }
  void heard(std::span<const std::uint8_t> bytes) const { show(bytes, '<', '>'); }

 private:
  void show(std::span<const std::uint8_t> bytes, char before, char behind) const;

  bool is_shown_;
};

// What both links wait with.
class Waiter {
 public:
  port::EventLoop& loop() { return loop_; }
  port::Instant now() const { return clock_.now(); }

  // Lets events happen, at most until then. Throws Interrupted.
  void wait_until(port::Instant end);

 private:
  port::EventLoop loop_;
  port::StopSignal stop_{loop_};
  port::SteadyClock clock_;
};

}  // namespace etcm::bus

// A thread for what may wait for a disk, so that the event loop does not: one job, run each time it
// is started, one run at a time.
#pragma once

#include <functional>
#include <memory>

#include "etcm/port/clock.h"

namespace etcm::port {

class Worker {
 public:
  // `name` shows in ps and top; at most 15 characters. The job must own what it uses: a run that
  // hangs is left behind when the worker goes. It must not throw.
  Worker(const char* name, std::function<void()> job);
  // What the job owns goes with it, but for a run under way, which is not waited for: wait() first.
  ~Worker();
  Worker(const Worker&) = delete;
  Worker& operator=(const Worker&) = delete;

  // REQUIRES: not busy. What was written before it is seen by the job, and what the job wrote is
  // seen once it is no longer busy.
  void start();
  bool is_busy() const;

  // Waits until it is not busy; false when that takes longer than `at_most`.
  bool wait(Duration at_most);

 private:
  struct Shared;
  std::shared_ptr<Shared> shared_;
};

}  // namespace etcm::port

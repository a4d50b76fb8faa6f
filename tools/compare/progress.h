// How far a long run is, on a terminal: one line that is written over.
#pragma once

#include <string>

#include "compare/systems/stopwatch.h"

namespace etcm::compare {

// Silent where the standard error is no terminal.
class Progress {
 public:
  Progress();
  ~Progress();
  Progress(const Progress&) = delete;
  Progress& operator=(const Progress&) = delete;

  // `done` in [0, 1].
  void show(double done, const std::string& what);

 private:
  bool is_shown_;
  WallStopwatch watch_;
  double seconds_ = 0;
};

}  // namespace etcm::compare

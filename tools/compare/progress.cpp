#include "compare/progress.h"

#include <unistd.h>

#include <cstdio>

namespace etcm::compare {

Progress::Progress() : is_shown_(isatty(STDERR_FILENO) != 0) {}

Progress::~Progress() {
  if (is_shown_) std::fputs("\r\033[K", stderr);
}

void Progress::show(double done, const std::string& what) {
  if (!is_shown_) return;
  constexpr int width = 30;
  seconds_ += watch_.lap_us() / 1e6;
  const int filled = static_cast<int>(done * width);
  const std::string bar = std::string(static_cast<std::size_t>(filled), '#') +
                          std::string(static_cast<std::size_t>(width - filled), '.');
  std::fprintf(stderr, "\r\033[K[%s] %3.0f %%  %s", bar.c_str(), 100 * done, what.c_str());
  if (done > 0.02) std::fprintf(stderr, "  %.0f s left", seconds_ * (1 - done) / done);
  std::fflush(stderr);
}

}  // namespace etcm::compare

#include "compare/report/figures.h"

#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <vector>

#include "etcm/files/error.h"

namespace etcm::compare {
namespace {

// Runs a program and waits; `cure` is for who does not have it.
void run(std::vector<std::string> words, const std::string& cure) {
  std::vector<char*> arguments;
  for (std::string& word : words) arguments.push_back(word.data());
  arguments.push_back(nullptr);
  pid_t child = 0;
  if (posix_spawnp(&child, arguments[0], nullptr, nullptr, arguments.data(), environ) != 0) {
    throw files::OutputError(words[0] + ": cannot be run; " + cure);
  }
  int state = 0;
  waitpid(child, &state, 0);
  if (!WIFEXITED(state) || WEXITSTATUS(state) != 0) {
    throw files::OutputError(words[0] + ": failed on " + words.back() + "; " + cure);
  }
}

}  // namespace

void draw_figures(const std::string& folder) {
  run({"gnuplot", "-c", ETCM_FIGURES_SCRIPT, folder},
      "apt-get install gnuplot-nox, or leave the figures out with --no-figures");
  for (char number = '1'; number <= '6'; ++number) {
    const std::string base = folder + "/figure-" + number;
    run({"rsvg-convert", "--output", base + ".png", base + ".svg"},
        "apt-get install librsvg2-bin, or leave the figures out with --no-figures");
  }
}

}  // namespace etcm::compare

// Runs the program as a user does.
#pragma once

#include <sys/wait.h>

#include <cstdlib>
#include <string>

#include "support/scratch_folder.h"

namespace etcm::cli {

struct Outcome {
  int code = -1;  // -1: ended by a signal
  std::string output;
  std::string errors;
};

// Through the shell, so that a test can redirect and limit as a user would.
inline Outcome run(const std::string& arguments, const std::string& before = "") {
  static const test::ScratchFolder streams;
  const std::string command = before + " " + ETCM_PROGRAM + " " + arguments;
  const std::string redirected =
      "{ " + command + "; } >" + streams.path("out") + " 2>" + streams.path("err");
  const int status = std::system(redirected.c_str());
  Outcome outcome;
  if (WIFEXITED(status)) outcome.code = WEXITSTATUS(status);
  outcome.output = streams.read("out");
  outcome.errors = streams.read("err");
  return outcome;
}

}  // namespace etcm::cli

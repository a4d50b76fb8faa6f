// etcm-compare as a user runs it.
#include <gmock/gmock.h>
#include <sys/wait.h>

#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <string>

#include "support/scratch_folder.h"

namespace etcm {
namespace {

using testing::HasSubstr;

struct Outcome {
  int status;
  std::string output;
};

Outcome run(const std::string& arguments) {
  Outcome outcome{-1, {}};
  FILE* pipe = popen((std::string(ETCM_COMPARE) + " " + arguments + " 2>&1").c_str(), "r");
  if (pipe == nullptr) return outcome;
  for (int c = std::fgetc(pipe); c != EOF; c = std::fgetc(pipe)) {
    outcome.output += static_cast<char>(c);
  }
  const int state = pclose(pipe);
  outcome.status = WIFEXITED(state) ? WEXITSTATUS(state) : -1;
  return outcome;
}

TEST(CompareProgram, GeneratesTheSameGraphEveryTime) {
  const Outcome first = run("generate --nodes 60 --seed 1");
  EXPECT_EQ(first.status, 0);
  EXPECT_THAT(first.output, HasSubstr("random-60-long-1"));
  EXPECT_EQ(run("generate --nodes 60 --seed 1").output, first.output);
  EXPECT_NE(run("generate --nodes 60 --seed 2").output, first.output);
  EXPECT_NE(run("generate --nodes 60 --seed 1 --features short").output, first.output);
}

TEST(CompareProgram, ComparesOnAFileOfTheUsers) {
  const test::ScratchFolder folder;
  const std::string poly = folder.path("graph.poly");
  ASSERT_EQ(run("generate --nodes 80 -o " + poly).status, 0);
  const Outcome all = run(poly);
  EXPECT_EQ(all.status, 0) << all.output;
  EXPECT_THAT(all.output, HasSubstr("80 nodes, 12 features"));
  EXPECT_THAT(all.output, HasSubstr("| Sapidis-Perucchio | ok |"));
  const Outcome two = run(poly + " --systems tsai,default");
  EXPECT_THAT(two.output, HasSubstr("| ours | ok |"));
  EXPECT_THAT(two.output, testing::Not(HasSubstr("Sapidis")));
}

TEST(CompareProgram, SaysWhatIsWrong) {
  const test::ScratchFolder folder;
  const std::string crossed = folder.write(
      "crossed.poly", "4 2 0 0\n1 0 0\n2 10 10\n3 10 0\n4 0 10\n2 0\n1 1 2\n2 3 4\n0\n");
  const Outcome outcome = run(crossed);
  EXPECT_EQ(outcome.status, 2);
  EXPECT_THAT(outcome.output, HasSubstr("crossed.poly"));
  EXPECT_THAT(outcome.output, HasSubstr("cross"));
  EXPECT_THAT(run(crossed + " --systems nobody").output, HasSubstr("no system 'nobody'"));
  EXPECT_EQ(run("").status, 2);
}

TEST(CompareProgram, RunsTheExperimentIntoAFolder) {
  const test::ScratchFolder folder;
  const Outcome outcome =
      run("experiment --sizes 60 100 150 --seeds 1 --no-figures --out " + folder.path("out"));
  EXPECT_EQ(outcome.status, 0) << outcome.output;
  for (const char* name : {"runs.csv", "summary.csv", "tables.md", "figure-1.svg"}) {
    EXPECT_FALSE(folder.read(std::string("out/") + name).empty()) << name;
  }
}

TEST(CompareProgram, DrawsTheFigures) {
  if (std::system("gnuplot --version >/dev/null 2>&1 && rsvg-convert --version >/dev/null 2>&1") !=
      0) {
    GTEST_SKIP() << "gnuplot or rsvg-convert is not installed";
  }
  const test::ScratchFolder folder;
  const Outcome outcome =
      run("experiment --sizes 60 100 150 --seeds 2 --out " + folder.path("out"));
  EXPECT_EQ(outcome.status, 0) << outcome.output;
  for (char number = '1'; number <= '6'; ++number) {
    const std::string base = std::string("out/figure-") + number;
    EXPECT_THAT(folder.read(base + ".svg"), HasSubstr("</svg>"));
    EXPECT_THAT(folder.read(base + ".png"), testing::StartsWith("\x89PNG"));
  }
}

}  // namespace
}  // namespace etcm

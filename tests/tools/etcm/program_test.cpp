// The program as a user runs it.
#include <fcntl.h>
#include <gmock/gmock.h>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <functional>
#include <string>
#include <vector>

#include "program_run.h"
#include "support/scratch_folder.h"

namespace etcm::cli {
namespace {

using test::ScratchFolder;
using ::testing::AllOf;
using ::testing::HasSubstr;

const char* const crossed = "4 2 0 0\n1 0 0\n2 10 10\n3 10 0\n4 0 10\n2 0\n1 1 2\n2 3 4\n0\n";
const char* const small_plate =
    "6 2 0 0\n1 0 0\n2 100 0\n3 100 60\n4 0 60\n5 10 20\n6 90 22\n5 0\n1 1 2\n2 2 3\n3 3 4\n4 4 1\n"
    "5 5 6\n0\n";
// A long feature between two rows of nodes: it needs Steiner vertices.
std::string comb() {
  std::string text = "22 2 0 0\n1 0 0\n2 1000 0\n";
  for (int i = 0; i < 20; ++i) {
    text += std::to_string(i + 3) + " " + std::to_string(50 + (i / 2) * 100) + " " +
            (i % 2 == 0 ? "9" : "-9") + "\n";
  }
  return text + "1 0\n1 1 2\n0\n";
}

TEST(Program, AnalysesWhatRadiosReachAndNodesSee) {
  ScratchFolder folder;
  folder.write("field.poly",
               "4 2 0 0\n1 0 0\n2 100 0\n3 100 100\n4 0 100\n"
               "4 0\n1 1 2\n2 2 3\n3 3 4\n4 4 1\n0\n");
  const std::string field = folder.path("field.poly");
  Outcome outcome = run("analyse " + field + " --radio-range 60 --sensing-range 45 -o " +
                        folder.path("field.svg"));
  EXPECT_EQ(outcome.code, 0) << outcome.errors;
  EXPECT_THAT(outcome.output,
              AllOf(HasSubstr("4 separate networks; it takes 100 to keep the nodes in one\n"),
                    HasSubstr("5 links between neighbours are longer\n4 relays"),
                    HasSubstr("5 holes, the widest 71 from the nearest node, at 50 50\n"),
                    HasSubstr("4 gaps along features, 4 not watched")));
  EXPECT_THAT(folder.read("field.svg"),
              AllOf(HasSubstr("clipPath"), HasSubstr(">relay<"), HasSubstr(">hole<")));
  outcome = run("analyse " + field + " --sensing-range 71 --json");
  EXPECT_EQ(outcome.output,
            "{\"sensing_range\":71,\"holes\":0,\"gaps\":0,\"hole_list\":[],\"gap_list\":[]}\n");
  outcome = run("analyse " + field + " --sensing-range 50 --json");
  EXPECT_THAT(outcome.output, HasSubstr("{\"place\":[50,50],\"distance\":71,\"on_boundary\":"
                                        "false}"));
  outcome = run("analyse " + field);
  EXPECT_EQ(outcome.code, 2);
  EXPECT_THAT(outcome.errors, HasSubstr("give --radio-range, --sensing-range or both"));
  EXPECT_EQ(run("analyse " + field + " --sensing-range 0").code, 2);
  EXPECT_EQ(run("analyse " + field + " --sensing-range 9 -o " + folder.path("no/such/a.svg")).code,
            1);
}

TEST(Program, MeshesAndVerifiesRealData) {
  const ScratchFolder folder;
  for (const char* name : {"norway_small", "norway"}) {
    for (const char* policy : {"default", "paper"}) {
      const std::string input = std::string(ETCM_DATA) + "/" + name + ".poly";
      const std::string base = folder.path(name);
      const Outcome mesh = run("mesh " + input + " -o " + base + " --json --policy " + policy);
      EXPECT_EQ(mesh.code, 0) << mesh.errors;
      EXPECT_THAT(mesh.output,
                  AllOf(HasSubstr("\"unresolved\":0,\"dt_us\":"), HasSubstr(",\"conform_us\":"),
                        HasSubstr(std::string("\"policy\":\"") + policy + "\"}\n")));
      const Outcome verify = run("verify " + input + " " + base);
      EXPECT_EQ(verify.code, 0) << verify.errors;
    }
  }
}

TEST(Program, WritesTheSameBytesEveryTime) {
  const ScratchFolder folder;
  const std::string input = folder.write("comb.poly", comb());
  ASSERT_EQ(run("mesh " + input + " -o " + folder.path("a")).code, 0);
  ASSERT_EQ(run("mesh " + input + " -o " + folder.path("b")).code, 0);
  for (const char* extension : {".node", ".ele", ".edge", ".poly"}) {
    EXPECT_EQ(folder.read(std::string("a") + extension), folder.read(std::string("b") + extension));
    EXPECT_NE(folder.read(std::string("a") + extension), "");
  }
}

struct Refused {
  const char* name;
  const char* poly;
  const char* message;
};
void PrintTo(const Refused& row, std::ostream* out) { *out << row.name; }
class ProgramRefusal : public ::testing::TestWithParam<Refused> {};

TEST_P(ProgramRefusal, IsOneLineAndLeavesNothing) {
  const ScratchFolder folder;
  const std::string input = folder.write("in.poly", GetParam().poly);
  const Outcome outcome = run("mesh " + input + " -o " + folder.path("out"));
  EXPECT_EQ(outcome.code, 2);
  EXPECT_EQ(outcome.output, "");
  EXPECT_EQ(outcome.errors.find('\n'), outcome.errors.size() - 1) << outcome.errors;
  EXPECT_THAT(outcome.errors, HasSubstr("etcm: " + input + GetParam().message));
  EXPECT_EQ(folder.file_count(), 1u);
}

INSTANTIATE_TEST_SUITE_P(
    InputErrors, ProgramRefusal,
    ::testing::Values(
        Refused{"Crossing", crossed, ":8: feature 2 (3-4) crosses feature 1 (1-2) (line 7)"},
        Refused{"Overlap", "4 2\n1 0 0\n2 10 0\n3 5 0\n4 20 0\n2 0\n1 1 2\n2 3 4\n0\n",
                ":8: feature 2 (3-4) runs along a part of feature 1 (1-2) (line 7)"},
        Refused{"Repeated", "2 2\n1 0 0\n2 9 9\n2 0\n1 1 2\n2 2 1\n0\n",
                ":6: feature 2 (2-1) repeats feature 1 (1-2) (line 5)"},
        Refused{"NoLength", "2 2\n1 0 0\n2 9 9\n1 0\n1 2 2\n0\n",
                ":5: feature 1 (2-2) has no length"},
        Refused{"Duplicate", "3 2\n1 0 0\n2 9 9\n3 0 0\n0\n0\n",
                ":4: node 3 stands at 0 0, where node 1 (line 2) is"},
        Refused{"Fraction", "1 2\n1 0.5 0\n0\n0\n", ":2: x 0.5 is no integer; use --scale"},
        Refused{"Garbage", "hello\n", ":1: the number of nodes 'hello'"}),
    [](const auto& row) { return row.param.name; });

TEST(Program, RefusesAWrongCommandLine) {
  const ScratchFolder folder;
  const std::string input = folder.write("in.poly", small_plate);
  const std::string mesh = "mesh " + input + " -o " + folder.path("out");
  const std::vector<std::string> table = {"",
                                          "frobnicate",
                                          "mesh " + input,
                                          mesh + " --policy best",
                                          mesh + " --scale 0",
                                          mesh + " --scale -2",
                                          mesh + " --scale ten",
                                          mesh + " --domain sea",
                                          mesh + " more",
                                          "mesh " + input + " -o " + folder.path("in"),
                                          "mesh " + input + " -o " + folder.path(""),
                                          "mesh missing.poly -o x",
                                          "export " + folder.path("out"),
                                          "verify " + input + " " + folder.path("out"),
                                          "mesh " + folder.path("") + " -o x"};
  for (const std::string& arguments : table) {
    const Outcome outcome = run(arguments);
    EXPECT_EQ(outcome.code, 2) << arguments;
    EXPECT_EQ(outcome.errors.find('\n'), outcome.errors.size() - 1) << outcome.errors;
    EXPECT_EQ(folder.file_count(), 1u) << arguments;
    EXPECT_EQ(folder.read("in.poly"), small_plate);
  }
  EXPECT_NE(run("frobnicate").errors.find("frobnicate"), std::string::npos);
  EXPECT_EQ(run("--help").code, 0);
  EXPECT_EQ(run("mesh --help").code, 0);
}

TEST(Program, ScalesExactlyAndSaysSo) {
  const ScratchFolder folder;
  const std::string input = folder.write("in.poly", "3 2\n1 0.1 0\n2 0.3 0.2\n3 0 1.7\n0\n0\n");
  const std::string options = " --scale 10";
  ASSERT_EQ(run("mesh " + input + " -o " + folder.path("out") + options).code, 0);
  EXPECT_THAT(folder.read("out.node"), AllOf(HasSubstr("10 times"), HasSubstr("\n2 3 2 0\n")));
  EXPECT_EQ(run("verify " + input + " " + folder.path("out") + options).code, 0);
  EXPECT_EQ(run("verify " + input + " " + folder.path("out")).code, 2);
  EXPECT_EQ(run("verify " + input + " " + folder.path("out") + " --scale 100").code, 4);
  ASSERT_EQ(run("mesh " + input + " -o " + folder.path("r") + " --round").code, 2);  // duplicates
  ASSERT_EQ(run("mesh " + input + " -o " + folder.path("r") + " --scale 7 --round").code, 0);
}

TEST(Program, WritesTheMeshThatStandsWhenTheBudgetIsHit) {
  const ScratchFolder folder;
  const std::string input = folder.write("comb.poly", comb());
  const Outcome outcome =
      run("mesh " + input + " -o " + folder.path("out") + " --steiner-max 2 --json");
  EXPECT_EQ(outcome.code, 3);
  EXPECT_THAT(outcome.output, HasSubstr("\"steiner\":2,"));
  EXPECT_THAT(outcome.errors, HasSubstr("feature 1 (1-2) on line 25"));
  EXPECT_EQ(folder.file_count(), 6u);
  EXPECT_EQ(run("verify " + input + " " + folder.path("out")).code, 4);
  EXPECT_THAT(folder.read("out.svg"), HasSubstr("unresolved"));
}

std::string number_in(const std::string& json, const std::string& name) {
  const std::size_t at = json.find("\"" + name + "\":");
  return at == std::string::npos ? "none"
                                 : json.substr(at + name.size() + 3,
                                               json.find_first_of(",}", at) - at - name.size() - 3);
}

TEST(Program, LooksForFewerSteinerVerticesWithMoreEffort) {
  const ScratchFolder folder;
  const std::string input = std::string(ETCM_DATA) + "/norway.poly";
  const std::string base = folder.path("out");
  const Outcome plain = run("mesh " + input + " -o " + base + " --json");
  const Outcome little = run("mesh " + input + " -o " + base + " --json --effort 2");
  ASSERT_EQ(little.code, 0) << little.errors;
  const int built = std::stoi(number_in(plain.output, "steiner"));
  const int fewer = std::stoi(number_in(little.output, "steiner"));
  const int least = std::stoi(number_in(little.output, "least_steiner"));
  EXPECT_LT(fewer, built);
  EXPECT_LE(least, fewer);
  EXPECT_GT(least, built / 2);
  EXPECT_EQ(number_in(plain.output, "least_steiner"), std::to_string(least));

  const Outcome verified = run("verify " + input + " " + base + " --bound");
  EXPECT_EQ(verified.code, 0) << verified.errors;
  EXPECT_THAT(verified.output,
              HasSubstr(std::to_string(fewer) + " Steiner vertices (no mesh has fewer than " +
                        std::to_string(least) + ")"));
  // The same again: no clock decides.
  const Outcome again = run("mesh " + input + " -o " + folder.path("again") + " --json --effort 2");
  EXPECT_EQ(number_in(again.output, "mesh_hash"), number_in(little.output, "mesh_hash"));
}

TEST(Program, RefusesAnEffortThatThereIsNot) {
  const ScratchFolder folder;
  const std::string input = folder.write("in.poly", small_plate);
  for (const std::string effort : {"10", "-1", "much"}) {
    const Outcome outcome =
        run("mesh " + input + " -o " + folder.path("out") + " --effort " + effort);
    EXPECT_EQ(outcome.code, 2) << effort;
    EXPECT_THAT(outcome.errors, HasSubstr("--effort")) << effort;
  }
  EXPECT_EQ(run("mesh " + input + " -o " + folder.path("out") + " --effort 9").code, 0);
}

TEST(Program, SaysWhereNoMeshHasFewer) {
  const ScratchFolder folder;
  // A feature between two rows, alone.
  const std::string input = folder.write(
      "in.poly", "6 2\n1 0 0\n2 1000 0\n3 300 40\n4 300 -40\n5 700 45\n6 700 -45\n1 0\n1 1 2\n0\n");
  const Outcome outcome = run("mesh " + input + " -o " + folder.path("out"));
  EXPECT_EQ(outcome.code, 0) << outcome.errors;
  EXPECT_THAT(outcome.output, HasSubstr("(no mesh has fewer), "));
}

TEST(Program, ReplacesNoInputWithAPicture) {
  const ScratchFolder folder;
  const std::string input = folder.write("in.poly", small_plate);
  const std::string base = folder.path("out");
  ASSERT_EQ(run("mesh " + input + " -o " + base).code, 0);
  const std::string nodes = folder.read("out.node");
  for (const std::string& line : {"analyse " + input + " --radio-range 5 -o " + input,
                                  "export " + base + " --svg " + base + ".node",
                                  "export " + base + " --geojson " + base + ".poly",
                                  "export " + base + " --vtk " + folder.path("./out.ele")}) {
    const Outcome outcome = run(line);
    EXPECT_EQ(outcome.code, 2) << line;
    EXPECT_THAT(outcome.errors, HasSubstr("would replace the input")) << line;
  }
  EXPECT_EQ(folder.read("in.poly"), small_plate);
  EXPECT_EQ(folder.read("out.node"), nodes);
  const std::string both = folder.path("both");
  EXPECT_THAT(run("export " + base + " --svg " + both + " --vtk " + both).errors,
              HasSubstr("another format goes there too"));
}

TEST(Program, KeepsAPictureApartFromSentences) {
  const ScratchFolder folder;
  const std::string input = folder.write("in.poly", small_plate);
  const Outcome outcome = run("analyse " + input + " --radio-range 5 -o -");
  EXPECT_EQ(outcome.code, 0);
  EXPECT_THAT(outcome.output, testing::EndsWith("</svg>\n"));
  EXPECT_THAT(outcome.errors, HasSubstr("relays"));
  EXPECT_EQ(run("analyse " + input + " --radio-range 5 --json -o -").code, 2);
}

TEST(Program, NamesTheViolation) {
  const ScratchFolder folder;
  const std::string input = folder.write("in.poly", small_plate);
  const std::string base = folder.path("out");
  ASSERT_EQ(run("mesh " + input + " -o " + base).code, 0);
  std::string nodes = folder.read("out.node");
  nodes.replace(nodes.find("\n3 100 60"), 9, "\n3 100 61");
  folder.write("out.node", nodes);
  const Outcome outcome = run("verify " + input + " " + base);
  EXPECT_EQ(outcome.code, 4);
  EXPECT_THAT(outcome.errors, HasSubstr("vertex 3 stands at 100 61, but the input node at 100 60"));
}

TEST(Program, LeavesNoHalfWrittenFile) {
  const ScratchFolder folder;
  const std::string input = std::string(ETCM_DATA) + "/norway_small.poly";
  const std::string base = folder.path("out");
  const Outcome full = run("mesh " + input + " -o " + base, "ulimit -f 20;");
  EXPECT_EQ(full.code, 1);
  EXPECT_THAT(full.errors, HasSubstr("cannot be written"));
  EXPECT_EQ(folder.file_count(), 0u);
  EXPECT_EQ(run("mesh " + input + " -o " + folder.path("none/out")).code, 1);
  EXPECT_EQ(run("mesh " + input + " -o /proc/out").code, 1);
  EXPECT_EQ(folder.file_count(), 0u);
}

TEST(Program, SurvivesAReaderThatLeaves) {
  const ScratchFolder folder;
  const std::string input = folder.write("in.poly", small_plate);
  // The pipe's reader is gone before the program starts.
  std::array<int, 2> ends{};
  ASSERT_EQ(::pipe(ends.data()), 0);
  ::close(ends[0]);
  const pid_t child = ::fork();
  ASSERT_GE(child, 0);
  if (child == 0) {
    ::dup2(ends[1], STDOUT_FILENO);
    const std::string base = folder.path("piped");
    ::execl(ETCM_PROGRAM, "etcm", "mesh", input.c_str(), "-o", base.c_str(), "--json", nullptr);
    ::_exit(127);
  }
  ::close(ends[1]);
  int status = 0;
  ASSERT_EQ(::waitpid(child, &status, 0), child);
  ASSERT_TRUE(WIFEXITED(status));
  EXPECT_EQ(WEXITSTATUS(status), 1);
  EXPECT_NE(folder.read("piped.svg"), "");
  EXPECT_EQ(run("mesh " + input + " -o " + folder.path("x") + " --json >/dev/full").code, 1);
}

TEST(Program, Exports) {
  const ScratchFolder folder;
  const std::string input = folder.write("in.poly", small_plate);
  const std::string base = folder.path("out");
  ASSERT_EQ(run("mesh " + input + " -o " + base + " --unit m").code, 0);
  const std::string options = " --geojson " + folder.path("a.json") + " --vtk " +
                              folder.path("a.vtk") + " --svg " + folder.path("a.svg") + " --unit m";
  ASSERT_EQ(run("export " + base + options).code, 0);
  EXPECT_THAT(folder.read("a.json"), HasSubstr("\"FeatureCollection\""));
  EXPECT_THAT(folder.read("a.vtk"), HasSubstr("DATASET UNSTRUCTURED_GRID"));
  EXPECT_THAT(folder.read("a.svg"), HasSubstr("6 nodes"));
  EXPECT_THAT(run("export " + base + " --svg -").output, HasSubstr("<svg"));
  EXPECT_EQ(run("export " + base + " --vtk /dev/full").code, 1);
}

TEST(Program, ReplaysAHistory) {
  const ScratchFolder folder;
  const std::string input = folder.write("in.poly", small_plate);
  const std::string base = folder.path("out");
  const std::string events = folder.write("events",
                                          "# a node joins, moves and leaves\n"
                                          "join 7 50 40\nmove 7 50 50\nfeature 9 7 4\n"
                                          "unfeature 5\nleave 5\n");
  const Outcome outcome = run("replay " + input + " " + events + " -o " + base + " --json");
  EXPECT_EQ(outcome.code, 0) << outcome.errors;
  EXPECT_THAT(outcome.output, AllOf(HasSubstr("\"nodes\":6,\"features\":5,"),
                                    HasSubstr("\"events\":5,\"refused\":0,\"event_p50_us\":")));
  const std::string after =
      folder.write("after.poly",
                   "6 2\n1 0 0\n2 100 0\n3 100 60\n4 0 60\n5 90 22\n6 50 50\n5 0\n1 1 2\n2 2 3\n"
                   "3 3 4\n4 4 1\n5 6 4\n0\n");
  const Outcome verify = run("verify " + after + " " + base);
  EXPECT_EQ(verify.code, 0) << verify.errors << folder.read("out.node");
}

std::string mesh_hash_in(const std::string& json) {
  const std::size_t at = json.find("\"mesh_hash\":");
  return at == std::string::npos ? "none" : json.substr(at, json.find(',', at) - at);
}

// What nodes have left behind on their way does not stay.
TEST(Program, ReplaysToTheMeshOfWhatStandsThen) {
  const ScratchFolder folder;
  const std::string input =
      folder.write("in.poly",
                   "9 2\n1 0 0\n2 1000 0\n3 1000 1000\n4 0 1000\n5 30 480\n6 970 520\n7 40 "
                   "530\n8 960 610\n9 500 300\n2 0\n1 5 6\n2 7 8\n0\n");
  std::string events = "join 50 500 500\n";
  for (int i = 0; i < 200; ++i) {
    events += "move 50 " + std::to_string(40 + i * 37 % 920) + " " +
              std::to_string(440 + i * 53 % 160) + "\n";
  }
  events += "leave 50\n";
  const Outcome replayed = run("replay " + input + " " + folder.write("events", events) + " -o " +
                               folder.path("out") + " --keep-going --json");
  ASSERT_EQ(replayed.code, 0) << replayed.errors;
  const Outcome meshed = run("mesh " + input + " -o " + folder.path("fresh") + " --json");
  ASSERT_EQ(meshed.code, 0) << meshed.errors;
  EXPECT_EQ(mesh_hash_in(replayed.output), mesh_hash_in(meshed.output));
  EXPECT_NE(mesh_hash_in(meshed.output), "none");
}

TEST(Program, NamesARefusedEvent) {
  const ScratchFolder folder;
  const std::string input = folder.write("in.poly", small_plate);
  const std::pair<const char*, const char*> table[] = {
      {"\njump 1\n", ":2: no event starts like this"},
      {"join 7 1\n", ":1: this join has 3 fields, not 4"},
      {"join 7 0.5 1\n", ":1: x 0.5 is no integer"},
      {"join 6 50 50\n", ":1: id 6 is taken"},
      {"join 7 0 0\n", "(in the way: node 1)"},
      {"leave 8\n", ":1: id 8 does not exist"},
      {"leave 1\n", ":1: "},
      {"feature 6 1 77\n", ":1: node 77 does not exist"},
      {"feature 6 1 3\n", "(in the way: feature 5)"},
      {"unfeature 6\n", ":1: id 6 does not exist"}};
  for (const auto& [text, message] : table) {
    const std::string events = folder.write("events", text);
    const std::string command = "replay " + input + " " + events + " -o " + folder.path("out");
    const Outcome outcome = run(command);
    EXPECT_EQ(outcome.code, 2) << text;
    EXPECT_THAT(outcome.errors, AllOf(HasSubstr(events + ":"), HasSubstr(message)));
    EXPECT_EQ(folder.file_count(), 2u);
  }
  folder.write("events", "leave 1\njoin 7 50 50\n");
  const Outcome outcome = run("replay " + input + " " + folder.path("events") + " -o " +
                              folder.path("out") + " --keep-going --json");
  EXPECT_EQ(outcome.code, 0);
  EXPECT_THAT(outcome.output, HasSubstr("\"events\":2,\"refused\":1,"));
}

}  // namespace
}  // namespace etcm::cli

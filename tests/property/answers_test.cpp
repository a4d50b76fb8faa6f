// Every call in every state with arguments of every kind, at small capacities, and at limits of
// work from nothing to what it needs: what it answers, that it answers what lib/docs/answers.md
// says and nothing else, and that a refused one leaves the mesh as it was.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <map>
#include <memory>
#include <regex>
#include <sstream>

#include "answer_calls.h"
#include "answer_states.h"
#include "etcm/audit.h"
#include "etcm/storage.h"
#include "support/emulated.h"
#include "support/mesh_block.h"

namespace etcm::test {

void PrintTo(const MeshCall& call, std::ostream* out) { *out << call.name; }

namespace {

// Letters of states, and what each has answered.
using Answers = std::map<char, std::set<Status>>;

char letter_of(std::size_t state) { return static_cast<char>('A' + state); }

// A mesh that is put into one state over and over.
class Stage {
 public:
  explicit Stage(const WayToState& way) : block_(way.config), policy_(way.config.policy) {
    EXPECT_EQ(block_->open(block_.bytes(), way.config), Status::ok);
    way.make(*block_);
    bytes_.assign(block_.bytes().begin(), block_.bytes().end());
    before_ = picture_of(*block_);
    is_canonical_ = block_->is_canonical();
    unresolved_ = block_->unresolved();
  }

  Mesh& set() {
    std::memcpy(block_.bytes().data(), bytes_.data(), bytes_.size());
    EXPECT_EQ(attach_copy(*block_, block_.bytes(), policy_), Status::ok);
    return *block_;
  }

  Mesh& mesh() { return *block_; }
  MeshBlock& block() { return block_; }

  testing::AssertionResult is_as_it_was() {
    Mesh& mesh = *block_;
    if (picture_of(mesh) != before_) return testing::AssertionFailure() << "changed the mesh";
    if (mesh.unresolved() != unresolved_)
      return testing::AssertionFailure() << "changed what is unresolved";
    return is_sound();
  }

  testing::AssertionResult is_sound() {
    const Audit sound = audit(*block_);
    // Of what build() left undone the audit says so.
    if (sound || (block_->unresolved() != 0 && sound.broken == Rule::conforming))
      return testing::AssertionSuccess();
    return testing::AssertionFailure() << "broken " << to_string(sound.broken);
  }

  // After a refusal it may know less of what is canonical, but not more.
  bool knows_no_more() { return is_canonical_ || !block_->is_canonical(); }

 private:
  MeshBlock block_;
  SplitPolicy policy_;
  std::vector<std::byte> bytes_;
  Picture before_;
  bool is_canonical_ = false;
  std::uint32_t unresolved_ = 0;
};

// The nodes and features alone.
bool same_input(const Mesh& mesh, const Graph& graph) {
  const Graph now = graph_of(mesh);
  const auto same = [](const FeatureEnds& a, const FeatureEnds& b) {
    return a.from == b.from && a.to == b.to;
  };
  return now.nodes == graph.nodes && now.features.size() == graph.features.size() &&
         std::equal(now.features.begin(), now.features.end(), graph.features.begin(), same);
}

class CallInState {
 public:
  CallInState(const MeshCall& call, const WayToState& way, std::set<Status>& seen)
      : call_(call), stage_(way), seen_(seen), questions_(call.questions(stage_.set())) {}

  // Returns how often the call was made.
  std::size_t run() {
    for (std::size_t i = 0; i < questions_.size(); i += thinning_if_slow) {
      SCOPED_TRACE("question " + std::to_string(i));
      ask(questions_[i]);
    }
    return asked_;
  }

 private:
  void ask(const Question& question) {
    const Status answer = put(question, Work::unlimited());
    const Work needed = mesh().work_needed();
    const std::uint64_t hash = mesh().hash();
    if (question.foretell) foretell(question, answer);
    if (!call_.has_limit) return;
    for (const std::uint64_t units : limits(needed.units)) {
      SCOPED_TRACE("limit " + std::to_string(units));
      const Status limited = put(question, Work{units});
      if (answer != Status::ok) {
        ASSERT_TRUE(limited == answer || limited == Status::work_limit) << to_string(limited);
        continue;
      }
      ASSERT_EQ(limited, units < needed.units ? Status::work_limit : Status::ok);
      ASSERT_LE(mesh().work_needed().units, units);
      if (limited == Status::ok) {
        ASSERT_EQ(mesh().hash(), hash);
      }
    }
  }

  // All of them where they are few. A call by handles is one by ids behind a door.
  std::vector<std::uint64_t> limits(std::uint64_t needed) const {
    std::vector<std::uint64_t> all;
    const std::uint64_t few = call_.name.starts_with("Handles") ? 3 : 24;
    const std::uint64_t step = needed / (few * 2) + 1;
    for (std::uint64_t units = 0; units < needed; units += units < few ? 1 : step) {
      all.push_back(units);
    }
    if (needed != 0) all.push_back(needed - 1);
    all.push_back(needed);
    return all;
  }

  Status put(const Question& question, Work limit) {
    const Graph input = graph_of(stage_.set());
    const Status answer =
        question.ask ? question.ask(mesh(), limit) : question.ask_of_bytes(stage_.block());
    seen_.insert(answer);
    EXPECT_TRUE(call_.promised.contains(answer)) << to_string(answer);
    if (call_.tells_detail && answer != Status::ok) {
      EXPECT_EQ(mesh().error_detail().status, answer);
    }
    if (answer == Status::ok) {
      EXPECT_TRUE(stage_.is_sound());
      if (call_.has_limit) {
        EXPECT_EQ(mesh().unresolved(), 0u);
      }
    } else if (call_.refused == Refused::keeps_a_part && answer == Status::work_limit) {
      EXPECT_TRUE(stage_.is_sound());
      EXPECT_TRUE(same_input(mesh(), input));
    } else if (call_.refused == Refused::leaves_none && answer != Status::mesh_not_empty) {
      EXPECT_TRUE(stage_.is_sound());
      EXPECT_EQ(mesh().node_count() == 0, mesh().unresolved() == 0) << to_string(answer);
    } else {
      EXPECT_TRUE(stage_.is_as_it_was()) << to_string(answer);
      EXPECT_TRUE(stage_.knows_no_more()) << to_string(answer);
    }
    ++asked_;
    return answer;
  }

  void foretell(const Question& question, Status answer) {
    stage_.set();
    const Outcome outcome = question.foretell(mesh(), Work::unlimited());
    EXPECT_EQ(outcome.status, answer);
    EXPECT_TRUE(stage_.is_as_it_was());
    EXPECT_TRUE(stage_.knows_no_more());
  }

  Mesh& mesh() { return stage_.mesh(); }

  const MeshCall& call_;
  Stage stage_;
  std::set<Status>& seen_;
  std::vector<Question> questions_;
  std::size_t asked_ = 0;
};

// lib/docs/answers.md, whose tables say what is reached and, by a small letter, why not.
class AnswersDocument {
 public:
  AnswersDocument() {
    std::ifstream file(ETCM_ANSWERS_DOCUMENT);
    std::vector<std::string> sections;
    for (std::string line; std::getline(file, line);) {
      if (line.starts_with("## ")) sections = names_in(line.substr(3));
      if (!line.starts_with("| ")) continue;
      std::vector<std::string> cells;
      std::istringstream row(line.substr(2));
      for (std::string cell; row >> cell;) {
        if (cell != "|") cells.push_back(cell);
      }
      if (cells.empty() || cells.front() == "answer") continue;
      for (const std::string& section : sections) {
        rows_[section][cells.front()] = {cells.begin() + 1, cells.end()};
      }
    }
  }

  // A call's answers, a cell for each state: "x" where it is reached.
  const std::map<std::string, std::vector<std::string>>& rows(const std::string& section) {
    return rows_[section];
  }
  bool has_reason(const std::string& letter) { return rows_["Why not"].contains(letter); }

  // The reasons that no cell gives.
  std::set<std::string> idle_reasons() {
    std::set<std::string> idle;
    for (const auto& [letter, text] : rows_["Why not"]) idle.insert(letter);
    for (const auto& [section, rows] : rows_) {
      if (section == "Why not" || section == "States") continue;
      for (const auto& [answer, cells] : rows) {
        for (const std::string& cell : cells) idle.erase(cell);
      }
    }
    return idle;
  }

 private:
  // A table may be that of several calls.
  static std::vector<std::string> names_in(const std::string& title) {
    std::vector<std::string> names;
    std::size_t from = 0;
    for (std::size_t comma = 0; comma != std::string::npos; from = comma + 2) {
      comma = title.find(", ", from);
      names.push_back(title.substr(from, comma - from));
    }
    return names;
  }

  std::map<std::string, std::map<std::string, std::vector<std::string>>> rows_;
};

std::string table_of(const MeshCall& call, const Answers& seen, AnswersDocument& document) {
  std::ostringstream table;
  table << "## " << call.name << "\n\n| answer |";
  for (const auto& [letter, statuses] : seen) table << ' ' << letter << " |";
  table << "\n|---|";
  for (std::size_t i = 0; i < seen.size(); ++i) table << "---|";
  for (const Status status : call.promised) {
    table << "\n| " << to_string(status) << " |";
    const auto& rows = document.rows(call.name);
    const auto row = rows.find(to_string(status));
    for (const auto& [letter, statuses] : seen) {
      const auto at = static_cast<std::size_t>(letter - 'A');
      const bool is_known = row != rows.end() && at < row->second.size() && row->second[at] != "x";
      table << ' ' << (statuses.contains(status) ? "x" : is_known ? row->second[at] : "?") << " |";
    }
  }
  table << "\n\n";
  return table.str();
}

class AnswersOf : public testing::TestWithParam<MeshCall> {};

TEST_P(AnswersOf, EachStateAreThoseOfTheDocument) {
  const MeshCall& call = GetParam();
  AnswersDocument document;
  Answers seen;
  std::size_t state = 0, asked = 0;
  for (const MeshSituation& situation : mesh_situations()) {
    const char letter = letter_of(state++);
    for (std::size_t way = 0; way < situation.ways.size(); ++way) {
      SCOPED_TRACE(situation.name + ", way " + std::to_string(way));
      asked += CallInState(call, situation.ways[way], seen[letter]).run();
      if (HasFailure()) return;
    }
  }
  RecordProperty("asked", std::to_string(asked));
  if (thinning_if_slow != 1) return;
  const auto& rows = document.rows(call.name);
  bool is_right = rows.size() == call.promised.size();
  for (const Status status : call.promised) {
    const auto row = rows.find(to_string(status));
    is_right = is_right && row != rows.end() && row->second.size() == seen.size();
    for (const auto& [letter, statuses] : seen) {
      if (!is_right) break;
      const std::string& cell = row->second[static_cast<std::size_t>(letter - 'A')];
      is_right = statuses.contains(status) ? cell == "x" : document.has_reason(cell);
    }
  }
  EXPECT_TRUE(is_right) << "lib/docs/answers.md says otherwise than\n"
                        << table_of(call, seen, document);
}

std::string name_of_call(const testing::TestParamInfo<MeshCall>& call) {
  std::string name = call.param.name;
  std::erase_if(name, [](char c) { return c == ':' || c == '(' || c == ')'; });
  return name;
}

INSTANTIATE_TEST_SUITE_P(Calls, AnswersOf, testing::ValuesIn(mesh_calls()), name_of_call);

TEST(AnswersDocument, NamesTheStates) {
  std::ifstream file(ETCM_ANSWERS_DOCUMENT);
  std::set<std::string> lines;
  for (std::string line; std::getline(file, line);) lines.insert(line);
  std::size_t state = 0;
  for (const MeshSituation& situation : mesh_situations()) {
    const std::string row = std::string("| ") + letter_of(state++) + " | " + situation.name + " |";
    EXPECT_TRUE(lines.contains(row)) << row;
  }
}

// The calls of a header of the library that answer a Status, as mesh_calls() names them.
std::vector<std::string> calls_declared(const std::filesystem::path& header) {
  static const std::regex class_line("^class (\\w+) \\{"),
      call_line("^ *Status (\\w+)\\((?:const )?(?:std::)?(\\w+).*");
  struct Declared {
    std::string name;
    std::string first_argument;
  };
  std::vector<Declared> declared;
  std::ifstream file(header);
  std::string scope;
  bool is_public = true;
  for (std::string line; std::getline(file, line);) {
    std::smatch match;
    if (std::regex_search(line, match, class_line)) scope = match[1].str() + "::";
    if (line == " private:") is_public = false;
    if (line == "};") {
      scope.clear();
      is_public = true;
    }
    if (!is_public || !std::regex_match(line, match, call_line)) continue;
    declared.push_back({(scope == "Mesh::" ? "" : scope) + match[1].str(), match[2]});
  }
  std::vector<std::string> names;
  for (const Declared& call : declared) {
    const bool is_one_of_several = std::ranges::count(declared, call.name, &Declared::name) > 1;
    names.push_back(call.name + (is_one_of_several ? "(" + call.first_argument + ")" : ""));
  }
  return names;
}

TEST(AnswersDocument, HasEachCallOfTheHeadersThatAnswersAStatus) {
  std::set<std::string> declared, asked;
  for (const auto& header : std::filesystem::directory_iterator(ETCM_HEADERS)) {
    for (const std::string& name : calls_declared(header.path())) declared.insert(name);
  }
  for (const MeshCall& call : mesh_calls()) asked.insert(call.name);
  EXPECT_THAT(asked, testing::ContainerEq(declared));
  AnswersDocument document;
  for (const std::string& name : declared) EXPECT_FALSE(document.rows(name).empty()) << name;
  EXPECT_THAT(document.idle_reasons(), testing::IsEmpty());
}

}  // namespace
}  // namespace etcm::test

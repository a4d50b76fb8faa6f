// Looks for calls that come near their limit of work, or beyond it: from the inputs of each family
// on, by threshold accepting (Dueck and Scheuer 1990). The same seed and the same count of inputs
// find the same, on every machine. Tells the worst of each call, in lines that hardest_work.txt is
// made of. Leaves with 1 where a call does not hold what mesh.h promises.
#include <CLI/CLI.hpp>
#include <algorithm>
#include <cstdint>
#include <cstdio>
#include <fstream>
#include <optional>
#include <string>
#include <vector>

#include "work_families.h"
#include "work_judge.h"

namespace etcm::test {
namespace {

using inputs::Random;

// A call that can be measured.
struct Measured {
  Verb verb;
  Way way;
};

struct Worst {
  WorkCase of;
  Judgement judgement;
};

std::vector<Measured> measured_calls() {
  std::vector<Measured> all;
  for (std::size_t i = 0; i < verb_count; ++i) {
    const auto verb = static_cast<Verb>(i);
    if (verb == Verb::row || verb == Verb::ring || verb == Verb::scatter) continue;
    all.push_back({verb, Way::change});
    if (has_dry_run(verb)) all.push_back({verb, Way::dry_run});
  }
  return all;
}

class Search {
 public:
  Search(std::uint64_t seed, std::uint64_t inputs, std::uint64_t limits, Size size)
      : seed_(seed), inputs_(inputs), limits_(limits), size_(size) {}

  // From one start, as long as it has inputs.
  void anneal(Family family, const Measured& call, Worst& worst) {
    Random random(seed_ ^ (static_cast<std::uint64_t>(family) << 8) ^
                  (static_cast<std::uint64_t>(call.verb) << 16) ^
                  (static_cast<std::uint64_t>(call.way) << 24));
    constexpr std::uint64_t starts = 4;
    for (std::uint64_t start = 0; start < starts; ++start) {
      const std::uint64_t inputs = inputs_ / starts;
      WorkCase now = case_of(family, call.verb, size_, random);
      double nearness = look_at(now, family, call, worst);
      for (std::uint64_t i = 1; i < inputs; ++i) {
        const WorkCase next = altered(now, size_, random);
        const double there = look_at(next, family, call, worst);
        const double heat = 0.3 * static_cast<double>(inputs - i) / static_cast<double>(inputs);
        if (there < nearness - heat) continue;
        now = next;
        nearness = there;
      }
    }
  }
  // What follows is of another call.
  void begin_call() {
    least_left_ = INT64_MAX;
    greatest_ratio_ = 0;
  }
  std::int64_t least_left() const { return least_left_; }
  double greatest_ratio() const { return greatest_ratio_; }
  std::uint64_t looked() const { return looked_; }
  std::uint64_t runs() const { return runs_; }
  const std::vector<std::string>& faults() const { return faults_; }

 private:
  double look_at(const WorkCase& of, Family family, const Measured& call, Worst& worst) {
    const Judgement judgement = judge(stage_, of, call.way, limits_);
    ++looked_;
    runs_ += judgement.runs;
    least_left_ = std::min(least_left_, judgement.least_left);
    greatest_ratio_ = std::max(greatest_ratio_, judgement.greatest_ratio);
    if (!judgement.fault.empty()) {
      faults_.push_back(std::string(call.way == Way::dry_run ? "dry run, " : "") + name_of(family) +
                        ": " + judgement.fault + "\n  " + to_text(of));
      std::fprintf(stderr, "%s\n", faults_.back().c_str());
    }
    if (worst.of.steps.empty() || judgement.nearness > worst.judgement.nearness) {
      worst = {of, judgement};
    }
    return judgement.nearness;
  }

  std::uint64_t seed_;
  std::uint64_t inputs_;
  std::uint64_t limits_;
  Size size_;
  Stage stage_;
  std::uint64_t looked_ = 0;
  std::uint64_t runs_ = 0;
  std::int64_t least_left_ = INT64_MAX;
  double greatest_ratio_ = 0;
  std::vector<std::string> faults_;
};

// A case as small as it can be while it has a fault.
int minimise(const std::string& text) {
  const std::optional<WorkCase> of = case_from(text);
  if (!of) {
    std::fprintf(stderr, "work_search: no case: %s\n", text.c_str());
    return 2;
  }
  Stage stage;
  for (const Way way : {Way::change, Way::dry_run}) {
    if (way == Way::dry_run && !has_dry_run(of->last().verb)) continue;
    const auto fault = [&](const WorkCase& next) { return judge(stage, next, way, 160).fault; };
    if (fault(*of).empty()) continue;
    const WorkCase small =
        smallest(*of, [&](const WorkCase& next) { return !fault(next).empty(); });
    std::printf("%s%s\n  %s\n", way == Way::dry_run ? "dry run: " : "", fault(small).c_str(),
                to_text(small).c_str());
    return 1;
  }
  std::printf("no fault\n");
  return 0;
}

int run(std::uint64_t seed, std::uint64_t inputs, std::uint64_t limits, Size size,
        const std::string& file, const std::string& only) {
  Search search(seed, inputs, limits, size);
  std::string lines;
  std::printf("| call | inputs | calls | least left of a limit | most used of one, going back |\n");
  std::printf("|---|---:|---:|---:|---:|\n");
  for (const Measured& call : measured_calls()) {
    const std::string name =
        std::string(call.way == Way::dry_run ? "dry run of " : "") + name_of(call.verb);
    if (!only.empty() && name != only) continue;
    const std::uint64_t looked = search.looked(), runs = search.runs();
    search.begin_call();
    for (std::size_t f = 0; f < family_count; ++f) {
      Worst worst;
      search.anneal(static_cast<Family>(f), call, worst);
      lines += to_text(worst.of) + "\n";
    }
    std::printf("| %s | %llu | %llu | %lld | %.3f |\n", name.c_str(),
                static_cast<unsigned long long>(search.looked() - looked),
                static_cast<unsigned long long>(search.runs() - runs),
                static_cast<long long>(search.least_left()), search.greatest_ratio());
    std::fflush(stdout);
  }
  std::fprintf(stderr, "%zu faults\n", search.faults().size());
  if (!file.empty()) std::ofstream(file) << lines;
  return search.faults().empty() ? 0 : 1;
}

}  // namespace
}  // namespace etcm::test

int main(int argc, char** argv) {
  CLI::App app{"Looks for calls of a mesh that come near their limit of work, or beyond it"};
  std::uint64_t seed = 1, inputs = 400, limits = 96;
  std::string file, only, text;
  bool is_large = false;
  app.add_option("--seed", seed, "what is drawn from")->capture_default_str();
  app.add_option("--inputs", inputs, "how many of each call and family")->capture_default_str();
  app.add_option("--limits", limits, "how many of each input")->capture_default_str();
  app.add_flag("--large", is_large, "of meshes of up to 1200 nodes");
  app.add_option("--call", only, "only this one, such as move or \"dry run of move\"");
  app.add_option("--write", file, "the file for the worst inputs");
  app.add_option("--minimise", text, "a case with a fault, to be made as small as it can be");
  CLI11_PARSE(app, argc, argv);
  if (!text.empty()) return etcm::test::minimise(text);
  const auto size = is_large ? etcm::test::Size::large : etcm::test::Size::small;
  return etcm::test::run(seed, inputs, limits, size, file, only);
}

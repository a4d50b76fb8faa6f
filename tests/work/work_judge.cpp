#include "work_judge.h"

#include <algorithm>
#include <array>
#include <vector>

#include "etcm/audit.h"
#include "etcm/dry_run.h"
#include "triangulation/mesh_state.h"

namespace etcm::test {
namespace {

// Below, what is used is the fixed part of a call.
constexpr std::uint64_t least_limit_of_ratio = 64;
// What the meter has for what is added before it is asked for.
constexpr std::int64_t reserve = 24;

// A refusal of these may leave another mesh, or none.
bool is_by_parts(Verb verb) {
  return verb == Verb::canonicalize || verb == Verb::optimise || verb >= Verb::build;
}

struct Run {
  std::uint64_t limit = 0;
  Status status = Status::ok;
  std::uint64_t used = 0;
  std::uint64_t needed = 0;
  std::uint64_t kept = 0;  // for going back, where the call did
  std::int64_t left() const {
    return static_cast<std::int64_t>(limit) - static_cast<std::int64_t>(used);
  }
};

// What the meter has counted, with the room that it keeps: of a call that goes back, which has no
// limit.
std::uint64_t taken(const internal::WorkMeter& meter) {
  internal::Units room = 0;
  for (internal::Units bit = internal::Units{1} << (8 * sizeof(internal::Units) - 1); bit != 0;
       bit >>= 1) {
    if (meter.has_room(room | bit)) room |= bit;
  }
  return ~internal::Units{0} - room;
}

class Court {
 public:
  Court(Stage& stage, const WorkCase& of, Way way, std::uint64_t limits_most)
      : stage_(stage), last_(of.last()), way_(way), limits_most_(limits_most) {
    stage_.prepare(of);
    stage_.keep();
    before_ = picture_of(stage_.mesh());
  }

  Judgement judge() {
    const Run whole = run(Work::unlimited());
    found_.answer = whole.status;
    found_.needed = end_ = whole.needed;
    hash_ = stage_.mesh().hash();
    found_.least_left = reserve;
    // What is refused says what it has used, not what it would have needed.
    if (found_.answer != Status::ok) end_ = 3 * found_.needed;
    if (end_ + 2 <= limits_most_) {
      for (std::uint64_t limit = 0; limit <= end_ + 2; ++limit) try_limit(limit);
    } else {
      try_some_limits();
    }
    try_limit(2 * end_);
    if (!is_by_parts(last_.verb) && way_ == Way::change) try_after_refusals();
    return found_;
  }

 private:
  Run run(Work limit) {
    ++found_.runs;
    Mesh& mesh = stage_.mesh();
    internal::MeshState& m = state_of(mesh);
    Outcome outcome{.status = Status::work_limit};
    // As a dry run does (dry_run.cpp), so that it can be seen what it takes.
    if (way_ == Way::dry_run) m.outcome = &outcome;
    Run made{.limit = limit.units, .status = stage_.call(last_, limit)};
    m.outcome = nullptr;
    made.used = mesh.work_used().units;
    made.needed = mesh.work_needed().units;
    if (m.work.is_going_back()) made.kept = taken(m.work) - made.used;
    if (way_ == Way::dry_run && outcome.status == Status::ok) {
      made.status = Status::ok;
      made.needed = outcome.work.units;
    }
    return made;
  }

  void try_some_limits() {
    const std::uint64_t dense = limits_most_ / 2;
    for (std::uint64_t limit = 0; limit < dense; ++limit) try_limit(limit);
    std::vector<Run> tried;
    // Each so much greater than the one before, but for the last ones.
    double at = static_cast<double>(dense);
    const double end = static_cast<double>(end_);
    const double factor = std::max(1.0, end / at);
    for (std::uint64_t i = 1; i <= dense; ++i) {
      const double part = static_cast<double>(i) / static_cast<double>(dense);
      const double next = at + (end - at) * part * (1 / factor + (1 - 1 / factor) * part);
      tried.push_back(try_limit(static_cast<std::uint64_t>(next)));
    }
    for (std::uint64_t i = 0; i < 3; ++i) try_limit(end_ - 1 + i);
    std::sort(tried.begin(), tried.end(),
              [](const Run& a, const Run& b) { return nearness_of(a) > nearness_of(b); });
    for (std::size_t i = 0; i < std::min<std::size_t>(3, tried.size()); ++i) look_below(tried[i]);
  }

  // The least limit under which the same is done.
  void look_below(const Run& run) {
    std::uint64_t low = 0, high = run.limit;
    while (low + 1 < high) {
      const std::uint64_t middle = low + (high - low) / 2;
      if (run.limit - middle > 4 * (static_cast<std::uint64_t>(reserve) + run.kept)) {
        low = middle;
        continue;
      }
      const Run there = try_limit(middle);
      (there.used == run.used ? high : low) = middle;
    }
  }

  static double nearness_of(const Run& run) {
    const bool is_whole = run.limit >= static_cast<std::uint64_t>(reserve);
    if (run.left() < (is_whole ? reserve : 0))
      return 2.0 + static_cast<double>(reserve - run.left());
    if (run.kept <= static_cast<std::uint64_t>(reserve)) return -1e9;
    return 1.0 - static_cast<double>(run.left() - reserve) / static_cast<double>(run.kept);
  }

  Run try_limit(std::uint64_t limit) {
    stage_.put_back();
    const Run made = run({limit});
    note(made);
    if (const char* fault = fault_of(made); fault != nullptr && found_.fault.empty()) {
      found_.fault = fault;
      found_.fault += ": limit " + std::to_string(limit) + ", used " + std::to_string(made.used) +
                      ", needed " + std::to_string(made.needed) + ", without a limit " +
                      std::to_string(found_.needed) + ", " + to_string(made.status);
    }
    return made;
  }

  void note(const Run& made) {
    if (made.left() < found_.least_left && made.limit >= static_cast<std::uint64_t>(reserve)) {
      found_.least_left = made.left();
      found_.limit_of_least = made.limit;
    }
    found_.nearness = std::max(found_.nearness, nearness_of(made));
    if (made.limit < least_limit_of_ratio || made.kept == 0) return;
    const double ratio = static_cast<double>(made.used) / static_cast<double>(made.limit);
    if (ratio <= found_.greatest_ratio) return;
    found_.greatest_ratio = ratio;
    found_.limit_of_ratio = made.limit;
  }

  const char* fault_of(const Run& made) {
    if (made.left() < 0) return "used more than its limit";
    if (made.needed > made.limit) return "says that it needs more than its limit";
    if (made.used > made.needed && way_ == Way::change) return "used more than it says it needs";
    if (found_.answer != Status::ok) {
      const bool is_refused = made.status == Status::work_limit;
      if (!is_refused && made.status != found_.answer) return "answers otherwise with a limit";
    } else if (made.limit >= found_.needed) {
      if (made.status != found_.answer) return "is refused what it needs";
      if (made.needed != found_.needed) return "needs something else with a limit";
      if (stage_.mesh().hash() != hash_) return "makes another mesh with a limit";
      return nullptr;
    }
    if (found_.answer == Status::ok && made.status != Status::work_limit) {
      return "does with less than it says it needs";
    }
    if (made.status != Status::work_limit) return nullptr;
    if (made.needed != made.used) return "refused, it says that it needs what it did not use";
    return fault_of_refused();
  }

  const char* fault_of_refused() {
    Mesh& mesh = stage_.mesh();
    if (last_.verb >= Verb::build) {
      return mesh.node_count() == 0 && mesh.unresolved() == 0 ? nullptr : "refused, it left a part";
    }
    if (is_by_parts(last_.verb)) {
      return mesh.node_count() != 0 || before_.vertices.empty() ? nullptr
                                                                : "refused, it lost nodes";
    }
    return picture_of(mesh) == before_ ? nullptr : "refused, it changed the mesh";
  }

  // Without being put back: each refusal leaves what the next call finds.
  void try_after_refusals() {
    stage_.put_back();
    std::uint64_t limit = 1;
    for (; limit < end_; limit += 1 + limit / 3) {
      const Run made = run({limit});
      note(made);
      if (made.status != Status::work_limit) {
        if (made.status != found_.answer) found_.fault = "after refusals it answers otherwise";
        return;
      }
      if (made.left() < 0 && found_.fault.empty()) {
        found_.fault = "after refusals, used more than its limit: limit " + std::to_string(limit) +
                       ", used " + std::to_string(made.used);
      }
    }
    const Run made = run(Work::unlimited());
    if (!found_.fault.empty()) return;
    if (made.status != found_.answer) found_.fault = "after refusals it answers otherwise";
    if (stage_.mesh().hash() != hash_) found_.fault = "after refusals it makes another mesh";
    if (!audit(stage_.mesh())) found_.fault = "after refusals the mesh fails its audit";
  }

  Stage& stage_;
  const Step last_;
  const Way way_;
  const std::uint64_t limits_most_;
  Picture before_;
  std::uint64_t hash_ = 0;
  std::uint64_t end_ = 0;
  Judgement found_;
};

}  // namespace

bool has_dry_run(Verb verb) {
  return verb == Verb::node || verb == Verb::line || verb == Verb::leave || verb == Verb::move ||
         verb == Verb::unline;
}

Judgement judge(Stage& stage, const WorkCase& of, Way way, std::uint64_t limits_most) {
  return Court(stage, of, way, limits_most).judge();
}

}  // namespace etcm::test

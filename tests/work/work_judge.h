// What a call takes under each of many limits, and whether that is what mesh.h promises.
#pragma once

#include <cstdint>
#include <string>

#include "work_case.h"

namespace etcm::test {

// How the change of a step is made. Only a change of nodes or of one feature can be a dry run.
enum class Way : std::uint8_t { change, dry_run };
inline constexpr std::size_t way_count = 2;
bool has_dry_run(Verb verb);

struct Judgement {
  // Where it is not empty, a promise does not hold, and this says which.
  std::string fault;
  std::uint64_t runs = 0;
  Status answer = Status::ok;  // without a limit
  std::uint64_t needed = 0;    // without a limit
  // Of all limits: the least that was left of one, less than nothing where it was exceeded.
  std::int64_t least_left = 0;
  std::uint64_t limit_of_least = 0;
  // The greatest part that was used of a limit of 64 and more by a call that had to go back.
  double greatest_ratio = 0;
  std::uint64_t limit_of_ratio = 0;
  // The greater the nearer it is to a limit that does not hold: of a call that goes back, the part
  // that is used of the room for that; where the reserve for what is not asked for beforehand is
  // used too, more than 1.
  double nearness = 0;
};

// `limits_most`: of greater calls so many limits at least, and then those near the worst; each
// limit where there are no more.
Judgement judge(Stage& stage, const WorkCase& of, Way way, std::uint64_t limits_most);

}  // namespace etcm::test

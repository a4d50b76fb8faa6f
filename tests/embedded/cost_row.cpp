#include "cost_row.h"

#include <algorithm>

#include "console.h"
#include "cost_inputs.h"
#include "etcm/work.h"

namespace etcm::test {
namespace {

// That lib/docs/work.md states.
constexpr std::uint64_t instructions_max = ETCM_INSTRUCTIONS_MAX;
// Of smaller calls fixed costs are measured, not the units.
constexpr std::uint64_t least_units = 1000;
// From one end of a row of nodes to the other; a step takes as long as two units at worst.
constexpr std::uint32_t walk_most = 2 * 2 * cost_node_count;

void raise(std::uint64_t& most, std::uint64_t value, std::uint32_t& with,
           std::uint32_t seed) noexcept {
  if (value <= most) return;
  most = value;
  with = seed;
}

std::uint64_t median_of(Row& row) noexcept {
  if (row.count == 0) return 0;
  std::sort(row.samples.begin(), row.samples.begin() + row.count);
  return row.samples[row.count / 2];
}

}  // namespace

void Row::take(const Measured& call) noexcept {
  if (call.is_sample) {
    if (count < samples.size()) samples[count++] = static_cast<std::uint32_t>(call.instructions);
    worst = std::max(worst, call.instructions);
  }
  raise(found, call.instructions, found_with, call.seed);
  raise(longest, call.longest, longest_with, call.seed);
  if (kind != Kind::change) return;
  if (call.units < least_units) {
    least = std::max(least, call.instructions);
  } else {
    raise(unit, (call.instructions + call.units - 1) / call.units, unit_with, call.seed);
  }
}

void Row::take_worst_of(const Row& other) noexcept {
  worst = std::max(worst, other.worst);
  raise(found, other.found, found_with, other.found_with);
  raise(unit, other.unit, unit_with, other.unit_with);
  least = std::max(least, other.least);
  raise(longest, other.longest, longest_with, other.longest_with);
}

bool put_row(Row& row) noexcept {
  const std::uint64_t gap = row.kind == Kind::question ? 0 : row.longest;
  put("cost;");
  put(row.name);
  for (const std::uint64_t value : {median_of(row), row.worst, row.found, row.unit, row.least, gap,
                                    std::uint64_t{row.found_with}, std::uint64_t{row.unit_with},
                                    std::uint64_t{row.longest_with}}) {
    put(";");
    put_number(value);
  }
  put("\n");
  return row.unit <= instructions_max && row.least <= instructions_max * least_units &&
         gap <= instructions_max * (KeepAlive::units_between + walk_most);
}

}  // namespace etcm::test

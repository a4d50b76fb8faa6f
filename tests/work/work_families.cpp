#include "work_families.h"

#include <algorithm>
#include <cstddef>

namespace etcm::test {
namespace {

using inputs::Random;

constexpr std::size_t steps_most = 48;

Step step_of(Verb verb, std::int32_t a = 0, std::int32_t b = 0, std::int32_t c = 0,
             std::int32_t d = 0, std::int32_t e = 0) {
  return {.verb = verb, .number = {a, b, c, d, e}};
}

// Up to `most`; of large ones every fourth up to far more.
std::int32_t size_of(std::int32_t least, std::int32_t most, Size size, Random& random) {
  const bool is_large = size == Size::large && random.below(4) == 0;
  return random.between(least, is_large ? 8 * most : most);
}

std::int32_t anywhere(Random& random) {
  constexpr std::int32_t sides[] = {20, 300, 5000, 100'000, 3'000'000};
  const std::int32_t side = sides[random.below(5)];
  return random.between(-side, side);
}

Step any_step(Verb verb, Random& random) {
  Step step{.verb = verb, .number = {}};
  for (std::int32_t& number : step.number) number = anywhere(random);
  if (verb != Verb::node && verb != Verb::move) step.number[0] = random.between(0, 60);
  if (verb == Verb::move || verb == Verb::line)
    step.number[verb == Verb::line] = random.between(0, 99);
  if (verb == Verb::row || verb == Verb::ring) step.number[3] = random.between(1, 400);
  return step;
}

void add_lines(WorkCase& of, std::int32_t count, Random& random) {
  for (std::int32_t i = 0; i < count; ++i) {
    const std::int32_t from = random.between(0, 60);
    of.steps.push_back(step_of(Verb::line, from, random.between(0, 60)));
  }
}

void begin_row_family(WorkCase& of, Family family, Size size, Random& random) {
  std::vector<Step>& steps = of.steps;
  const std::int32_t n = size_of(4, 50, size, random), gap = random.between(3, 400);
  const std::int32_t near = random.between(1, 40);
  const std::int32_t length = n * gap;
  if (family == Family::near_touching) {
    // A feature with nodes close along it, on one side or both.
    steps.push_back(step_of(Verb::node, 0, 0));
    steps.push_back(step_of(Verb::node, length, 0));
    steps.push_back(step_of(Verb::row, n, gap / 2, -near, gap, 0));
    if (random.below(2) == 0) steps.push_back(step_of(Verb::row, n, gap / 3, near, gap, 0));
    steps.push_back(step_of(Verb::node, length / 2, random.between(1, 4 * length)));
    steps.push_back(step_of(Verb::line, 0, 1));
  } else if (family == Family::parallels) {
    const std::int32_t count = random.between(2, 14);
    for (std::int32_t i = 0; i < count; ++i) {
      steps.push_back(step_of(Verb::node, random.between(-near, near), i * near));
      steps.push_back(step_of(Verb::node, length + random.between(-near, near), i * near));
    }
    for (std::int32_t i = 0; i < count; ++i) steps.push_back(step_of(Verb::line, 2 * i, 2 * i + 1));
  } else {
    steps.push_back(step_of(Verb::row, n, 0, 0, gap, family == Family::collinear ? near : 0));
    if (family == Family::through_nodes) {
      steps.push_back(step_of(Verb::row, n, gap / 2, near, gap, random.between(-1, 1)));
      steps.push_back(step_of(Verb::row, n, gap / 3, -near, gap, 0));
    }
    steps.push_back(step_of(Verb::line, 0, n - 1));
  }
}

void begin_round_family(WorkCase& of, Family family, Size size, Random& random) {
  std::vector<Step>& steps = of.steps;
  const std::int32_t n = size_of(4, 36, size, random), scale = random.between(1, 5000);
  if (family != Family::cocircular) steps.push_back(step_of(Verb::node, 0, 0));
  steps.push_back(step_of(Verb::ring, n, 0, 0, scale));
  if (family == Family::cocircular) {
    if (random.below(2) == 0) add_lines(of, random.between(1, 6), random);
    return;
  }
  // Off the circle, or all its nodes are on one.
  for (std::int32_t i = 1; i <= n; ++i) {
    const std::int32_t x = random.between(-65 * scale, 65 * scale);
    if (random.below(3) == 0)
      steps.push_back(step_of(Verb::node, x, random.between(-65, 65) * scale));
    if (family == Family::star && i < 24) steps.push_back(step_of(Verb::line, 0, i));
  }
}

Step last_step(Verb verb, Random& random) {
  Step step = any_step(verb, random);
  if (verb == Verb::optimise) step.number[0] = random.between(1, 15);
  return step;
}

void alter_number(Step& step, const WorkCase& of, Random& random) {
  const std::size_t count = numbers_of(step.verb);
  if (count == 0) return;
  std::int32_t& number = step.number[random.index(count)];
  switch (random.below(7)) {
    case 0:
      number += random.between(-1, 1);
      return;
    case 1:
      number += random.between(-10, 10);
      return;
    case 2:
      number = number / 10 * random.between(7, 13);
      return;
    case 3:
      number = std::abs(number) < position_max / 4 ? 2 * number : number / 2;
      return;
    case 4:
      number = number / 2;
      return;
    case 5:
      number = anywhere(random);
      return;
    default: {
      const Step& other = of.steps[random.index(of.steps.size())];
      number = other.number[random.index(5)];
    }
  }
}

void keep_in_bounds(Step& step, Size size) {
  for (std::int32_t& number : step.number) {
    number = std::clamp(number, -position_max / 2, position_max / 2);
  }
  if (step.verb == Verb::row || step.verb == Verb::ring || step.verb == Verb::scatter) {
    step.number[0] = std::clamp(step.number[0], 0, size == Size::large ? 400 : 100);
  }
}

constexpr Verb verbs_between[] = {Verb::node,    Verb::node,   Verb::row,   Verb::ring,
                                  Verb::line,    Verb::line,   Verb::line,  Verb::scatter,
                                  Verb::move,    Verb::unline, Verb::leave, Verb::canonicalize,
                                  Verb::optimise};

}  // namespace

const char* name_of(Family family) {
  constexpr const char* names[family_count] = {"random",        "grid",          "collinear",
                                               "star",          "hub",           "parallels",
                                               "near touching", "through nodes", "cocircular"};
  return names[static_cast<std::size_t>(family)];
}

WorkCase case_of(Family family, Verb last, Size size, Random& random) {
  WorkCase made;
  switch (family) {
    case Family::random:
      made.steps.push_back(step_of(Verb::scatter, size_of(4, 60, size, random), 0, 0,
                                   1 + std::abs(anywhere(random)), anywhere(random)));
      add_lines(made, random.between(0, 10), random);
      break;
    case Family::grid: {
      const std::int32_t n = size_of(3, 8, size, random), gap = random.between(1, 300);
      for (std::int32_t i = 0; i < n; ++i) {
        made.steps.push_back(step_of(Verb::row, n, 0, i * gap, gap, 0));
      }
      add_lines(made, random.between(0, 10), random);
      break;
    }
    case Family::star:
    case Family::hub:
    case Family::cocircular:
      begin_round_family(made, family, size, random);
      break;
    default:
      begin_row_family(made, family, size, random);
  }
  made.steps.push_back(last_step(last, random));
  return made;
}

WorkCase altered(const WorkCase& of, Size size, Random& random) {
  WorkCase made = of;
  for (std::uint64_t changes = 1 + random.below(3); changes != 0; --changes) {
    std::vector<Step>& steps = made.steps;
    const std::size_t at = random.index(steps.size());
    const auto place = steps.begin() + static_cast<std::ptrdiff_t>(at);
    const std::uint64_t choice = random.below(12);
    if (choice < 3) {
      alter_number(steps.back(), made, random);
    } else if (choice < 9) {
      alter_number(steps[at], made, random);
    } else if (choice == 9 && at + 1 < steps.size()) {
      steps.erase(place);
    } else if (steps.size() < steps_most) {
      steps.insert(place, any_step(verbs_between[random.index(std::size(verbs_between))], random));
    }
  }
  for (Step& step : made.steps) keep_in_bounds(step, size);
  return made;
}

namespace {

bool drop_a_step(WorkCase& of, const std::function<bool(const WorkCase&)>& is_alike) {
  bool is_less = false;
  for (std::size_t i = 0; i + 1 < of.steps.size();) {
    WorkCase less = of;
    less.steps.erase(less.steps.begin() + static_cast<std::ptrdiff_t>(i));
    if (is_alike(less)) {
      of = less;
      is_less = true;
    } else {
      ++i;
    }
  }
  return is_less;
}

bool lower_a_number(WorkCase& of, const std::function<bool(const WorkCase&)>& is_alike) {
  bool is_lower = false;
  for (std::size_t i = 0; i < of.steps.size(); ++i) {
    for (std::size_t k = 0; k < numbers_of(of.steps[i].verb); ++k) {
      const std::int32_t number = of.steps[i].number[k];
      for (const std::int32_t less :
           {0, number / 2, number / 10 * 9, number - (number > 0) + (number < 0)}) {
        if (less == number) continue;
        WorkCase lower = of;
        lower.steps[i].number[k] = less;
        if (!is_alike(lower)) continue;
        of = lower;
        is_lower = true;
        break;
      }
    }
  }
  return is_lower;
}

}  // namespace

WorkCase smallest(WorkCase of, const std::function<bool(const WorkCase&)>& is_alike) {
  while (drop_a_step(of, is_alike) || lower_a_number(of, is_alike)) {
  }
  return of;
}

}  // namespace etcm::test

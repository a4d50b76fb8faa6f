#include "work_case.h"

#include <algorithm>
#include <charconv>
#include <iterator>
#include <system_error>

#include "etcm/traverse.h"
#include "inputs/random.h"

namespace etcm::test {
namespace {

struct Form {
  const char* name;
  std::size_t numbers;
};
constexpr Form forms[verb_count] = {
    {"node", 2},    {"row", 5},   {"ring", 4},    {"scatter", 5},      {"line", 2},
    {"leave", 1},   {"move", 3},  {"unline", 1},  {"canonicalize", 0}, {"optimise", 2},
    {"rebuild", 0}, {"build", 0}, {"restore", 0}, {"load", 0},
};

const Form& form_of(Verb verb) { return forms[static_cast<std::size_t>(verb)]; }

// A word, and what is behind it.
std::string_view take_word(std::string_view& text) {
  text.remove_prefix(std::min(text.find_first_not_of(' '), text.size()));
  const std::string_view word = text.substr(0, text.find(' '));
  text.remove_prefix(word.size());
  return word;
}

std::optional<Step> step_from(std::string_view text) {
  const std::string_view name = take_word(text);
  const auto* const form = std::find_if(std::begin(forms), std::end(forms),
                                        [&](const Form& f) { return f.name == name; });
  if (form == std::end(forms)) return std::nullopt;
  Step step{.verb = static_cast<Verb>(form - std::begin(forms)), .number = {}};
  for (std::size_t i = 0; i < form->numbers; ++i) {
    const std::string_view word = take_word(text);
    const char* const end = word.data() + word.size();
    const auto [behind, error] = std::from_chars(word.data(), end, step.number[i]);
    if (behind != end || error != std::errc{}) return std::nullopt;
  }
  return step;
}

// Of 25 x^2 + 25 y^2 = 25 * 65^2 those with whole x and y, by their angle.
std::vector<Position> circle_of_65() {
  std::vector<Position> upper;
  for (std::int32_t x = 65; x > -65; --x) {
    for (std::int32_t y = 0; y <= 65; ++y) {
      if (x * x + y * y == 65 * 65) upper.push_back({x, y});
    }
  }
  std::vector<Position> all = upper;
  for (const Position p : upper) all.push_back({-p.x, -p.y});
  return all;
}

std::int32_t bounded(std::int64_t value) {
  return static_cast<std::int32_t>(
      std::clamp<std::int64_t>(value, -std::int64_t{position_max}, position_max));
}

constexpr std::uint32_t steiner_room = 440;

MeshConfig stage_config() {
  MeshConfig config;
  config.vertices_max = stage_nodes + steiner_room;
  // A feature takes a place for each node that it runs through, more or less.
  config.features_max = 4 * stage_features + stage_nodes;
  return config;
}

}  // namespace

std::size_t numbers_of(Verb verb) { return form_of(verb).numbers; }
const char* name_of(Verb verb) { return form_of(verb).name; }

std::string to_text(const WorkCase& of) {
  std::string text;
  for (const Step& step : of.steps) {
    if (!text.empty()) text += ", ";
    text += name_of(step.verb);
    for (std::size_t i = 0; i < numbers_of(step.verb); ++i) {
      text += ' ';
      text += std::to_string(step.number[i]);
    }
  }
  return text;
}

std::optional<WorkCase> case_from(std::string_view text) {
  WorkCase read;
  while (!text.empty()) {
    const std::string_view part = text.substr(0, text.find(','));
    text.remove_prefix(std::min(part.size() + 1, text.size()));
    const std::optional<Step> step = step_from(part);
    if (!step) return std::nullopt;
    read.steps.push_back(*step);
  }
  if (read.steps.empty()) return std::nullopt;
  return read;
}

Stage::Stage() : storage_(storage_bytes(stage_config()) / sizeof(std::uint64_t) + 1) {
  static_cast<void>(mesh_.open(std::as_writable_bytes(std::span(storage_)), stage_config()));
}

// As if nothing had been: where a walk begins depends on what was.
void Stage::clear() {
  static_cast<void>(mesh_.open(std::as_writable_bytes(std::span(storage_)), stage_config()));
  look();
}

void Stage::look() {
  nodes_.clear();
  features_.clear();
  for (const VertexId v : nodes_of(mesh_)) nodes_.push_back(v);
  for (const FeatureId f : features_of(mesh_)) features_.push_back(f);
}

VertexId Stage::node(std::int32_t number) const {
  if (nodes_.empty()) return VertexId::none();
  return nodes_[static_cast<std::uint32_t>(number) % nodes_.size()];
}

FeatureId Stage::feature(std::int32_t number) const {
  if (features_.empty()) return FeatureId::none();
  return features_[static_cast<std::uint32_t>(number) % features_.size()];
}

void Stage::join(std::int32_t x, std::int32_t y) {
  VertexId id;
  if (mesh_.node_count() < stage_nodes) static_cast<void>(mesh_.join({x, y}, id));
}

void Stage::join_many(const Step& step) {
  const std::int32_t* const n = step.number;
  const std::int32_t count = std::clamp<std::int32_t>(n[0], 0, stage_nodes);
  if (step.verb == Verb::row) {
    for (std::int64_t i = 0; i < count; ++i)
      join(bounded(n[1] + i * n[3]), bounded(n[2] + i * n[4]));
    return;
  }
  if (step.verb == Verb::ring) {
    static const std::vector<Position> circle = circle_of_65();
    const auto all = static_cast<std::int32_t>(circle.size());
    for (std::int32_t i = 0; i < std::min(count, all); ++i) {
      const Position p = circle[static_cast<std::size_t>(i * all / std::min(count, all))];
      join(bounded(n[1] + std::int64_t{n[3]} * p.x), bounded(n[2] + std::int64_t{n[3]} * p.y));
    }
    return;
  }
  inputs::Random random(static_cast<std::uint32_t>(n[4]));
  const std::int32_t side = std::clamp(n[3], 1, position_max);
  for (std::int32_t i = 0; i < count; ++i) {
    const std::int32_t x = random.between(0, side);
    join(bounded(std::int64_t{n[1]} + x), bounded(std::int64_t{n[2]} + random.between(0, side)));
  }
}

Status Stage::call_of_nodes(const Step& step, Work limit) {
  const std::int32_t* const n = step.number;
  VertexId id;
  FeatureId feature_id;
  switch (step.verb) {
    case Verb::node:
      return mesh_.join({n[0], n[1]}, id, limit);
    case Verb::line:
      return mesh_.add_feature({node(n[0]), node(n[1])}, feature_id, limit);
    case Verb::leave:
      return mesh_.leave(node(n[0]), limit);
    case Verb::move:
      return mesh_.move(node(n[0]), {n[1], n[2]}, limit);
    default:
      return mesh_.remove_feature(feature(n[0]), limit);
  }
}

Status Stage::call(const Step& step, Work limit) {
  switch (step.verb) {
    case Verb::canonicalize:
      return mesh_.canonicalize(limit);
    case Verb::rebuild:
      return mesh_.rebuild(limit);
    case Verb::optimise:
      return mesh_.optimise(static_cast<std::uint32_t>(step.number[0]) % 16u,
                            static_cast<std::uint32_t>(step.number[1]), limit);
    case Verb::build:
      return mesh_.build(graph_.nodes, graph_.features, limit);
    case Verb::restore:
      return mesh_.restore(graph_.nodes, graph_.features, steiner_, limit);
    case Verb::load:
      return mesh_.load(saved_, limit);
    default:
      return call_of_nodes(step, limit);
  }
}

void Stage::do_step(const Step& step) {
  if (step.verb == Verb::row || step.verb == Verb::ring || step.verb == Verb::scatter) {
    join_many(step);
  } else if (step.verb == Verb::node) {
    join(step.number[0], step.number[1]);
  } else if (step.verb == Verb::line) {
    if (mesh_.feature_count() < stage_features) {
      static_cast<void>(call_of_nodes(step, Work::unlimited()));
    }
  } else if (step.verb < Verb::build) {
    static_cast<void>(call(step, Work::unlimited()));
  }
  look();
}

void Stage::prepare(const WorkCase& of) {
  clear();
  for (std::size_t i = 0; i + 1 < of.steps.size(); ++i) do_step(of.steps[i]);
  if (of.last().verb < Verb::build) return;
  graph_ = graph_of(mesh_);
  steiner_.clear();
  for (const VertexId v : steiner_vertices(mesh_)) {
    const auto at = std::find(features_.begin(), features_.end(), mesh_.feature_of(v));
    steiner_.push_back({static_cast<std::uint32_t>(at - features_.begin()), mesh_.point(v)});
  }
  saved_.resize(mesh_.saved_bytes());
  static_cast<void>(mesh_.save(saved_));
  clear();
}

void Stage::keep() { kept_ = storage_; }
void Stage::put_back() { std::copy(kept_.begin(), kept_.end(), storage_.begin()); }

}  // namespace etcm::test

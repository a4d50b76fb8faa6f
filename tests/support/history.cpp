#include "support/history.h"

#include <algorithm>
#include <array>
#include <iterator>
#include <utility>
#include <vector>

#include "etcm/audit.h"
#include "support/meshes.h"

namespace etcm::test {
namespace {

using testing::AssertionFailure;
using testing::AssertionResult;
using testing::AssertionSuccess;

int turn(Position a, Position b, Position c) {
  const std::int64_t cross = (std::int64_t{b.x} - a.x) * (std::int64_t{c.y} - a.y) -
                             (std::int64_t{b.y} - a.y) * (std::int64_t{c.x} - a.x);
  return (cross > 0) - (cross < 0);
}

bool is_inside(Position p, Position a, Position b) {
  return p != a && p != b && turn(a, b, p) == 0 && p.x >= std::min(a.x, b.x) &&
         p.x <= std::max(a.x, b.x) && p.y >= std::min(a.y, b.y) && p.y <= std::max(a.y, b.y);
}

// Features may meet where a node stands, and nowhere else.
Status relation(Position a, Position b, Position c, Position d,
                const std::map<VertexId, Position>& nodes) {
  if ((a == c && b == d) || (a == d && b == c)) return Status::repeated_feature;
  if (turn(a, b, c) == 0 && turn(a, b, d) == 0) {
    const bool overlap =
        is_inside(a, c, d) || is_inside(b, c, d) || is_inside(c, a, b) || is_inside(d, a, b);
    return overlap ? Status::overlapping_features : Status::ok;
  }
  if (turn(a, b, c) * turn(a, b, d) >= 0 || turn(c, d, a) * turn(c, d, b) >= 0) return Status::ok;
  const bool node_at_crossing = std::any_of(nodes.begin(), nodes.end(), [&](const auto& node) {
    return is_inside(node.second, a, b) && is_inside(node.second, c, d);
  });
  return node_at_crossing ? Status::ok : Status::crossing_features;
}

bool is_for_want_of_room(Status status) {
  constexpr std::array codes{Status::out_of_vertices, Status::out_of_features,
                             Status::steiner_budget, Status::work_limit, Status::grid_exhausted};
  return std::find(codes.begin(), codes.end(), status) != codes.end();
}

}  // namespace

History::Change History::next_change() {
  if (course_ == Course::eventful) {
    turn_the_tide();
    if (!std::exchange(is_begun_, true)) return clear_and_build();
    if (random_.below(mesh_.unresolved() != 0 ? 5 : 25) == 0) return make_anew();
  }
  if (is_ebbing_) return ebb();
  const std::uint64_t choice = random_.below(100);
  const std::size_t crowd = low_steps_ != 0 ? low_water_ : crowd_;
  const std::size_t joins = standing_.nodes.size() < crowd ? 45 : 10;
  if (standing_.nodes.empty() || choice < joins) return join();
  if (choice < 60) return leave();
  if (choice < 75) return move();
  return choice < 93 ? add_feature() : remove_feature();
}

void History::turn_the_tide() {
  if (low_steps_ != 0) --low_steps_;
  if (is_ebbing_ && standing_.nodes.empty()) {
    is_ebbing_ = false;
    low_water_ = random_.index(4);
    low_steps_ = random_.index(20);
  } else if (!standing_.nodes.empty() && low_steps_ == 0 && random_.below(100) == 0) {
    is_ebbing_ = true;
  }
}

History::Change History::ebb() {
  if (!standing_.features.empty()) return remove_feature();
  const Change change = leave();
  if (standing_.nodes.empty()) ++times_empty_;
  return change;
}

History::Change History::make_anew() {
  // Of what is not whole there is no other mesh.
  if (mesh_.unresolved() != 0) return clear_and_build();
  switch (random_.below(4)) {
    case 0:
      return rebuild();
    case 1:
      return clear_and_restore();
    default:
      return clear_and_build();
  }
}

AssertionResult History::step() {
  const Picture before = picture_of(mesh_);
  const bool was_whole = mesh_.unresolved() == 0;
  foretold_.reset();
  Change change = next_change();
  if (const AssertionResult told = was_foretold(change.answer); !told) {
    return AssertionFailure() << change.name << ": " << told.message();
  }
  if (!was_whole && !change.is_new) {
    change.expected = {Status::mesh_unresolved};
    change.may_lack_room = false;
  }
  const bool for_room = is_for_want_of_room(change.answer);
  if (for_room) ++refused_for_room_;
  if (mesh_.work_needed() > limit_) {
    return AssertionFailure() << change.name << " answered " << to_string(change.answer)
                              << " and took " << mesh_.work_needed().units << " of "
                              << limit_.units;
  }
  if (!change.expected.contains(change.answer) && !(for_room && change.may_lack_room)) {
    return AssertionFailure() << change.name << " answered " << to_string(change.answer) << ", not "
                              << testing::PrintToString(change.expected);
  }
  if (change.answer == Status::ok) return AssertionSuccess();
  if (!change.is_new && picture_of(mesh_) != before) {
    return AssertionFailure() << change.name << " was refused with " << to_string(change.answer)
                              << ", and changed the mesh";
  }
  if (const Audit sound = audit(mesh_); !sound) {
    return AssertionFailure() << change.name << " was refused with " << to_string(change.answer)
                              << ", and left a mesh with broken " << to_string(sound.broken);
  }
  return AssertionSuccess();
}

AssertionResult History::was_foretold(Status answer) const {
  if (left_a_trace_) return AssertionFailure() << "a dry run left a trace";
  if (!foretold_) return AssertionSuccess();
  const Outcome& foretold = *foretold_;
  // How far it is to the place of a change depends on where the last walk has ended.
  const bool is_limited = foretold.status == Status::work_limit || answer == Status::work_limit;
  if (work_bits_ != 0 && is_limited) return AssertionSuccess();
  const std::int64_t came = std::int64_t{mesh_.steiner_count()} - steiner_before_;
  if (foretold.status == answer && foretold.steiner == came) return AssertionSuccess();
  return AssertionFailure() << "a dry run foretold " << to_string(foretold.status) << " and "
                            << foretold.steiner << " more Steiner vertices, not "
                            << to_string(answer) << " and " << came;
}

AssertionResult History::agrees() const {
  const Picture picture = picture_of(mesh_);
  std::size_t nodes = 0;
  for (const Picture::Standing& vertex : picture.vertices) {
    if (vertex.kind != VertexKind::node) continue;
    ++nodes;
    const auto found = standing_.nodes.find(vertex.vertex);
    if (found == standing_.nodes.end() || to_point(found->second) != vertex.point) {
      return AssertionFailure() << "node " << vertex.vertex.value << " stands wrong";
    }
  }
  for (const Picture::Line& line : picture.features) {
    const auto found = standing_.features.find(line.feature);
    if (found == standing_.features.end() || found->second.from != line.from ||
        found->second.to != line.to) {
      return AssertionFailure() << "feature " << line.feature.value << " has wrong ends";
    }
  }
  if (nodes != standing_.nodes.size() || nodes != mesh_.node_count() ||
      picture.features.size() != standing_.features.size()) {
    return AssertionFailure() << "nodes or features are missing";
  }
  return AssertionSuccess();
}

History::Change History::join() {
  const Position position = random_position();
  VertexId id;
  const Work limit = limit_after([&](DryRun& dry, Work most) { return dry.join(position, most); });
  const Status answer = mesh_.join(position, id, limit);
  if (is_taken(position, VertexId::none()))
    return {"join", answer, {Status::duplicate_vertex}, true};
  if (answer == Status::ok) standing_.nodes[id] = position;
  return {"join", answer, {Status::ok}, true};
}

History::Change History::leave() {
  const VertexId node = random_node();
  Standing after = standing_;
  after.nodes.erase(node);
  const bool is_endpoint =
      std::any_of(standing_.features.begin(), standing_.features.end(),
                  [node](const auto& f) { return f.second.from == node || f.second.to == node; });
  const std::set<Status> expected =
      is_endpoint ? std::set{Status::endpoint_in_use} : faults_of(after);
  const Work limit = limit_after([&](DryRun& dry, Work most) { return dry.leave(node, most); });
  const Status answer = mesh_.leave(node, limit);
  if (answer == Status::ok) standing_ = std::move(after);
  return {"leave", answer, expected, !is_endpoint};
}

History::Change History::move() {
  const VertexId node = random_node();
  const Position position = random_position();
  Standing after = standing_;
  after.nodes[node] = position;
  const std::set<Status> expected =
      is_taken(position, node)
          // Without the node, features that met there may cross: then either word is right.
          ? std::set{Status::duplicate_vertex, Status::crossing_features}
          : faults_of(after);
  const Work limit =
      limit_after([&](DryRun& dry, Work most) { return dry.move(node, position, most); });
  const Status answer = mesh_.move(node, position, limit);
  if (answer == Status::ok) standing_ = std::move(after);
  return {"move", answer, expected, true};
}

History::Change History::add_feature() {
  const FeatureEnds ends{random_node(), random_node()};
  FeatureId id;
  const Work limit =
      limit_after([&](DryRun& dry, Work most) { return dry.add_feature(ends, most); });
  const Status answer = mesh_.add_feature(ends, id, limit);
  if (ends.from == ends.to) return {"add_feature", answer, {Status::zero_length_feature}};
  Standing after = standing_;
  after.features[FeatureId::none()] = ends;
  const std::set<Status> expected = faults_of(after);
  if (answer == Status::ok) standing_.features[id] = ends;
  return {"add_feature", answer, expected, true};
}

History::Change History::remove_feature() {
  if (standing_.features.empty()) {
    return {"remove_feature",
            mesh_.remove_feature(FeatureId{0}, next_limit()),
            {Status::unknown_feature}};
  }
  const auto chosen =
      std::next(standing_.features.begin(),
                static_cast<std::ptrdiff_t>(random_.below(standing_.features.size())));
  const Work limit =
      limit_after([&](DryRun& dry, Work most) { return dry.remove_feature(chosen->first, most); });
  const Status answer = mesh_.remove_feature(chosen->first, limit);
  if (answer == Status::ok) standing_.features.erase(chosen);
  return {"remove_feature", answer, {Status::ok}, work_bits_ != 0};
}

// Of as many nodes as usual, and of features that may be wrong.
History::Change History::clear_and_build() {
  Standing next;
  for (std::size_t count = random_.index(crowd_ + 2); count != 0; --count) {
    const Position position = random_position();
    const bool is_taken = std::any_of(next.nodes.begin(), next.nodes.end(),
                                      [&](const auto& node) { return node.second == position; });
    if (!is_taken) next.nodes[vertex_of(next.nodes.size())] = position;
  }
  const std::size_t ends = next.nodes.size();
  for (std::size_t count = ends < 2 ? 0 : random_.index(ends + 1); count != 0; --count) {
    const std::size_t from = random_.index(ends), to = (from + 1 + random_.index(ends - 1)) % ends;
    const FeatureId id{static_cast<IdValue>(next.features.size())};
    next.features[id] = {vertex_of(from), vertex_of(to)};
    // Seldom wrong, for what is wrong leaves nothing.
    if (faults_of(next) != std::set{Status::ok} && random_.below(8) != 0) next.features.erase(id);
  }
  std::vector<Position> nodes;
  for (const auto& node : next.nodes) nodes.push_back(node.second);
  std::vector<FeatureEnds> features;
  for (const auto& feature : next.features) features.push_back(feature.second);
  const std::set<Status> faults = faults_of(next);
  mesh_.clear();
  const Status answer = mesh_.build(nodes, features, next_limit());
  const bool is_incomplete = mesh_.unresolved() != 0;
  if (is_incomplete) ++times_incomplete_;
  if (is_incomplete && !is_for_want_of_room(answer)) {
    return {"build", Status::mesh_unresolved, faults, false, true};
  }
  standing_ = answer == Status::ok || is_incomplete ? std::move(next) : Standing{};
  if (mesh_.node_count() != standing_.nodes.size()) {
    return {"build", Status::mesh_not_empty, faults, false, true};
  }
  return {"build", answer, faults, true, true};
}

// The same mesh, by other ids.
History::Change History::clear_and_restore() {
  std::vector<Position> nodes;
  std::vector<FeatureEnds> features;
  std::vector<SteinerPlace> steiner;
  Standing next;
  std::map<VertexId, VertexId> renamed;
  for (const auto& [id, position] : standing_.nodes) {
    renamed[id] = vertex_of(nodes.size());
    next.nodes[renamed[id]] = position;
    nodes.push_back(position);
  }
  std::map<FeatureId, std::uint32_t> numbers;
  for (const auto& [id, ends] : standing_.features) {
    numbers[id] = static_cast<std::uint32_t>(features.size());
    features.push_back({renamed.at(ends.from), renamed.at(ends.to)});
    next.features[FeatureId{static_cast<IdValue>(numbers[id])}] = features.back();
  }
  for (const VertexId v : steiner_vertices(mesh_)) {
    steiner.push_back({numbers.at(mesh_.feature_of(v)), mesh_.point(v)});
  }
  const std::uint64_t hash = mesh_.hash();
  mesh_.clear();
  const Status answer = mesh_.restore(nodes, features, steiner, next_limit());
  if (answer != Status::ok) {
    standing_ = Standing{};
    return {"restore", answer, {Status::ok}, work_bits_ != 0, true};
  }
  standing_ = std::move(next);
  const bool is_same = mesh_.hash() == hash;
  return {"restore", is_same ? answer : Status::bad_coordinate, {Status::ok}, false, true};
}

History::Change History::rebuild() {
  return {"rebuild", mesh_.rebuild(next_limit()), {Status::ok}, true};
}

template <class Ask>
Work History::limit_after(Ask ask) {
  const Work limit = next_limit();
  steiner_before_ = mesh_.steiner_count();
  if (++changes_ % 2 == 0) return limit;
  const Picture before = picture_of(mesh_);
  const std::uint32_t vertex_end = mesh_.vertex_id_end(), feature_end = mesh_.feature_id_end();
  const Work work = mesh_.work_needed();
  const bool was_canonical = mesh_.is_canonical();
  DryRun dry(mesh_);
  foretold_ = ask(dry, limit);
  left_a_trace_ = picture_of(mesh_) != before || mesh_.vertex_id_end() != vertex_end ||
                  mesh_.feature_id_end() != feature_end || mesh_.work_needed() != work ||
                  mesh_.is_canonical() != was_canonical || foretold_->work > limit;
  return limit;
}

Work History::next_limit() {
  if (work_bits_ != 0) limit_ = Work{std::uint64_t{1} << random_.below(work_bits_ + 1)};
  return limit_;
}

Position History::random_position() {
  const std::int32_t x = random_.between(0, side_);
  return {x, random_.between(0, side_)};
}

VertexId History::random_node() {
  const auto index = static_cast<std::ptrdiff_t>(random_.below(standing_.nodes.size()));
  return std::next(standing_.nodes.begin(), index)->first;
}

bool History::is_taken(Position position, VertexId by_other_than) const {
  return std::any_of(standing_.nodes.begin(), standing_.nodes.end(), [&](const auto& node) {
    return node.second == position && node.first != by_other_than;
  });
}

std::set<Status> History::faults_of(const Standing& standing) {
  std::set<Status> faults;
  for (auto first = standing.features.begin(); first != standing.features.end(); ++first) {
    for (auto second = standing.features.begin(); second != first; ++second) {
      faults.insert(relation(standing.nodes.at(first->second.from),
                             standing.nodes.at(first->second.to),
                             standing.nodes.at(second->second.from),
                             standing.nodes.at(second->second.to), standing.nodes));
    }
  }
  if (faults.empty()) return {Status::ok};
  if (faults.size() > 1) faults.erase(Status::ok);
  return faults;
}

}  // namespace etcm::test

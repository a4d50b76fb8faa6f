#include "compare/systems/rival.h"

#include <algorithm>
#include <span>

#include "compare/systems/stopwatch.h"
#include "conforming/feasible_parameter.h"
#include "inputs/owned_mesh.h"

namespace etcm::compare {
namespace {

using namespace internal;

// A parameter counted from a segment's other end; its own inverse.
constexpr Parameter from_other_end(Parameter t) noexcept {
  return static_cast<Parameter>(parameter_end - t);
}

bool is_given_forth(const MeshState& m, SegmentId s) noexcept {
  return (m.segment(s).root & reversed_bit) == 0;
}

Position units_of(const Point& point) noexcept {
  return {static_cast<std::int32_t>(point.x / subunits_per_unit),
          static_cast<std::int32_t>(point.y / subunits_per_unit)};
}

// The subsegment between two vertices of a segment with none between them.
Subsegment subsegment_between(const MeshState& m, VertexId head, VertexId tail) noexcept {
  Subsegment subsegment;
  if (!m.topology.find_edge(head, tail, subsegment.edge)) return between(m, head, tail);
  subsegment.head = head;
  subsegment.tail = tail;
  subsegment.is_edge = true;
  return subsegment;
}

class Conformer {
 public:
  Conformer(Change& change, const RivalRule& rule)
      : change_(change), mesh_(change.mesh), rule_(rule) {}

  std::uint64_t looked_at() const noexcept { return looked_at_; }

  Status run() {
    for (SegmentId s = next_broken(); !s.is_none(); s = next_broken()) {
      const Status status = conform_segment(s);
      if (status != Status::ok) return status;
    }
    return Status::ok;
  }

 private:
  SegmentId next_broken() {
    if (rule_.broken_first == BrokenFirst::canonical) return change_.dirty.pop(mesh_);
    // Of those that one feature has broken the mesh keeps no order of time: the canonical one.
    for (SegmentId s = change_.dirty.pop(mesh_); !s.is_none(); s = change_.dirty.pop(mesh_)) {
      if (std::find(waiting_.begin(), waiting_.end(), s) == waiting_.end()) waiting_.push_back(s);
    }
    if (waiting_.empty()) return SegmentId::none();
    const SegmentId s = waiting_.back();
    waiting_.pop_back();
    return s;
  }

  // Walks the part of a segment that has been touched since it last was whole.
  Status conform_segment(SegmentId s) {
    SegmentRecord& r = mesh_.segment(s);
    const bool is_whole_touched = r.first.is_none();
    const VertexId low = is_whole_touched ? r.from : r.first;
    const VertexId high = is_whole_touched ? r.to : r.last;
    // What breaks next starts a range of its own.
    r.first = infinite_vertex;
    const bool forth = is_given_forth(mesh_, s);
    const VertexId end = forth ? r.to : r.from, last = forth ? high : low;
    for (VertexId v = forth ? low : high; v != last;) {
      const Subsegment subsegment = march(mesh_, v, end);
      const Status status = conform_subsegment(s, forth, subsegment);
      if (status != Status::ok) return status;
      v = subsegment.tail;
    }
    return Status::ok;
  }

  // Splits a subsegment until it is a run of edges. What is left always lies between two vertices
  // that are known, so nothing is walked again.
  Status conform_subsegment(SegmentId s, bool forth, Subsegment subsegment) {
    open_.clear();
    for (;;) {
      ++looked_at_;
      if (can_be_edge(mesh_, subsegment)) {
        static_cast<void>(constrain_subsegment(mesh_, subsegment));
      } else {
        const Status status = split(s, forth, subsegment);
        if (status != Status::ok) return status;
      }
      if (open_.empty()) return Status::ok;
      const Open next = open_.back();
      open_.pop_back();
      subsegment = subsegment_between(mesh_, next.head, next.tail);
    }
  }

  Status split(SegmentId s, bool forth, const Subsegment& subsegment) {
    const auto parameter = [&](VertexId v) {
      const Parameter t = parameter_of(mesh_, s, v);
      return forth ? t : from_other_end(t);
    };
    const MissingSubsegment missing{.mesh = &mesh_,
                                    .segment = s,
                                    .is_forth = forth,
                                    .subsegment = subsegment,
                                    .head = parameter(subsegment.head),
                                    .tail = parameter(subsegment.tail)};
    if (missing.tail - missing.head < 2) return Status::grid_exhausted;
    places_.clear();
    rule_.split(missing, places_);
    added_.clear();
    Parameter before = missing.head;
    for (Parameter t : places_) {
      t = std::clamp<Parameter>(t, missing.head + 1, missing.tail - 1);
      if (t <= before) continue;
      before = t;
      const Edge near =
          added_.empty()
              ? (t - missing.head <= missing.tail - t ? subsegment.head_edge : subsegment.tail_edge)
              : mesh_.topology.edge_at(added_.back());
      added_.push_back(insert_on_segment(change_, s, forth ? t : from_other_end(t), near));
      if (added_.back().is_none()) return Status::out_of_vertices;
    }
    // The part at the head is looked at first.
    VertexId tail = subsegment.tail;
    for (auto v = added_.rbegin(); v != added_.rend(); ++v) {
      open_.push_back({*v, tail});
      tail = *v;
    }
    open_.push_back({subsegment.head, tail});
    return Status::ok;
  }

  struct Open {
    VertexId head;
    VertexId tail;
  };

  Change& change_;
  MeshState& mesh_;
  const RivalRule& rule_;
  std::vector<SegmentId> waiting_;
  std::vector<Open> open_;
  std::vector<Parameter> places_;
  std::vector<VertexId> added_;
  std::uint64_t looked_at_ = 0;
};

Status insert_features(Change& change, std::span<const FeatureEnds> features, const RivalRule& rule,
                       std::uint64_t& looked_at) {
  MeshState& m = change.mesh;
  // All roots first, so that feature i has the id i.
  for (const FeatureEnds& ends : features) {
    const SegmentId root = allocate_segment(m);
    if (root.is_none()) return Status::out_of_features;
    set_ends(m, root, ends.from, ends.to);
    ++m.feature_count;
  }
  Conformer conformer(change, rule);
  for (std::size_t i = 0; i < features.size(); ++i) {
    const SegmentId root{static_cast<IdValue>(i)};
    const SurveyResult surveyed = survey(m, root);
    if (surveyed.status != Status::ok) return surveyed.status;
    link_feature(change, root, surveyed.nodes_between);
    for (SegmentId s = root; !s.is_none(); s = m.segment(s).next) make_dirty(change, s);
    const Status status = conformer.run();
    looked_at = conformer.looked_at();
    if (status != Status::ok) return status;
  }
  return rule.finish == nullptr ? Status::ok : rule.finish(change, rule);
}

}  // namespace

SplitSite MissingSubsegment::site() const noexcept {
  const MeshState& m = *mesh;
  const Topology& topo = m.topology;
  const SegmentRecord& r = m.segment(segment);
  SplitSite site;
  site.from = units_of(m.at(is_forth ? r.from : r.to));
  site.to = units_of(m.at(is_forth ? r.to : r.from));
  site.head = head;
  site.tail = tail;
  site.head_right = m.at(topo.origin(subsegment.head_edge));
  site.head_left = m.at(topo.target(subsegment.head_edge));
  site.tail_left = m.at(topo.origin(subsegment.tail_edge));
  site.tail_right = m.at(topo.target(subsegment.tail_edge));
  site.head_is_node = head == 0;
  site.tail_is_node = tail == parameter_end;
  site.feasible_head = feasible_from_head(site);
  site.feasible_tail = feasible_from_tail(site);
  site.mesh = m.mesh;
  site.head_triangle = TriangleId{Topology::triangle_of(subsegment.head_edge)};
  site.tail_triangle = TriangleId{Topology::triangle_of(subsegment.tail_edge)};
  return site;
}

Point MissingSubsegment::at(Parameter t) const noexcept {
  return point_at(*mesh, segment, is_forth ? t : from_other_end(t));
}

Attempt run_rival(const inputs::Graph& graph, const RivalRule& rule, Depth depth) {
  inputs::OwnedMesh mesh(inputs::config_for(graph, steiner_room(graph)));
  Attempt attempt;
  CpuStopwatch watch;
  Status status = mesh->build(graph.nodes, {});
  attempt.delaunay_us = watch.lap_us();
  MeshState& m = state_of(*mesh);
  Change change(m);
  if (status == Status::ok) {
    status = insert_features(change, graph.features, rule, attempt.looked_at);
  }
  attempt.total_us = attempt.delaunay_us + watch.lap_us();
  attempt.added = mesh->steiner_count();
  if (status != Status::ok) {
    attempt.verdict = Verdict::out_of_room;
    return attempt;
  }
  if (depth == Depth::times) return attempt;
  attempt.verdict = verdict_of(*mesh);
  attempt.hash = mesh->hash();
  attempt.image = files::image_of(*mesh, Exterior::hull, {});
  // Pruning looks where the mesh was touched: everywhere.
  for (IdValue i = 0; i < m.segment_end; ++i) {
    if (is_linked(m, SegmentId{i})) touch(change, SegmentId{i});
  }
  // Without a limit of the work nothing can fail.
  static_cast<void>(commit(change));
  attempt.added_after_pruning = mesh->steiner_count();
  return attempt;
}

Status conform_by(Change& change, const RivalRule& rule) { return Conformer(change, rule).run(); }

VertexId insert_on_segment(Change& change, SegmentId segment, Parameter parameter,
                           Edge near) noexcept {
  MeshState& m = change.mesh;
  const VertexId v = allocate_vertex(m);
  if (v.is_none()) return v;
  m.points[v.value] = point_at(m, segment, parameter);
  m.owner(v) = Owner(Role::fresh, segment);
  // There is no limit of the work.
  if (!insert_vertex(change, v, find(m, m.at(v), near))) return VertexId::none();
  ++m.steiner_count;
  ++change.fresh_count;
  return v;
}

Parameter middle_of(Parameter a, Parameter b) noexcept {
  const Parameter sum = a + b, below = sum / 2;
  return sum % 2 != 0 && below % 2 != 0 ? below + 1 : below;
}

void split_in_the_middle(const MissingSubsegment& missing, std::vector<Parameter>& places) {
  places.push_back(middle_of(missing.head, missing.tail));
}

}  // namespace etcm::compare

#include "firmware/mesh/feature_keeper.h"

#include <algorithm>
#include <map>
#include <utility>

#include "etcm/locate.h"
#include "firmware/logging/text_line.h"
#include "firmware/mesh/feature_reason.h"
#include "firmware/mesh/rejection_text.h"

namespace etcm::firmware {

namespace {

bool is_meeting(Status status) {
  return status == Status::repeated_feature || status == Status::overlapping_features ||
         status == Status::crossing_features;
}

}  // namespace

FeatureKeeper::FeatureKeeper(KeptMesh& kept, const NodeTable& nodes, const port::Clock& clock,
                             port::Log& log)
    : kept_(kept), nodes_(nodes), clock_(clock), log_(log) {
  lines_.resize(kept_.features().records().size());
  refused_.reserve(lines_.size());
}

// What was in the mesh and still is configured keeps its id; the rest is taken out.
void FeatureKeeper::replace(std::span<const FeatureSettings> features) {
  const auto ends_of = [](const FeatureSettings& feature) {
    return std::minmax({feature.from.key(), feature.to.key()});
  };
  Mesh& mesh = kept_.mesh();
  FeatureTable next(features, mesh.config().features_max);
  std::map<std::pair<std::uint64_t, std::uint64_t>, std::uint32_t> number_of;
  for (std::uint32_t number = 0; number < next.records().size(); ++number) {
    number_of.emplace(ends_of(next.records()[number].settings), number);
  }
  for (const FeatureRecord& record : kept_.features().records()) {
    if (!record.is_active()) continue;
    if (const auto found = number_of.find(ends_of(record.settings)); found != number_of.end()) {
      next.activate(found->second, record.id);
    } else {
      // An active feature is one the mesh has, so nothing can be wrong with its id.
      static_cast<void>(mesh.remove_feature(record.id));
    }
  }
  kept_.features() = std::move(next);
  lines_.resize(features.size());
  refused_.clear();
  refused_.reserve(features.size());
  is_due_ = true;
}

void FeatureKeeper::activate_at(const FeatureEnd& end) {
  const FeatureTable& features = kept_.features();
  for (const std::uint32_t number : features.ending_at(end)) {
    is_due_ = true;
    const FeatureRecord& record = features.records()[number];
    if (record.is_active() || record.rejection != Status::ok) continue;
    const FeatureEnds ends = ends_of(record);
    if (ends.from.is_none() || ends.to.is_none()) continue;
    FeatureId id;
    const Status status = kept_.mesh().add_feature(ends, id, kept_.work_limit());
    if (status == Status::ok) {
      put_in(number, id, ends);
    } else if (!is_meeting(status)) {
      reject(number, status);
    }
  }
}

void FeatureKeeper::remove_at(const FeatureEnd& end) {
  for (const std::uint32_t number : kept_.features().ending_at(end)) take_out(number);
}

void FeatureKeeper::note_place(Position place) {
  is_due_ = is_due_ || std::any_of(refused_.begin(), refused_.end(), [&](const FeatureLine& line) {
              return runs_through(line, place);
            });
}

bool FeatureKeeper::give_way() {
  const ErrorDetail& detail = kept_.mesh().error_detail();
  if (!is_meeting(detail.status) || detail.feature.is_none() || detail.other.is_none()) {
    return false;
  }
  const FeatureTable& features = kept_.features();
  take_out(std::max(features.number_of(detail.feature), features.number_of(detail.other)));
  return true;
}

// By increasing numbers: which come in depends on those before them, and only such give way.
void FeatureKeeper::settle() {
  if (!is_due_) return;
  refused_.clear();
  has_lines_ = false;
  const FeatureTable& features = kept_.features();
  for (std::uint32_t number = 0; number < features.records().size(); ++number) {
    const FeatureRecord& record = features.records()[number];
    if (record.is_active() || is_want_of_room(record.rejection)) continue;
    const FeatureEnds ends = ends_of(record);
    if (!ends.from.is_none() && !ends.to.is_none()) try_feature(number, ends);
  }
  is_due_ = false;
}

void FeatureKeeper::settle_all() {
  is_due_ = true;
  settle();
}

void FeatureKeeper::retry_for_room() {
  const FeatureTable& features = kept_.features();
  has_lines_ = false;
  for (std::uint32_t number = 0; number < features.records().size(); ++number) {
    if (features.rejected_count() == 0) break;
    const FeatureRecord& record = features.records()[number];
    if (!is_want_of_room(record.rejection) || record.rejected_epoch == kept_.epoch()) continue;
    const FeatureEnds ends = ends_of(record);
    if (ends.from.is_none() || ends.to.is_none()) continue;
    try_feature(number, ends);
    is_due_ = true;
  }
}

void FeatureKeeper::try_feature(std::uint32_t number, FeatureEnds ends) {
  FeatureId id;
  Status status = kept_.mesh().add_feature(ends, id, kept_.work_limit());
  if (is_meeting(status)) {
    const FeatureLine line = line_of(ends);
    std::optional<Blocker> blocker;
    if (const Status why = find_blocker(number, line, blocker); why != Status::ok) {
      refused_.push_back(line);
      return reject(number, why, blocker);
    }
  }
  // Whoever else is in its way has a greater number.
  while (is_meeting(status)) {
    const std::uint32_t other = kept_.features().number_of(kept_.mesh().error_detail().other);
    if (other < number) break;
    take_out(other);
    status = kept_.mesh().add_feature(ends, id, kept_.work_limit());
  }
  if (status == Status::ok) return put_in(number, id, ends);
  reject(number, status);
}

void FeatureKeeper::put_in(std::uint32_t number, FeatureId id, FeatureEnds ends) {
  kept_.features().activate(number, id);
  kept_.mark_changed();
  is_due_ = true;
  if (has_lines_) lines_[number] = line_of(ends);
}

void FeatureKeeper::take_out(std::uint32_t number) {
  FeatureTable& features = kept_.features();
  const FeatureRecord& record = features.records()[number];
  if (record.is_active()) {
    // An active feature is one the mesh has, so nothing can be wrong with its id.
    static_cast<void>(kept_.mesh().remove_feature(record.id));
    kept_.mark_changed();
    is_due_ = true;
  }
  features.deactivate(number);
  if (has_lines_) lines_[number] = {};
}

void FeatureKeeper::reject(std::uint32_t number, Status status,
                           const std::optional<Blocker>& blocker) {
  FeatureTable& features = kept_.features();
  const FeatureRecord& record = features.records()[number];
  const FeatureId other = kept_.mesh().error_detail().other;
  std::optional<Blocker> in_its_way = blocker;
  if (!blocker && !other.is_none()) in_its_way = Blocker{.number = features.number_of(other)};
  const bool is_news = record.rejection != status;
  if (is_news || record.blocker != in_its_way) kept_.mark_changed();
  features.reject(number, status, in_its_way, kept_.epoch(), clock_.now());
  if (!is_news) return;
  TextLine text;
  text << features.name(number) << " refused: ";
  const auto reason = reason_of(number, features.records(), nodes_, {});
  if (reason) {
    text << reason->what.view() << "; " << reason->cure.view();
  } else {
    write_rejection(text, kept_, nodes_, status);
  }
  log_.write(port::Level::warning, text);
}

// The first feature that keeps this one out, and why; ok: there is none.
Status FeatureKeeper::find_blocker(std::uint32_t number, const FeatureLine& line,
                                   std::optional<Blocker>& blocker) {
  if (!has_lines_) collect_lines();
  for (std::uint32_t before = 0; before < number; ++before) {
    const FeatureLine& other = lines_[before];
    if (other.from == other.to) continue;
    const Meeting meeting = meeting_of(line, other);
    if (meeting.status == Status::ok || can_meet(meeting)) continue;
    blocker = Blocker{.number = before, .near = meeting.near_crossing};
    return meeting.status;
  }
  return Status::ok;
}

// They cross, and a node stands there.
bool FeatureKeeper::can_meet(const Meeting& meeting) const {
  if (!meeting.crossing) return false;
  const Mesh& mesh = std::as_const(kept_).mesh();
  const Location there = locate(mesh, to_point(*meeting.crossing));
  return there.type == LocateType::on_vertex && mesh.kind(there.vertex) == VertexKind::node;
}

void FeatureKeeper::collect_lines() {
  has_lines_ = true;
  const Mesh& mesh = kept_.mesh();
  const std::span<const FeatureRecord> records = std::as_const(kept_).features().records();
  for (std::uint32_t number = 0; number < records.size(); ++number) {
    const FeatureId id = records[number].id;
    lines_[number] = id.is_none() ? FeatureLine{} : line_of(mesh.ends(id));
  }
}

FeatureLine FeatureKeeper::line_of(FeatureEnds ends) const {
  const Mesh& mesh = std::as_const(kept_).mesh();
  return {.from = mesh.position(ends.from), .to = mesh.position(ends.to)};
}

FeatureEnds FeatureKeeper::ends_of(const FeatureRecord& record) const {
  return {.from = vertex_at(record.settings.from), .to = vertex_at(record.settings.to)};
}

VertexId FeatureKeeper::vertex_at(const FeatureEnd& end) const {
  if (end.is_anchor) {
    const AnchorRecord* const anchor = std::as_const(kept_).anchors().find(end.position);
    return anchor == nullptr ? VertexId::none() : anchor->vertex;
  }
  const NodeRecord* const node = nodes_.find(end.serial);
  // One that is to leave, and could not, has none.
  return node == nullptr || node->leave_rejected ? VertexId::none() : node->vertex;
}

}  // namespace etcm::firmware

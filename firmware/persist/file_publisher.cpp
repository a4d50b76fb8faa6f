#include "firmware/persist/file_publisher.h"

#include <algorithm>
#include <utility>

namespace etcm::firmware {

namespace {

constexpr DiskMessages files_messages{
    .failed = "",
    .unresponsive = "files: the disk of `folder` of [files] does not answer; goes on without",
    .works_again = "files are written again"};

constexpr port::Duration first_pace = std::chrono::seconds(1);

}  // namespace

FilePublisher::FilePublisher(const Settings& settings, int share, port::MeshFiles& files,
                             const port::Clock& clock, port::Log& log)
    : share_(share),
      files_(files),
      clock_(clock),
      disk_(files_messages, settings.files->interval, log),
      imager_(settings),
      interval_(settings.files->interval),
      pace_(std::min(first_pace, interval_)) {
  // The folder, as long as there is no mesh.
  disk_.mark_dirty();
}

void FilePublisher::mark_dirty(const Snapshot& published) {
  if (!has_mesh_ && published.vertices.empty()) return;
  // The first one is not to wait for an interval: there is nothing in the folder yet.
  std::exchange(has_mesh_, true) ? disk_.mark_dirty() : disk_.mark_urgent();
}

port::Instant FilePublisher::next_deadline() const {
  return std::max(disk_.next_deadline(), not_before_);
}

void FilePublisher::update_settings(const FileSettings& settings) {
  interval_ = settings.interval;
  pace_ = std::min(pace_, interval_);
  disk_.set_interval(has_mesh_ ? pace_ : interval_);
}

void FilePublisher::write(const Snapshot& published, const ReadingSnapshot& readings,
                          const SitePlane& plane, port::Instant now) {
  if (disk_.next_deadline() == port::never) return;
  disk_.start(now);
  if (!has_mesh_) return files_.start_check();
  const port::Instant begin = clock_.now();
  files_.start_write(imager_.make(published, readings, plane));
  disk_.set_interval(pace_);
  pace_ = std::min(2 * pace_, interval_);
  not_before_ = now + share_ * (clock_.now() - begin);
}

}  // namespace etcm::firmware

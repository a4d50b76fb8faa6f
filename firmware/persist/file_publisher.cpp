#include "firmware/persist/file_publisher.h"

#include <algorithm>
#include <utility>

#include "firmware/logging/text_line.h"
#include "firmware/persist/disk_timeout.h"

namespace etcm::firmware {

FilePublisher::FilePublisher(const FileSettings& settings, const MeshConfig& mesh, int share,
                             port::MeshFiles& files, const port::Clock& clock, port::Log& log)
    : settings_(settings), share_(share), files_(files), clock_(clock), log_(log), imager_(mesh) {}

void FilePublisher::step(port::Instant now) {
  if (!is_writing_) return;
  port::DiskResult result;
  if (!files_.take_result(result)) {
    if (is_unresponsive_ || now - started_at_ < disk_timeout) return;
    is_unresponsive_ = true;
    log_.write(port::Level::error,
               "files: the disk of `folder` of [files] does not answer; goes on without");
    return;
  }
  is_writing_ = false;
  if (result.ok) {
    if (is_failing_ || is_unresponsive_) log_.write(port::Level::info, "files are written again");
  } else {
    (is_check_ ? is_unchecked_ : is_dirty_) = true;
    if (!is_failing_) {
      log_.write(port::Level::error, TextLine() << result.why << "; goes on, and tries again");
    }
  }
  is_failing_ = !result.ok;
  is_unresponsive_ = false;
}

port::Instant FilePublisher::next_deadline() const {
  // How a write went is heard soon enough in a step that something else asks for.
  if (is_writing_ || !(is_dirty_ || is_unchecked_)) return port::never;
  return std::max(started_at_ + settings_.interval, not_before_);
}

void FilePublisher::write(const Snapshot& published, port::Instant now) {
  if (is_writing_ || !(is_dirty_ || is_unchecked_)) return;
  started_at_ = now;
  is_writing_ = true;
  is_unchecked_ = false;
  is_check_ = !std::exchange(is_dirty_, false);
  if (is_check_) return files_.start_check();
  const port::Instant begin = clock_.now();
  files_.start_write(imager_.make(published));
  not_before_ = now + share_ * (clock_.now() - begin);
}

}  // namespace etcm::firmware

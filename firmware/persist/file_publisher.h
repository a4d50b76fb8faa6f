// Keeps the published files up to date: seldom enough, and whatever the disk does.
//
// They are due when there is a generation that they do not show, at the most once every interval.
// Before the first one it is seen whether they could be written. What fails is tried again an
// interval later; the log says so once, and when it works again. It also says when the disk has not
// answered for a while.
#pragma once

#include "etcm/config.h"
#include "etcm/port/clock.h"
#include "etcm/port/log.h"
#include "etcm/port/mesh_files.h"
#include "firmware/config/settings.h"
#include "firmware/publish/snapshot_image.h"

namespace etcm::firmware {

class FilePublisher {
 public:
  // All must outlive this, but `mesh`. At most one part in `share` of all time goes into handing a
  // mesh over: the loop stands still meanwhile. All the memory for that is taken here.
  FilePublisher(const FileSettings& settings, const MeshConfig& mesh, int share,
                port::MeshFiles& files, const port::Clock& clock, port::Log& log);

  // There is a generation that the files do not show.
  void mark_dirty() { is_dirty_ = true; }

  // Hears how the last write went. The caller then calls write() where is_due().
  void step(port::Instant now);
  bool is_due(port::Instant now) const { return next_deadline() <= now; }
  port::Instant next_deadline() const;

  // Starts to write the generation that was published last, unless something is under way or they
  // show it already. Only checks the folder where there is none yet.
  void write(const Snapshot& published, port::Instant now);

  // The last try failed, or the disk has not answered for a while.
  bool is_in_trouble() const { return is_failing_ || is_unresponsive_; }

 private:
  const FileSettings& settings_;
  const int share_;
  port::MeshFiles& files_;
  const port::Clock& clock_;
  port::Log& log_;
  SnapshotImager imager_;
  bool is_dirty_ = false;
  bool is_unchecked_ = true;
  bool is_writing_ = false;  // or checking
  bool is_check_ = false;
  bool is_failing_ = false;
  bool is_unresponsive_ = false;  // and the log was told
  port::Instant started_at_{};
  port::Instant not_before_{};
};

}  // namespace etcm::firmware

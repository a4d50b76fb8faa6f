// Keeps the published files up to date: seldom enough, and whatever the disk does (disk_writer.h).
//
// They are due when there is a generation that they do not show: after a start, when a mesh grows
// from a few nodes to all, a second after the first, then after two, four and so on up to the
// interval. Before the first one it is seen whether they could be written.
#pragma once

#include "etcm/port/clock.h"
#include "etcm/port/log.h"
#include "etcm/port/mesh_files.h"
#include "firmware/config/settings.h"
#include "firmware/persist/disk_writer.h"
#include "firmware/publish/snapshot_image.h"

namespace etcm::firmware {

class FilePublisher {
 public:
  // The ports must outlive this. At most one part in `share` of all time goes into handing a
  // mesh over: the loop stands still meanwhile. All the memory for that is taken here.
  // REQUIRES: the settings have [files].
  FilePublisher(const Settings& settings, int share, port::MeshFiles& files,
                const port::Clock& clock, port::Log& log);

  // There is a generation that the files do not show. As long as no mesh has had a vertex, those of
  // an earlier run stay.
  void mark_dirty(const Snapshot& published);
  // There are readings of a generation that they do not show.
  void mark_readings_dirty() {
    if (has_mesh_) disk_.mark_dirty();
  }

  // Hears how the last write went. The caller then calls write() where is_due().
  void step(port::Instant now) { static_cast<void>(disk_.hear(files_, now)); }
  bool is_due(port::Instant now) const { return next_deadline() <= now; }
  port::Instant next_deadline() const;
  void update_settings(const FileSettings& settings);

  // Starts to write the generation that was published last, unless something is under way or they
  // show it already. Only checks the folder as long as no mesh has had a vertex.
  void write(const Snapshot& published, const ReadingSnapshot& readings, const SitePlane& plane,
             port::Instant now);

  const DiskWriter& disk() const { return disk_; }

 private:
  const int share_;
  port::MeshFiles& files_;
  const port::Clock& clock_;
  DiskWriter disk_;
  SnapshotImager imager_;
  bool has_mesh_ = false;
  port::Duration interval_;  // at the most
  port::Duration pace_;      // the present one
  port::Instant not_before_{};
};

}  // namespace etcm::firmware

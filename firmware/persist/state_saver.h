// Keeps the state on the disk up to date: seldom enough for flash memory, and whatever the disk
// does (disk_writer.h).
//
// Generations go on upward after a restart. A state tells the first one that a restart may give
// out: beyond all that this gateway can publish before the next save.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "etcm/port/log.h"
#include "etcm/port/store.h"
#include "firmware/config/settings.h"
#include "firmware/persist/disk_writer.h"
#include "firmware/persist/saved_state.h"

namespace etcm::firmware {

class StateSaver {
 public:
  // `store` and `log` must outlive this. `pause` is the least time between two generations. All the
  // memory that saving needs is taken here.
  StateSaver(const Settings& settings, port::Duration pause, port::Store& store, port::Log& log);

  // The newest state that makes sense here; nothing where there is none. What makes none is set
  // aside, and the log says why.
  std::optional<SavedState> load();

  // There is a generation that is not saved.
  void mark_dirty() { disk_.mark_dirty(); }
  // What a person has been told is done must outlive a power failure.
  void mark_urgent() { disk_.mark_urgent(); }

  // There may be more to save than before.
  void update_settings(const Settings& settings) {
    writer_.set_room(saved_state_size_max(settings));
  }

  // Hears how the last save went. The caller then writes a state where is_due().
  void step(port::Instant now);
  bool is_due(port::Instant now) const { return disk_.is_due(now); }
  port::Instant next_deadline() const { return disk_.next_deadline(); }

  // To write with: begin(), then its add(), then save(). `time_of_day_s` may be 0: not known.
  StateWriter& begin(std::uint32_t generation, std::uint64_t mesh_hash,
                     std::int64_t time_of_day_s = 0);
  // Starts to save what was written, where it is anything new.
  void save(port::Instant now);

  // The gateway ends: the next state to be saved is the last one, whenever the one before was, and
  // a restart may go on with the very next generation. REQUIRES: no save is under way.
  void finish();

  const DiskWriter& disk() const { return disk_; }

 private:
  std::string judge(std::span<const std::byte> bytes, SavedState& state) const;

  const std::string folder_;
  std::vector<std::string> bus_names_;  // as they are saved
  port::Store& store_;
  port::Log& log_;
  DiskWriter disk_;
  StateWriter writer_;
  std::uint32_t generations_between_;  // two saves, at the most
  bool is_ending_ = false;
  std::uint32_t written_next_ = 0;  // of the state being written
  std::uint32_t written_generation_ = 0;
  std::uint64_t saving_content_ = 0;
  std::uint32_t saving_next_ = 0;
  std::uint64_t saved_content_ = 0;  // of the state on the disk, where saved_next_ is not 0
  std::uint32_t saved_next_ = 0;
};

}  // namespace etcm::firmware

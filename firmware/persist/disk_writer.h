// When something is written to a disk, and what is said of a disk that is full, gone or hangs.
//
// What has changed is written at the most once every interval. What fails is tried again an
// interval later; the log says so once for each reason, and when it works again. It also says when
// the disk has not answered for a while. Nothing waits for the disk.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>

#include "etcm/port/clock.h"
#include "etcm/port/disk_result.h"
#include "etcm/port/log.h"

namespace etcm::firmware {

// A disk that has not answered for so long is not slow but broken.
inline constexpr port::Duration disk_timeout = std::chrono::seconds(10);

// What the log says.
struct DiskMessages {
  const char* failed;        // before the reason, or empty
  const char* unresponsive;  // of the disk, and what follows from it
  const char* works_again;
};

class DiskWriter {
 public:
  // `messages` and `log` must outlive this.
  DiskWriter(const DiskMessages& messages, port::Duration interval, port::Log& log);

  void set_interval(port::Duration interval) { interval_ = interval; }

  // There is something to write.
  void mark_dirty() { is_dirty_ = true; }
  // So that it is due at once, whenever something was written before.
  void mark_urgent() { is_dirty_ = is_urgent_ = true; }
  // What was to be written stands on the disk already: as if it had been written.
  void skip(port::Instant now);
  // It is being written. REQUIRES: nothing is under way.
  void start(port::Instant now);

  enum class Heard : std::uint8_t { nothing, written, failed };
  // Hears how the last write went, of a port::Store or port::MeshFiles. What failed is dirty again.
  template <class Disk>
  Heard hear(Disk& disk, port::Instant now) {
    port::DiskResult result;
    if (disk.take_result(result)) return end(result);
    check_patience(now);
    return Heard::nothing;
  }

  bool is_due(port::Instant now) const { return next_deadline() <= now; }
  port::Instant next_deadline() const;
  bool is_under_way() const { return is_under_way_; }

  // Something was written in this run, and nothing is wrong since.
  bool works() const { return has_written_ && !is_in_trouble(); }
  // The last write failed.
  bool is_failing() const { return is_failing_; }
  // Or the disk has not answered for a while.
  bool is_in_trouble() const { return is_failing_ || is_unresponsive_; }
  // What is wrong with it then, for a person.
  std::string_view trouble() const {
    return is_unresponsive_ ? "the disk does not answer; look at it" : std::string_view(failure_);
  }

 private:
  Heard end(const port::DiskResult& result);
  void check_patience(port::Instant now);

  const DiskMessages& messages_;
  port::Duration interval_;
  port::Log& log_;
  bool is_dirty_ = false;
  bool has_written_ = false;
  bool is_urgent_ = true;
  bool is_under_way_ = false;
  bool is_unresponsive_ = false;  // and the log was told
  bool is_failing_ = false;
  port::Instant started_at_{};
  std::string failure_;  // what the log was told last; meaningful while failing
};

}  // namespace etcm::firmware

#include "firmware/alarms/alarm_keeper.h"

#include <algorithm>
#include <chrono>
#include <string>

#include "firmware/alarms/alarm_codec.h"

namespace etcm::firmware {

namespace {

constexpr port::Duration interval_min = std::chrono::minutes(1);

constexpr DiskMessages alarm_messages{
    .failed = "the alarms are not saved: ",
    .unresponsive =
        "alarms: the disk does not answer; a restart finds the alarms of an earlier moment",
    .works_again = "the alarms are saved again"};

}  // namespace

AlarmKeeper::AlarmKeeper(AlarmBook& book, port::Store& store, const port::WallClock& wall_clock,
                         port::Log& log)
    : book_(book),
      store_(store),
      wall_clock_(wall_clock),
      log_(log),
      disk_(alarm_messages, interval_min, log) {
  bytes_.reserve(saved_alarms_size_max);
}

void AlarmKeeper::restore(port::Instant now) {
  for (const port::Copy copy : {port::Copy::last, port::Copy::previous}) {
    const std::span<const std::byte> bytes = store_.load(copy);
    if (bytes.empty()) continue;
    AlarmBook read;
    const std::string wrong = decode_alarms(bytes, now, wall_clock_.milliseconds(), read);
    if (wrong.empty()) {
      book_ = std::move(read);
      break;
    }
    log_.write(port::Level::warning, std::string("alarms: what was saved is not used, ") + wrong +
                                         "; it is kept as " + std::string(store_.set_aside(copy)));
  }
  saved_events_ = book_.events_ever();
  // Whether what was wrong with this disk is over is known once something is written.
  for (std::uint32_t i = 0; i < book_.open_count(); ++i) {
    if (book_.open(i).key.kind == AlarmKind::disk_of_state) disk_.mark_dirty();
  }
}

void AlarmKeeper::step(port::Instant now) {
  if (disk_.hear(store_, now) == DiskWriter::Heard::failed) {
    disk_.set_interval(std::min(interval_, alarm_retry_max));
  }
  // New words alone are not worth a write: the next look finds them again.
  if (book_.events_ever() != saved_events_) disk_.mark_dirty();
  if (book_.acknowledged_ever() != saved_acknowledged_) disk_.mark_urgent();
  if (disk_.is_due(now) && !store_.is_saving()) save(now);
}

void AlarmKeeper::finish(port::Instant now) {
  if (store_.is_saving()) return;
  static_cast<void>(disk_.hear(store_, now));
  if (book_.events_ever() != saved_events_ || disk_.is_failing()) save(now);
}

void AlarmKeeper::save(port::Instant now) {
  encode_alarms(book_, now, wall_clock_.milliseconds(), bytes_);
  interval_ = std::max<port::Duration>(
      interval_min,
      std::chrono::seconds(static_cast<std::int64_t>(bytes_.size()) / alarm_bytes_per_s));
  disk_.set_interval(interval_);
  store_.start_save(bytes_);
  saved_events_ = book_.events_ever();
  saved_acknowledged_ = book_.acknowledged_ever();
  disk_.start(now);
}

}  // namespace etcm::firmware

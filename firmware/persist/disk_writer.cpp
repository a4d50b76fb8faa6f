#include "firmware/persist/disk_writer.h"

#include <utility>

#include "firmware/logging/text_line.h"

namespace etcm::firmware {

DiskWriter::DiskWriter(const DiskMessages& messages, port::Duration interval, port::Log& log)
    : messages_(messages), interval_(interval), log_(log) {
  failure_.reserve(sizeof(TextLine));
}

void DiskWriter::skip(port::Instant now) {
  started_at_ = now;
  is_dirty_ = is_urgent_ = false;
}

void DiskWriter::start(port::Instant now) {
  skip(now);
  is_under_way_ = true;
}

port::Instant DiskWriter::next_deadline() const {
  // How a write went is heard soon enough in a step that something else asks for.
  if (!is_dirty_ || is_under_way_) return port::never;
  return is_urgent_ ? port::Instant{} : started_at_ + interval_;
}

DiskWriter::Heard DiskWriter::end(const port::DiskResult& result) {
  is_under_way_ = false;
  const bool was_in_trouble = std::exchange(is_unresponsive_, false) || is_failing_;
  const bool was_failing = std::exchange(is_failing_, !result.ok);
  if (result.ok) {
    has_written_ = true;
    if (was_in_trouble) log_.write(port::Level::info, messages_.works_again);
    return Heard::written;
  }
  is_dirty_ = true;
  if (was_failing && result.why == failure_) return Heard::failed;
  failure_ = result.why;
  log_.write(port::Level::error,
             TextLine() << messages_.failed << failure_ << "; goes on, and tries again");
  return Heard::failed;
}

void DiskWriter::check_patience(port::Instant now) {
  if (!is_under_way_ || is_unresponsive_ || now - started_at_ < disk_timeout) return;
  is_unresponsive_ = true;
  log_.write(port::Level::error, messages_.unresponsive);
}

}  // namespace etcm::firmware

// A disk in simulated time that outlives the gateway: slow, full, hanging, and cut off in the
// middle of a save. Then it has the old bytes or the new ones, as port::Store promises.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "device.h"
#include "etcm/port/mesh_files.h"
#include "etcm/port/store.h"
#include "etcm/port/wall_clock.h"

namespace etcm::simulation {

class DiskWorld final : public port::Store {
 public:
  explicit DiskWorld(inputs::Random& random) : random_(random) {}

  std::span<const std::byte> load(port::Copy copy) override {
    return copy == port::Copy::last ? last_ : previous_;
  }
  std::string_view set_aside(port::Copy copy) override {
    ++set_asides;
    (copy == port::Copy::last ? last_ : previous_).clear();
    return "aside";
  }
  void start_save(std::span<const std::byte> bytes) override {
    coming_.assign(bytes.begin(), bytes.end());
    is_under_way_ = true;
    done_at_ = now_ + std::chrono::milliseconds(5 + random_.below(200));
  }
  bool is_saving() const override { return is_under_way_ && (hangs || now_ < done_at_); }
  bool take_result(port::DiskResult& result) override {
    if (!is_under_way_ || is_saving()) return false;
    is_under_way_ = false;
    result = {.ok = !is_full, .why = is_full ? "the disk is full" : ""};
    if (is_full) {
      is_behind_ = true;
    } else {
      take_in();
    }
    return true;
  }

  void pass_to(Instant now) { now_ = now; }
  // Whoever was saving waits for it, as far as there is something to wait for.
  void wait() {
    if (!is_under_way_ || hangs || is_full) return;
    is_under_way_ = false;
    take_in();
  }
  Instant next() const {
    return is_under_way_ && !hangs && done_at_ > now_ ? done_at_ : port::never;
  }
  // Whoever was saving is gone. What a run has published before its first save has ended may be
  // published by the next one too.
  void lose_power() {
    is_behind_ = is_behind_ || !has_taken_in_ || (is_under_way_ && (hangs || is_full));
    // In the middle of putting the new one in its place only the old one is left, as the one
    // before.
    if (is_under_way_ && !is_full && !last_.empty() && random_.below(4) == 0) {
      previous_ = std::move(last_);
      last_.clear();
    } else if (is_under_way_ && !is_full && random_.below(2) == 0) {
      take_in();
    }
    // It hung with what was to be saved long ago.
    is_behind_ = is_behind_ || (is_under_way_ && hangs);
    has_taken_in_ = false;
    is_under_way_ = false;
  }
  void lose_all() {
    last_.clear();
    previous_.clear();
    is_behind_ = true;
  }
  // It has not what the gateway has tried to save.
  bool is_behind() const { return is_behind_; }
  // It has what was to be saved last.
  bool has_all() const { return !is_behind_ && !is_under_way_; }
  // When something was saved last.
  Instant saved_at() const { return saved_at_; }

  bool hangs = false;
  bool is_full = false;
  std::size_t set_asides = 0;

 private:
  void take_in() {
    previous_ = std::move(last_);
    last_ = coming_;
    is_behind_ = false;
    has_taken_in_ = true;
    saved_at_ = now_;
  }

  inputs::Random& random_;
  Instant now_{};
  bool is_under_way_ = false;
  bool is_behind_ = false;
  bool has_taken_in_ = false;  // in this run
  Instant done_at_{};
  Instant saved_at_{};
  std::vector<std::byte> coming_;
  std::vector<std::byte> last_;
  std::vector<std::byte> previous_;
};

// Where the files of the mesh go.
class FolderWorld final : public port::MeshFiles {
 public:
  void start_check() override { has_news_ = true; }
  void start_write(std::shared_ptr<const files::MeshImage> image) override {
    image_ = std::move(image);
    has_news_ = true;
  }
  bool take_result(port::DiskResult& result) override {
    if (!has_news_ || hangs) return false;
    has_news_ = false;
    image_.reset();
    result = {.ok = !is_full, .why = is_full ? "the disk is full" : ""};
    return true;
  }

  bool hangs = false;
  bool is_full = false;

 private:
  bool has_news_ = false;
  std::shared_ptr<const files::MeshImage> image_;
};

// The time of day, which somebody sets now and then.
class WallClockWorld final : public port::WallClock {
 public:
  explicit WallClockWorld(const port::Clock& clock) : clock_(clock) {}
  std::int64_t milliseconds() const override {
    return 1'800'000'000'000 + offset_ms +
           clock_.now().time_since_epoch() / std::chrono::milliseconds(1);
  }
  std::int64_t offset_ms = 0;

 private:
  const port::Clock& clock_;
};

}  // namespace etcm::simulation

// The page of a gateway, read as a browser reads it: a piece at a time.
#pragma once

#include <gtest/gtest.h>

#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "fakes.h"
#include "firmware/status/status_page.h"

namespace etcm::firmware {

// A base beside the one that has the rig, and behind it.
class PageReader {
 protected:
  // `rig` must outlive it. Its log is heard from here on.
  explicit PageReader(Rig& rig)
      : rig_of_page_(rig), events_(rig.clock, rig.log), wall_clock_(rig.clock) {}

  // The gateway must have been started.
  void make_page() {
    sources_.emplace(StatusSources{.gateway = *rig_of_page_.gateway,
                                   .events = events_,
                                   .alarms = alarms_,
                                   .wall_clock = wall_clock_,
                                   .masters = masters_,
                                   .readers = readers_,
                                   .version = "1.2.3",
                                   .started_at = rig_of_page_.clock.now()});
    page_.emplace(*sources_, 4);
  }
  // What is left of what this reader has begun, so many bytes at a time.
  std::string rest(std::size_t reader, std::size_t piece = 7) {
    std::string text;
    std::vector<char> out(piece);
    while (const std::size_t size = page_->read(reader, out)) text.append(out.data(), size);
    page_->end(reader);
    return text;
  }
  std::string get(const std::string& path, std::size_t piece = 7) {
    answer_ = page_->begin(0, path);
    return rest(0, piece);
  }

  Rig& rig_of_page_;
  RecentEvents events_;
  AlarmBook alarms_;
  FollowingWallClock wall_clock_;
  port::ServiceCounters masters_;
  port::ServiceCounters readers_;
  std::optional<StatusSources> sources_;
  std::optional<StatusPage> page_;
  port::WebAnswer answer_;  // to the last get()
};

class RigTest : public testing::Test {
 protected:
  explicit RigTest(std::vector<FeatureSettings> features = {}) : rig_(std::move(features)) {}
  Rig rig_;
};

}  // namespace etcm::firmware

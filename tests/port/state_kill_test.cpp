// A save that is killed at any of its system calls leaves the old state or the new one, in `state`
// itself.
#include <gtest/gtest.h>
#include <sys/syscall.h>
#include <unistd.h>

#include <cerrno>
#include <cstdlib>
#include <filesystem>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "state_kept.h"
#include "support/killed_process.h"
#include "support/scratch_folder.h"

namespace etcm::port {
namespace {

using test::ScratchFolder;

using test::forbid_call;
using test::run_killed_at;
using test::to_the_end;
using test::Traced;

class KilledSave : public testing::Test {
 protected:
  void SetUp() override {
    if (!run_killed_at(to_the_end, [] {}).can_trace) {
      GTEST_SKIP() << "processes cannot be traced here (an emulator?)";
    }
    // What a killed process leaves is the same on any disk, and some need long for a sync.
    if (std::filesystem::is_directory("/dev/shm")) ::setenv("TMPDIR", "/dev/shm", 1);
  }

  // Prepares a folder, saves "new", killed at every stop; the folder then has `old` or "new", can
  // be saved to, and a second save killed at every stop leaves one of what was there and "newer".
  void expect_survival(const std::function<void(const std::string&)>& prepare,
                       const std::string& old, bool killed_twice) {
    const unsigned long stops = attempt(prepare, to_the_end).stops;
    ASSERT_GT(stops, 10u);
    unsigned long kills = 0;
    bool seen_old = false, seen_new = false;
    for (unsigned long stop = 0; stop < stops; ++stop) {
      SCOPED_TRACE(testing::Message() << "killed at stop " << stop << " of " << stops);
      kills += attempt(prepare, stop).was_killed;
      ASSERT_TRUE(old.empty() || !keeps_last_ || is_last_sound()) << "there is no `state`";
      const std::string first = found_in(folder_->path("s"));
      ASSERT_TRUE(first == old || first == text_) << '"' << first << '"';
      (first == old ? seen_old : seen_new) = true;
      for (unsigned long again = 0; killed_twice; ++again) {
        attempt(prepare, stop);
        const Traced second = save_killed_at(again, "newer");
        ASSERT_TRUE(!keeps_last_ || first.empty() || is_last_sound()) << "again at " << again;
        const std::string found = found_in(folder_->path("s"));
        ASSERT_TRUE(found == first || found == "newer") << '"' << found << "\", again at " << again;
        if (!second.was_killed) break;
      }
      ASSERT_TRUE(save_in(folder_->path("s"), "last"));
      ASSERT_EQ(found_in(folder_->path("s")), "last");
      ASSERT_FALSE(std::filesystem::exists(folder_->path("s/state.new")));
      ASSERT_FALSE(std::filesystem::exists(folder_->path("s/state.refused-1")));
    }
    EXPECT_EQ(kills, stops);
    EXPECT_TRUE(seen_old);
    EXPECT_TRUE(seen_new);
  }

  Traced attempt(const std::function<void(const std::string&)>& prepare, unsigned long kill_at) {
    folder_ = std::make_unique<ScratchFolder>();
    prepare(folder_->path("s"));
    return save_killed_at(kill_at, text_);
  }

  Traced save_killed_at(unsigned long kill_at, const std::string& text) {
    // Everything the process does by itself is done before.
    StateFile file(folder_->path("s"));
    const std::vector<std::byte> bytes = bytes_of(text);
    const bool has_links = has_links_;
    return run_killed_at(kill_at, [&bytes, &file, has_links] {
      if (!has_links) forbid_call(SYS_linkat, EPERM);
      static_cast<void>(file.save(bytes));
    });
  }

  // By its own name: others read it too, while the gateway runs.
  bool is_last_sound() const {
    std::vector<std::byte> bytes;
    std::string why;
    return StateFile(folder_->path("s")).load(Copy::last, bytes, why) == StateFile::Found::sound;
  }

  bool has_links_ = true;   // the disk
  bool keeps_last_ = true;  // it was there when the save began, and links keep it there
  std::unique_ptr<ScratchFolder> folder_;
  std::string text_ = "new";
};

TEST_F(KilledSave, TheFirstOfAll) {
  expect_survival([](const std::string&) {}, "", false);
}

TEST_F(KilledSave, TheSecond) {
  expect_survival([](const std::string& folder) { save_in(folder, "old"); }, "old", true);
}

TEST_F(KilledSave, ALaterOne) {
  expect_survival(
      [](const std::string& folder) {
        save_in(folder, "oldest");
        save_in(folder, "old");
      },
      "old", true);
}

TEST_F(KilledSave, OfMoreThanOnePage) {
  text_ = std::string(100'000, 'n');
  expect_survival(
      [](const std::string& folder) {
        save_in(folder, std::string(50'000, 'p'));
        save_in(folder, "old");
      },
      "old", false);
}

// Such as vfat. There a moment has `state.previous` alone, which the next start takes.
TEST_F(KilledSave, OnADiskWithoutLinks) {
  has_links_ = keeps_last_ = false;
  expect_survival(
      [](const std::string& folder) {
        save_in(folder, "oldest");
        save_in(folder, "old");
      },
      "old", false);
}

TEST_F(KilledSave, ThatFindsThePreviousAlone) {
  keeps_last_ = false;
  expect_survival(
      [](const std::string& folder) {
        save_in(folder, "old");
        std::filesystem::rename(folder + "/state", folder + "/state.previous");
      },
      "old", true);
}

// That the old state or the new one is there after a power failure too is the order of things: the
// new file is on the disk before it has the name, and the name is before the save has ended.
TEST_F(KilledSave, SyncsBeforeItRenamesAndAfterwards) {
  const Traced traced =
      attempt([](const std::string& folder) { save_in(folder, "old"); }, to_the_end);
  std::string order;
  for (const long call : traced.calls) {
    if (call == SYS_write) order += "w";
    if (call == SYS_fsync) order += "s";
    if (call == SYS_linkat) order += "l";
    if (call == SYS_renameat || call == SYS_renameat2) order += "r";
  }
  EXPECT_EQ(order, "wwslrs");
}

}  // namespace
}  // namespace etcm::port

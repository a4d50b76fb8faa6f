// StateFile: what it writes, and that nothing else is ever taken for it or lost.
#include "posix/state_file.h"

#include <gtest/gtest.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <csignal>
#include <filesystem>
#include <string>

#include "mounted_disk.h"
#include "state_kept.h"
#include "support/scratch_folder.h"

namespace etcm::port {
namespace {

using test::ScratchFolder;

StateFile::Found look(const std::string& folder, Copy copy, std::string* why = nullptr) {
  std::vector<std::byte> bytes;
  std::string reason;
  const StateFile::Found found = StateFile(folder).load(copy, bytes, reason);
  if (why != nullptr) *why = reason;
  return found;
}

TEST(StateFile, KeepsTheLastTwoSaves) {
  const ScratchFolder scratch;
  const std::string folder = scratch.path("a/b/state");
  EXPECT_EQ(look(folder, Copy::last), StateFile::Found::nothing);
  EXPECT_FALSE(std::filesystem::exists(scratch.path("a"))) << "looking makes nothing";
  for (const char* text : {"one", "two", "", "four"}) {
    ASSERT_TRUE(save_in(folder, text));
    EXPECT_EQ(found_in(folder), text);
  }
  std::filesystem::remove(folder + "/state");
  EXPECT_EQ(found_in(folder), "") << "the third was empty";
  ASSERT_TRUE(save_in(folder, "five"));
  std::filesystem::rename(folder + "/state", folder + "/state.previous");
  EXPECT_EQ(found_in(folder), "five");
}

// By an implementation of its own, a bit at a time.
std::uint32_t crc32_of(const std::string& text) {
  std::uint32_t sum = ~0u;
  for (const char c : text) {
    sum ^= static_cast<unsigned char>(c);
    for (int bit = 0; bit < 8; ++bit) sum = (sum & 1u) != 0 ? sum >> 1 ^ 0xedb88320u : sum >> 1;
  }
  return ~sum;
}

TEST(StateFile, IsWrittenAsItsHeaderSays) {
  const ScratchFolder scratch;
  ASSERT_TRUE(save_in(scratch.path("s"), "123456789"));
  const std::string file = scratch.read("s/state");
  ASSERT_EQ(file.size(), state_head_size + 9);
  EXPECT_EQ(file.substr(0, 12), std::string("ETCMKEPT\1\0\0\0", 12));
  EXPECT_EQ(file.substr(16), std::string("\11\0\0\0\0\0\0\0", 8) + "123456789");
  EXPECT_EQ(crc32_of("123456789"), 0xcbf43926u) << "the check value of CRC-32";
  const std::uint32_t sum = crc32_of(file.substr(0, 12) + file.substr(16));
  for (unsigned i = 0; i < 4; ++i) {
    EXPECT_EQ(static_cast<unsigned char>(file[12 + i]), sum >> (8 * i) & 0xff) << i;
  }
}

class DamagedState : public testing::Test {
 protected:
  DamagedState() {
    EXPECT_TRUE(save_in(folder_, "the old one"));
    EXPECT_TRUE(save_in(folder_, "the new one"));
    sound_ = scratch_.read("s/state");
  }
  // The previous copy takes over, and what was damaged is still there for a person to look at.
  void expect_refused(const std::string& damaged) {
    scratch_.write("s/state", damaged);
    ASSERT_EQ(found_in(folder_), "the old one");
    ASSERT_EQ(scratch_.read("s/state.refused-1"), damaged);
    std::filesystem::remove(scratch_.path("s/state.refused-1"));
  }
  const ScratchFolder scratch_;
  const std::string folder_ = scratch_.path("s");
  std::string sound_;
};

TEST_F(DamagedState, WithAnyBitTurnedIsRefused) {
  for (std::size_t i = 0; i < sound_.size() * 8; ++i) {
    SCOPED_TRACE(i);
    std::string damaged = sound_;
    damaged[i / 8] = static_cast<char>(damaged[i / 8] ^ 1 << i % 8);
    expect_refused(damaged);
  }
}

TEST_F(DamagedState, CutOffAnywhereIsRefused) {
  for (std::size_t size = 0; size < sound_.size(); ++size) {
    SCOPED_TRACE(size);
    expect_refused(sound_.substr(0, size));
  }
}

TEST_F(DamagedState, WithAnythingBehindIsRefused) {
  expect_refused(sound_ + '\0');
  expect_refused(sound_ + sound_);
}

TEST_F(DamagedState, OfBytesWithoutSenseIsRefused) {
  expect_refused(std::string(10'000, '\0'));
  expect_refused("#!/bin/sh\necho not a state at all, but longer than a head\n");
  std::string huge = sound_;
  huge.replace(16, 8, std::string(8, '\x7f'));
  expect_refused(huge);
}

TEST_F(DamagedState, ThatIsHugeIsRefusedWithoutReadingIt) {
  if (sizeof(off_t) < 8) GTEST_SKIP() << "no file is that long here";
  scratch_.write("s/state", sound_);
  std::filesystem::resize_file(scratch_.path("s/state"), std::uintmax_t{1} << 40);
  EXPECT_EQ(found_in(folder_), "the old one");
  EXPECT_EQ(std::filesystem::file_size(scratch_.path("s/state.refused-1")),
            std::uintmax_t{1} << 40);
}

TEST_F(DamagedState, ThatIsNoFileIsRefused) {
  std::filesystem::remove(scratch_.path("s/state"));
  ASSERT_EQ(::mkfifo(scratch_.path("s/state").c_str(), 0600), 0);
  EXPECT_EQ(found_in(folder_), "the old one");
  std::filesystem::create_directory(scratch_.path("s/state"));
  EXPECT_EQ(found_in(folder_), "the old one");
  EXPECT_TRUE(std::filesystem::is_directory(scratch_.path("s/state.refused-2")));
  EXPECT_TRUE(save_in(folder_, "goes on"));
  EXPECT_EQ(found_in(folder_), "goes on");
}

TEST_F(DamagedState, InBothCopiesLeavesNothingAndBothStay) {
  scratch_.write("s/state", "x");
  scratch_.write("s/state.previous", "y");
  EXPECT_EQ(found_in(folder_), "");
  EXPECT_EQ(scratch_.read("s/state.refused-1"), "x");
  EXPECT_EQ(scratch_.read("s/state.refused-2"), "y");
}

TEST_F(DamagedState, IsNotSavedOverEvenWhereItCouldNotBeMovedAtOnce) {
  const std::string away = scratch_.path("away");
  StateFile file(folder_);
  scratch_.write("s/state", "damaged");
  std::filesystem::rename(folder_, away);
  EXPECT_EQ(file.set_aside(Copy::last), "state") << "its folder is not there";
  std::filesystem::rename(away, folder_);
  EXPECT_EQ(file.save(bytes_of("next")).action, nullptr);
  EXPECT_EQ(scratch_.read("s/state.refused-1"), "damaged");
  EXPECT_EQ(scratch_.read("s/state").substr(state_head_size), "next");
}

TEST(StateFile, LeavesAloneWhatAnotherGatewayKeeps) {
  const ScratchFolder scratch;
  StateFile first(scratch.path("s"));
  ASSERT_EQ(first.save(bytes_of("mine")).action, nullptr);
  StateFile second(scratch.path("s"));
  const StateFile::Failure failure = second.save(bytes_of("yours"));
  ASSERT_NE(failure.action, nullptr);
  EXPECT_EQ(failure.error, EWOULDBLOCK);
  EXPECT_EQ(scratch.read("s/state").substr(state_head_size), "mine");
  ASSERT_EQ(first.save(bytes_of("mine still")).action, nullptr);
}

// Whatever stops a save, what was kept stays, nothing of the attempt is left, and the next works.
class SaveThatFails : public testing::Test {
 protected:
  void prepare() {
    ASSERT_EQ(file_.save(bytes_of("older")).action, nullptr);
    ASSERT_EQ(file_.save(bytes_of("old")).action, nullptr);
  }
  void expect_failure(std::initializer_list<int> errors, const std::string& text = "new") {
    for (int attempt = 0; attempt < 3; ++attempt) {
      const StateFile::Failure failure = file_.save(bytes_of(text));
      ASSERT_NE(failure.action, nullptr);
      EXPECT_NE(std::find(errors.begin(), errors.end(), failure.error), errors.end())
          << failure.action << ": " << failure.error;
      EXPECT_FALSE(std::filesystem::exists(folder_ + "/state.new"));
    }
  }
  void expect_goes_on() {
    EXPECT_EQ(file_.save(bytes_of("newer")).action, nullptr);
    std::filesystem::copy_file(folder_ + "/state", scratch_.path("last"));
    EXPECT_EQ(scratch_.read("last").substr(state_head_size), "newer");
  }
  const ScratchFolder scratch_;
  const std::string folder_ = scratch_.path("s");
  StateFile file_{folder_};
};

TEST_F(SaveThatFails, BecauseAFileMustNotBecomeThatLong) {
  prepare();
  ::signal(SIGXFSZ, SIG_IGN);
  rlimit before{};
  ::getrlimit(RLIMIT_FSIZE, &before);
  for (const rlim_t limit : {0u, 10u, 24u, 1000u}) {
    const rlimit tight{.rlim_cur = limit, .rlim_max = before.rlim_max};
    ::setrlimit(RLIMIT_FSIZE, &tight);
    const std::string long_text(1000, 'x');
    expect_failure({EFBIG}, long_text);
    ::setrlimit(RLIMIT_FSIZE, &before);
    EXPECT_EQ(scratch_.read("s/state").substr(state_head_size), "old");
  }
  expect_goes_on();
}

TEST_F(SaveThatFails, BecauseTheDiskIsFull) {
  const MountedDisk disk(folder_);
  if (!disk.is_mounted) GTEST_SKIP() << "needs the right to mount a small disk";
  prepare();
  expect_failure({ENOSPC}, std::string(80'000, 'x'));
  scratch_.write("s/filler", std::string(80'000, 'x'));
  expect_failure({ENOSPC});
  EXPECT_EQ(scratch_.read("s/state").substr(state_head_size), "old");
  std::filesystem::remove(folder_ + "/filler");
  expect_goes_on();
}

TEST_F(SaveThatFails, BecauseTheDiskIsReadOnly) {
  MountedDisk disk(folder_);
  if (!disk.is_mounted) GTEST_SKIP() << "needs the right to mount a small disk";
  prepare();
  // A folder that is held open for writing keeps no file open, so this works.
  ASSERT_TRUE(disk.remount(MS_RDONLY));
  expect_failure({EROFS});
  EXPECT_EQ(scratch_.read("s/state").substr(state_head_size), "old");
  ASSERT_TRUE(disk.remount(0));
  expect_goes_on();
}

TEST_F(SaveThatFails, BecauseItMayNotWriteThere) {
  prepare();
  // Root may write anywhere.
  const bool is_root = ::geteuid() == 0;
  ::chmod(scratch_.path("").c_str(), 0755);
  ::chmod(folder_.c_str(), 0555);
  ASSERT_EQ(::seteuid(is_root ? 65534 : ::geteuid()), 0);
  expect_failure({EACCES});
  ASSERT_EQ(::seteuid(::getuid()), 0);
  ::chmod(folder_.c_str(), 0755);
  expect_goes_on();
}

TEST_F(SaveThatFails, BecauseTheFolderIsAFile) {
  scratch_.write("s", "in the way");
  expect_failure({ENOTDIR});
  std::filesystem::remove(folder_);
  expect_goes_on();
}

TEST_F(SaveThatFails, BecauseTheFolderHasGone) {
  prepare();
  std::filesystem::remove_all(folder_);
  const StateFile::Failure failure = file_.save(bytes_of("new"));
  EXPECT_EQ(failure.error, ENOENT);
  expect_goes_on();
}

}  // namespace
}  // namespace etcm::port

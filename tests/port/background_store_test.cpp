// BackgroundStore: nothing waits for its disk, and what the disk does is told once.
#include "posix/background_store.h"

#include <fcntl.h>
#include <gtest/gtest.h>
#include <sys/stat.h>

#include <filesystem>
#include <memory>

#include "peer.h"
#include "state_kept.h"
#include "support/scratch_folder.h"

namespace etcm::port {
namespace {

using namespace std::chrono_literals;
using test::ScratchFolder;

class BackgroundStoreTest : public testing::Test {
 protected:
  DiskResult save(std::string_view text) {
    store_->start_save(bytes_of(text));
    EXPECT_TRUE(store_->wait(patience));
    DiskResult result;
    EXPECT_TRUE(store_->take_result(result));
    DiskResult again;
    EXPECT_FALSE(store_->take_result(again)) << "a result is told once";
    return result;
  }
  const ScratchFolder scratch_;
  const std::string folder_ = scratch_.path("s");
  KeptLog log_;
  std::unique_ptr<BackgroundStore> store_ = std::make_unique<BackgroundStore>(folder_, 1000, log_);
};

TEST_F(BackgroundStoreTest, SavesAndLoads) {
  EXPECT_TRUE(store_->load(Copy::last).empty());
  DiskResult result;
  EXPECT_FALSE(store_->take_result(result)) << "nothing was saved yet";
  EXPECT_TRUE(save("one").ok);
  EXPECT_TRUE(save("three").ok);
  EXPECT_EQ(store_->load(Copy::last).size(), 5u);
  EXPECT_EQ(store_->load(Copy::previous).size(), 3u);
  EXPECT_TRUE(log_.lines.empty());
}

TEST_F(BackgroundStoreTest, SaysWhatIsBrokenAndWhereItIsKept) {
  EXPECT_TRUE(save("one").ok);
  scratch_.write("s/state", "ETCM");
  EXPECT_TRUE(store_->load(Copy::last).empty());
  ASSERT_EQ(log_.lines.size(), 1u);
  EXPECT_EQ(log_.lines[0], folder_ + "/state: is too short; it is kept as state.refused-1");
}

TEST_F(BackgroundStoreTest, SaysWhatFailedAndTheCure) {
  scratch_.write("s", "in the way");
  const DiskResult result = save("one");
  EXPECT_FALSE(result.ok);
  EXPECT_EQ(result.why,
            folder_ + ": cannot open the folder (Not a directory); look at `folder` of [state]");
  std::filesystem::remove(folder_);
  EXPECT_TRUE(save("two").ok);
}

// A pipe that nobody reads stands for a disk that does not answer: opening it takes for ever.
TEST_F(BackgroundStoreTest, DoesNotWaitForADiskThatHangs) {
  EXPECT_TRUE(save("one").ok);
  const std::string hanging = scratch_.path("s/state.new");
  ASSERT_EQ(::mkfifo(hanging.c_str(), 0600), 0);
  store_->start_save(bytes_of("two"));
  EXPECT_FALSE(store_->wait(20ms));
  EXPECT_TRUE(store_->is_saving());
  DiskResult result;
  EXPECT_FALSE(store_->take_result(result));

  // It answers: a pipe is no place for a state, and the next save makes a file of it.
  const FileDescriptor reader(::open(hanging.c_str(), O_RDONLY | O_NONBLOCK));
  EXPECT_TRUE(store_->wait(patience));
  EXPECT_TRUE(store_->take_result(result));
  EXPECT_FALSE(result.ok);
  EXPECT_TRUE(save("three").ok);
}

TEST_F(BackgroundStoreTest, IsLeftBehindWhereTheDiskHangs) {
  std::filesystem::create_directory(folder_);
  const std::string hanging = scratch_.path("s/state.new");
  ASSERT_EQ(::mkfifo(hanging.c_str(), 0600), 0);
  store_->start_save(bytes_of("one"));
  EXPECT_FALSE(store_->wait(20ms));
  store_.reset();
  // The thread still has what it uses.
  const FileDescriptor reader(::open(hanging.c_str(), O_RDONLY | O_NONBLOCK));
  const SteadyClock clock;
  const Instant end = clock.now() + patience;
  while (std::filesystem::exists(hanging) && clock.now() < end) ::usleep(1000);
  EXPECT_FALSE(std::filesystem::exists(hanging));
}

}  // namespace
}  // namespace etcm::port

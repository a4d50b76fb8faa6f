// The published files: when they are written, and what a bad disk costs.
#include "firmware/persist/file_publisher.h"

#include <gtest/gtest.h>

#include "fakes.h"

namespace etcm::firmware {
namespace {

using namespace std::chrono_literals;

TEST(Files, AreWrittenNotMoreOftenThanAskedAndFinallyComplete) {
  Rig rig;
  rig.settings.files->interval = 10s;
  rig.put(1, 0, 0);
  rig.run(1s);
  const std::size_t before = rig.files.attempts;
  rig.put(2, 10, 0);
  rig.run(1s);
  EXPECT_EQ(rig.files.attempts, before);
  rig.gateway->finish(rig.clock.now());
  EXPECT_EQ(rig.files.nodes_written.back(), 2u);
  EXPECT_EQ(rig.log.count("audit passed: conforming"), 1u);
}

TEST(Files, ThatCannotBeWrittenAreSaidOnceAndTriedAgain) {
  Rig rig;
  rig.files.failing = true;
  rig.put(1, 0, 0);
  rig.run(5s);
  EXPECT_GE(rig.files.attempts, 5u);
  EXPECT_EQ(rig.log.count("the disk is full"), 1u);
  EXPECT_EQ(rig.server.header("node_count"), 1u);
  rig.files.failing = false;
  rig.run(1s);
  EXPECT_EQ(rig.log.count("files are written again"), 1u);
}

TEST(Files, WhoseFolderCannotBeMadeAreSaidBeforeThereIsAMesh) {
  Rig rig;
  rig.files.is_folder_missing = true;
  rig.run(5s);
  EXPECT_GE(rig.files.checks, 5u) << "one an interval";
  EXPECT_EQ(rig.files.attempts, 0u) << "no empty mesh in the place of an earlier one";
  EXPECT_EQ(rig.log.count("no such folder; goes on, and tries again"), 1u);
  EXPECT_TRUE(rig.gateway->files()->is_in_trouble());
  rig.files.is_folder_missing = false;
  rig.run(2s);
  EXPECT_EQ(rig.log.count("files are written again"), 1u);
  EXPECT_FALSE(rig.gateway->files()->is_in_trouble());
  const std::uint32_t checks = rig.files.checks;
  rig.put(1, 0, 0);
  rig.run(5s);
  EXPECT_EQ(rig.files.checks, checks) << "whoever writes, sees";
  EXPECT_EQ(rig.files.nodes_written.back(), 1u);
}

TEST(Files, OnADiskThatHangsHoldUpNeitherBusNorMesh) {
  Rig rig;
  rig.files.is_unresponsive = true;
  rig.put(1, 0, 0);
  rig.run(1s);
  EXPECT_EQ(rig.files.attempts, 1u);
  const std::uint32_t reads = rig.bus.reads[1];
  rig.put(2, 10, 0);
  rig.run(60s);
  EXPECT_GE(rig.bus.reads[1], reads + 599);
  EXPECT_EQ(rig.server.header("node_count"), 2u);
  EXPECT_EQ(rig.files.attempts, 1u) << "one at a time";
  EXPECT_EQ(rig.log.count("does not answer"), 1u);
  rig.files.is_unresponsive = false;
  rig.run(1s);
  EXPECT_EQ(rig.log.count("files are written again"), 1u);
  EXPECT_EQ(rig.files.nodes_written.back(), 2u);
  EXPECT_EQ(rig.files.attempts, 2u);
}

TEST(Files, ThatStillHangAtTheEndAreLeft) {
  Rig rig;
  rig.files.is_unresponsive = true;
  rig.put(1, 0, 0);
  rig.run(1s);
  rig.put(2, 10, 0);
  rig.run(1s);
  rig.gateway->finish(rig.clock.now());
  rig.gateway->finish_saving(rig.clock.now());
  EXPECT_EQ(rig.files.attempts, 1u);
  EXPECT_EQ(rig.log.count("audit passed: conforming"), 1u);
}

// Time that passes while the mesh is handed over is time that nobody polls.
TEST(Files, OfALargeMeshAreWrittenLessOften) {
  class SlowFiles final : public port::MeshFiles {
   public:
    explicit SlowFiles(SimulatedClock& clock) : clock_(clock) {}
    void start_check() override {}
    void start_write(const Mesh&, std::span<const std::uint32_t>) override {
      ++attempts;
      clock_.pass(200ms);
    }
    bool is_writing() const override { return false; }
    bool take_result(port::DiskResult& result) override {
      result = {.ok = true, .why = {}};
      return true;
    }
    int attempts = 0;

   private:
    SimulatedClock& clock_;
  };
  SimulatedClock clock;
  RecordingLog log;
  SlowFiles files(clock);
  const FileSettings settings{.folder = "", .name = "", .interval = 1s};
  FilePublisher keeper(settings, 20, files, clock, log);
  const Mesh mesh;
  const port::Instant end = clock.now() + 40s;
  while (clock.now() < end) {
    keeper.mark_dirty();
    keeper.step(clock.now());
    if (keeper.is_due(clock.now())) keeper.write(mesh, {}, clock.now());
    clock.pass(10ms);
  }
  EXPECT_GE(files.attempts, 10);
  EXPECT_LE(files.attempts, 11);
}

}  // namespace
}  // namespace etcm::firmware

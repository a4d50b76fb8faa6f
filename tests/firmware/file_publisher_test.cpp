// The published files: when they are written, and what a bad disk costs.
#include "firmware/persist/file_publisher.h"

#include <gtest/gtest.h>

#include "etcm/files/mesh_text.h"
#include "etcm/files/picture.h"
#include "fakes.h"

namespace etcm::firmware {
namespace {

using namespace std::chrono_literals;

TEST(Files, AreWrittenNotMoreOftenThanAskedAndFinallyComplete) {
  Rig rig;
  rig.settings.files->interval = 10s;
  rig.put(1, 0, 0);
  for (int x = 10; x < 40; ++x) {
    rig.put(1, x, 0);
    rig.run(1s);
  }
  const std::size_t before = rig.files.attempts;
  rig.put(2, 10, 0);
  rig.run(1s);
  EXPECT_EQ(rig.files.attempts, before);
  rig.gateway->finish(rig.clock.now());
  EXPECT_EQ(rig.files.nodes_written.back(), 2u);
  EXPECT_EQ(rig.log.count("audit passed: conforming"), 1u);
}

TEST(Files, TheFirstMeshIsThereAtOnceWhateverTheInterval) {
  Rig rig;
  rig.settings.files->interval = 60s;
  rig.run(2s);
  EXPECT_EQ(rig.files.attempts, 0u);
  rig.put(1, 0, 0);
  rig.run(1s);
  EXPECT_EQ(rig.files.nodes_written, std::vector<std::uint32_t>{1});
  rig.put(2, 10, 0);
  rig.run(1s);
  EXPECT_EQ(rig.files.nodes_written.back(), 2u);
}

TEST(Files, FollowAMeshThatGrowsAfterAStartEverLessOften) {
  Rig rig;
  rig.settings.files->interval = 60s;
  std::vector<std::size_t> writes;
  for (int x = 0; x < 240; ++x) {
    rig.put(1, 10 * x, 0);
    rig.run(1s);
    writes.push_back(rig.files.attempts);
  }
  EXPECT_GE(writes[1], 2u);
  EXPECT_GE(writes[10], 3u);
  EXPECT_LE(writes[62], 7u);
  EXPECT_EQ(writes.back() - writes[119], 2u) << "once an interval";
}

// The mesh changes all the time, and masters see it a tenth of a second later.
TEST(Files, ShowTheSnapshotOfTheirGeneration) {
  Rig rig({feature(1001, 1002)});
  rig.settings.poll.interval = 70ms;
  rig.settings.files->interval = 130ms;
  rig.put_square();
  rig.run(10ms);
  std::size_t written = 0;
  std::size_t unpublished = 0;
  for (int step = 0; step < 500; ++step) {
    rig.put(4, step / 7, 100 + step / 7);
    // Some join between two generations.
    if (step % 50 == 0) rig.put(static_cast<std::uint8_t>(5 + step / 50), 300 + step, step % 7);
    rig.run(10ms);
    if (rig.files.attempts == written) continue;
    written = rig.files.attempts;
    const Snapshot& snapshot = rig.gateway->snapshot();
    ASSERT_EQ(snapshot.generation, rig.server.header("generation"));
    std::vector<Point> published;
    for (const SnapshotVertex& vertex : snapshot.vertices) {
      if (vertex.kind == VertexKind::node) published.push_back(vertex.point);
    }
    std::vector<Point> shown;
    for (const files::ImageVertex& vertex : rig.files.last->vertices) {
      if (!vertex.is_steiner) shown.push_back(vertex.point);
    }
    ASSERT_EQ(shown, published);
    ASSERT_EQ(rig.files.last->edges.size(), snapshot.edge_count);
    if (rig.mesh.hash() != snapshot.mesh_hash) ++unpublished;
  }
  EXPECT_GT(written, 20u);
  EXPECT_GT(unpublished, 5u) << "while the mesh was another one already";
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
  EXPECT_TRUE(rig.gateway->disk_of_files()->is_in_trouble());
  rig.files.is_folder_missing = false;
  rig.run(2s);
  EXPECT_EQ(rig.log.count("files are written again"), 1u);
  EXPECT_FALSE(rig.gateway->disk_of_files()->is_in_trouble());
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
    void start_write(std::shared_ptr<const files::MeshImage>) override {
      ++attempts;
      clock_.pass(200ms);
    }
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
  Settings settings;
  settings.mesh.vertices_max = 10;
  settings.files = FileSettings{.folder = "", .name = "", .interval = 1s};
  FilePublisher publisher(settings, 20, files, clock, log);
  const Snapshot published{.vertices = {SnapshotVertex{}}, .neighbours = {}};
  const port::Instant end = clock.now() + 40s;
  while (clock.now() < end) {
    publisher.mark_dirty(published);
    publisher.step(clock.now());
    if (publisher.is_due(clock.now())) publisher.write(published, {}, {}, clock.now());
    clock.pass(10ms);
  }
  EXPECT_GE(files.attempts, 10);
  EXPECT_LE(files.attempts, 11);
}

// What a memory card bears: with nodes that never stand still, and the settings that are shipped.
TEST(Files, OfJitteringNodesWriteLittleADayWithTheShippedSettings) {
  std::vector<std::string> mistakes;
  const Settings shipped = read_settings(ETCM_SHIPPED_SETTINGS, mistakes);
  ASSERT_TRUE(mistakes.empty()) << mistakes.front();
  Rig rig({}, shipped.mesh.vertices_max);
  rig.settings.poll = shipped.poll;
  rig.settings.files->interval = shipped.files->interval;
  rig.settings.buses[0].units = {{.first = 1, .last = unit_max}};
  std::uint32_t noise = 1;
  const auto jitter = [&] { return static_cast<std::int32_t>((noise = noise * 69069 + 1) >> 30); };
  std::size_t seen = 0;
  std::uint64_t bytes = 0;
  constexpr port::Duration time = 10min;
  for (port::Duration passed{}; passed < time; passed += 1s) {
    for (std::uint8_t unit = 1; unit <= unit_max; ++unit) {
      rig.put(unit, unit % 16 * 40'000 + jitter(), unit / 16 * 40'000 + jitter());
    }
    rig.run(1s);
    if (rig.files.attempts == seen) continue;
    seen = rig.files.attempts;
    bytes += files::text_of(files::write_node, *rig.files.last).size() +
             files::text_of(files::write_ele, *rig.files.last).size() +
             files::svg_text(*rig.files.last, {}).size();
  }
  EXPECT_EQ(rig.server.header("node_count"), unit_max);
  const double megabytes_a_day = static_cast<double>(bytes) / 1e6 * (24h / time);
  EXPECT_LE(megabytes_a_day, 100);
  EXPECT_GE(seen, 5u) << "and yet they are written";
}

}  // namespace
}  // namespace etcm::firmware

// MeshFolder: the files of a mesh, whatever its disk does.
#include "posix/mesh_folder.h"

#include <fcntl.h>
#include <gtest/gtest.h>
#include <sys/stat.h>
#include <unistd.h>

#include <array>
#include <filesystem>
#include <fstream>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "etcm/files/exchange.h"
#include "etcm/files/mesh_text.h"
#include "mounted_disk.h"
#include "peer.h"
#include "posix/file_descriptor.h"
#include "support/meshes.h"
#include "support/scratch_folder.h"

namespace etcm::port {
namespace {

using namespace std::chrono_literals;
using test::ScratchFolder;

class MeshFolderTest : public testing::Test {
 protected:
  static constexpr std::uint32_t vertices_max = 500;

  void SetUp() override {
    for (int i = 0; i < 60; ++i) join({i * 7919 % 1009, i * 104729 % 997});
  }

  void join(Position position) {
    VertexId vertex;
    ASSERT_EQ((*mesh_)->join(position, vertex), Status::ok);
  }

  // Each node with an attribute.
  std::shared_ptr<const files::MeshImage> image() const {
    auto image =
        std::make_shared<files::MeshImage>(files::image_of(**mesh_, Exterior::automatic, {}));
    image->attribute_count = 1;
    for (std::uint32_t i = 1; i <= image->vertices.size(); ++i) {
      image->attributes.push_back(std::to_string(4'000'000'000u + i));
    }
    return image;
  }

  MeshFolder& folder() {
    if (!opened_) {
      opened_ = std::make_unique<MeshFolder>(path_, "mesh", vertices_max);
    }
    return *opened_;
  }

  DiskResult result() {
    DiskResult result;
    EXPECT_TRUE(folder().take_result(result));
    DiskResult again;
    EXPECT_FALSE(folder().take_result(again)) << "a result is told once";
    return result;
  }

  DiskResult write() {
    folder().start_write(image());
    EXPECT_TRUE(folder().wait(patience));
    return result();
  }

  std::string read(const std::string& extension) { return scratch_.read("f/mesh" + extension); }

  // Without the lock.
  std::size_t file_count() {
    std::size_t count = 0;
    for (const auto& entry : std::filesystem::directory_iterator(path_)) {
      count += entry.path().filename().string().front() == '.' ? 0 : 1;
    }
    return count;
  }

  const ScratchFolder scratch_;
  const std::string path_ = scratch_.path("f");
  std::unique_ptr<test::OwnedMesh> mesh_ = test::empty_mesh(vertices_max, 20);
  std::unique_ptr<MeshFolder> opened_;
};

// A pipe that nobody reads stands for a disk that does not answer: opening it takes for ever.
class HangingDisk {
 public:
  explicit HangingDisk(const std::string& path) : path_(path) {
    EXPECT_EQ(::mkfifo(path_.c_str(), 0600), 0);
  }
  // It answers again, and takes whatever there is.
  void answer(MeshFolder& folder) {
    const FileDescriptor reader(::open(path_.c_str(), O_RDONLY | O_NONBLOCK));
    std::array<char, 4096> bytes;
    const SteadyClock clock;
    const Instant end = clock.now() + patience;
    while (!folder.wait(1ms) && clock.now() < end) {
      while (::read(reader.get(), bytes.data(), bytes.size()) > 0) {
      }
    }
  }

 private:
  std::string path_;
};

TEST_F(MeshFolderTest, HoldsTheMesh) {
  EXPECT_TRUE(write().ok);
  EXPECT_EQ(file_count(), 3u);
  EXPECT_EQ(read(".ele"), files::text_of(files::write_ele, *image()));
  EXPECT_NE(read(".node").find("\n60 "), std::string::npos);
  EXPECT_NE(read(".node").find(" 4000000060 0\n"), std::string::npos);
  EXPECT_NE(read(".svg").find("60 nodes"), std::string::npos);
}

TEST_F(MeshFolderTest, HoldsValuesOnceThereAreAny) {
  EXPECT_TRUE(write().ok);
  EXPECT_FALSE(std::filesystem::exists(path_ + "/mesh.geojson"));
  folder().add_values();
  folder().add_values();
  EXPECT_TRUE(write().ok);
  EXPECT_EQ(file_count(), 4u);
  EXPECT_EQ(read(".geojson"), files::text_of(files::write_geojson, *image()));
  EXPECT_TRUE(write().ok);
  EXPECT_EQ(file_count(), 4u);
}

TEST_F(MeshFolderTest, TwoOfOneNameDoNotOverwriteEachOther) {
  EXPECT_TRUE(write().ok);
  MeshFolder second(path_, "mesh", vertices_max);
  std::filesystem::remove(path_ + "/mesh.node");
  for (int attempt = 0; attempt < 2; ++attempt) {
    second.start_write(image());
    ASSERT_TRUE(second.wait(patience));
    DiskResult refused;
    ASSERT_TRUE(second.take_result(refused));
    EXPECT_FALSE(refused.ok);
    EXPECT_NE(refused.why.find("/.mesh.lock: another program writes files of this name there"),
              std::string::npos)
        << refused.why;
    EXPECT_NE(refused.why.find("a folder of its own"), std::string::npos) << refused.why;
    EXPECT_FALSE(std::filesystem::exists(path_ + "/mesh.node"));
  }
  MeshFolder other(path_, "other", vertices_max);
  other.start_write(image());
  ASSERT_TRUE(other.wait(patience));
  DiskResult written;
  ASSERT_TRUE(other.take_result(written));
  EXPECT_TRUE(written.ok) << written.why;
  opened_.reset();
  second.start_write(image());
  ASSERT_TRUE(second.wait(patience));
  ASSERT_TRUE(second.take_result(written));
  EXPECT_TRUE(written.ok) << written.why;
}

TEST_F(MeshFolderTest, WhatACrashLeftIsRemoved) {
  std::filesystem::create_directories(path_ + "/elsewhere");
  std::filesystem::create_symlink("elsewhere/target.svg", path_ + "/mesh.svg");
  std::ofstream(path_ + "/elsewhere/target.svg") << "old";
  for (const char* left :
       {"mesh.node.17.tmp", "mesh.ele.4194304.tmp", "elsewhere/target.svg.9.tmp"}) {
    std::ofstream(path_ + "/" + left) << "half";
  }
  const std::vector<std::string> others = {
      "mesh.node.tmp",   "mesh.node..tmp",      "mesh.node.1x.tmp",  "mesh.node.17.tmp2",
      "mesh.node.17",    "mesh.poly.17.tmp",    "other.node.17.tmp", "my mesh.node.17.tmp",
      "mesh.node17.tmp", "mesh.node.1.7.tmp",   "mesh.node",         "elsewhere/mesh.node.17.tmp",
      "mesh.svg.tmp",    "elsewhere/target.svg"};
  for (const std::string& other : others) std::ofstream(path_ + "/" + other) << "kept";
  std::filesystem::create_directories(path_ + "/mesh.node.3.tmp");
  folder().start_check();
  EXPECT_TRUE(folder().wait(patience));
  EXPECT_TRUE(result().ok);
  for (const char* left :
       {"mesh.node.17.tmp", "mesh.ele.4194304.tmp", "elsewhere/target.svg.9.tmp"}) {
    EXPECT_FALSE(std::filesystem::exists(path_ + "/" + left)) << left;
  }
  for (const std::string& other : others) {
    EXPECT_TRUE(std::filesystem::exists(path_ + "/" + other)) << other;
  }
  EXPECT_TRUE(std::filesystem::exists(path_ + "/mesh.node.3.tmp")) << "a folder is no leftover";
  EXPECT_TRUE(write().ok);
}

// The mesh goes on changing while it is written; what comes to the disk is what was handed over.
TEST_F(MeshFolderTest, DoesNotWaitForADiskThatHangs) {
  std::filesystem::create_directory(path_);
  HangingDisk disk(path_ + "/mesh.svg");
  folder().start_write(image());
  EXPECT_FALSE(folder().wait(20ms));
  DiskResult none;
  EXPECT_FALSE(folder().take_result(none));
  const std::string ele = files::text_of(files::write_ele, *image());
  for (int i = 0; i < 100; ++i) join({2000 + i * 37 % 501, i * 53 % 499});
  disk.answer(folder());
  EXPECT_TRUE(result().ok);
  EXPECT_EQ(read(".ele"), ele);
  EXPECT_NE(read(".node").find("\n60 "), std::string::npos);
}

TEST_F(MeshFolderTest, IsLeftBehindWhereTheDiskHangs) {
  std::filesystem::create_directory(path_);
  HangingDisk disk(path_ + "/mesh.svg");
  folder().start_write(image());
  EXPECT_FALSE(folder().wait(20ms));
  opened_.reset();
  // The thread still has what it uses.
  const FileDescriptor reader(::open((path_ + "/mesh.svg").c_str(), O_RDONLY));
  std::string text;
  std::array<char, 4096> bytes;
  for (ssize_t count = 0; (count = ::read(reader.get(), bytes.data(), bytes.size())) > 0;) {
    text.append(bytes.data(), static_cast<std::size_t>(count));
  }
  EXPECT_NE(text.find("60 nodes"), std::string::npos);
  EXPECT_TRUE(text.ends_with("</svg>\n"));
}

TEST_F(MeshFolderTest, SaysWhenTheDiskIsFullAndLeavesTheOldFiles) {
  const MountedDisk disk(path_);
  if (!disk.is_mounted) GTEST_SKIP() << "needs the right to mount a small disk";
  EXPECT_TRUE(write().ok);
  const std::string old = read(".node");
  const std::string filler = scratch_.write("f/filler", std::string(80'000, 'x'));
  for (int i = 0; i < 100; ++i) join({2000 + i * 37 % 501, i * 53 % 499});
  const DiskResult full = write();
  EXPECT_FALSE(full.ok);
  EXPECT_EQ(full.why, path_ +
                          "/mesh.node: cannot be written (No space left on device); make room "
                          "on that disk");
  EXPECT_EQ(read(".node"), old);
  EXPECT_EQ(file_count(), 4u) << "no temporary file is left";
  std::filesystem::remove(filler);
  EXPECT_TRUE(write().ok);
  EXPECT_NE(read(".node"), old);
}

TEST_F(MeshFolderTest, SaysWhenTheDiskIsReadOnly) {
  MountedDisk disk(path_);
  if (!disk.is_mounted) GTEST_SKIP() << "needs the right to mount a small disk";
  EXPECT_TRUE(write().ok);
  ASSERT_TRUE(disk.remount(MS_RDONLY));
  EXPECT_EQ(write().why, path_ +
                             "/mesh.node: cannot be written (Read-only file system); mount "
                             "that disk for writing");
  ASSERT_TRUE(disk.remount(0));
  EXPECT_TRUE(write().ok);
}

TEST_F(MeshFolderTest, SaysWhenTheFolderHasGone) {
  EXPECT_TRUE(write().ok);
  std::filesystem::remove_all(path_);
  EXPECT_TRUE(write().ok) << "it is made again";
  EXPECT_EQ(file_count(), 3u);
}

// A check, and then a mesh.
class NoMeshFolder : public MeshFolderTest {
 protected:
  void expect_failure(const std::string& why) {
    for (int attempt = 0; attempt < 2; ++attempt) {
      EXPECT_EQ(check().why, why);
      EXPECT_EQ(write().why, why);
    }
  }
  // Root may write anywhere. The whole process becomes somebody else meanwhile, its threads too.
  static void as_nobody(const std::function<void()>& action) {
    const bool is_root = ::geteuid() == 0;
    ASSERT_EQ(::seteuid(is_root ? 65534 : ::geteuid()), 0);
    action();
    ASSERT_EQ(::seteuid(::getuid()), 0);
  }
  DiskResult check() {
    folder().start_check();
    EXPECT_TRUE(folder().wait(patience));
    return result();
  }
};

TEST_F(NoMeshFolder, IsMadeWhenItIsNeeded) {
  folder();
  EXPECT_FALSE(std::filesystem::exists(path_));
  EXPECT_TRUE(check().ok);
  EXPECT_EQ(file_count(), 0u) << "nothing is written yet";
  EXPECT_TRUE(write().ok);
  EXPECT_EQ(file_count(), 3u);
}

TEST_F(NoMeshFolder, WhereAFileStandsInTheWay) {
  scratch_.write("f", "in the way");
  expect_failure(path_ + ": cannot make the folder (Not a directory); look at `folder` of [files]");
  std::filesystem::remove(path_);
  EXPECT_TRUE(write().ok);
  EXPECT_EQ(file_count(), 3u);
}

TEST_F(NoMeshFolder, WhereItMayNotBeMade) {
  std::filesystem::permissions(scratch_.path(""), std::filesystem::perms{0555});
  as_nobody([&] {
    expect_failure(
        path_ + ": cannot make the folder (Permission denied); let the gateway's user write there");
  });
  std::filesystem::permissions(scratch_.path(""), std::filesystem::perms{0755});
  EXPECT_TRUE(write().ok);
}

TEST_F(NoMeshFolder, WhereItMayNotBeWritten) {
  std::filesystem::permissions(scratch_.path(""), std::filesystem::perms{0755});
  std::filesystem::create_directory(path_);
  std::filesystem::permissions(path_, std::filesystem::perms{0555});
  as_nobody([&] {
    EXPECT_EQ(check().why, path_ +
                               ": cannot be written (Permission denied); let the gateway's "
                               "user write there");
  });
  std::filesystem::permissions(path_, std::filesystem::perms{0755});
  EXPECT_TRUE(check().ok);
}

}  // namespace
}  // namespace etcm::port

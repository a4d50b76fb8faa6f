#include "etcm/files/file_set.h"

#include <gtest/gtest.h>
#include <signal.h>
#include <sys/resource.h>
#include <sys/stat.h>

#include "etcm/files/error.h"
#include "support/killed_process.h"
#include "support/scratch_folder.h"

namespace etcm::files {
namespace {

using test::ScratchFolder;

// No file may grow beyond this while it lives: a disk that is full.
class FullDisk {
 public:
  explicit FullDisk(rlim_t bytes) {
    ::signal(SIGXFSZ, SIG_IGN);
    ::getrlimit(RLIMIT_FSIZE, &before_);
    const rlimit now{bytes, before_.rlim_max};
    ::setrlimit(RLIMIT_FSIZE, &now);
  }
  FullDisk(const FullDisk&) = delete;
  FullDisk& operator=(const FullDisk&) = delete;
  ~FullDisk() { ::setrlimit(RLIMIT_FSIZE, &before_); }

 private:
  rlimit before_{};
};

TEST(FileSet, WritesAll) {
  const ScratchFolder folder;
  FileSet files;
  files.add(folder.path("a"), "one");
  files.add(folder.path("b"), "");
  files.commit();
  EXPECT_EQ(folder.read("a"), "one");
  EXPECT_EQ(folder.file_count(), 2u);
}

TEST(FileSet, KeepsPermissionsAndFollowsLinks) {
  const ScratchFolder folder;
  folder.write("real", "old");
  ::chmod(folder.path("real").c_str(), 0640);
  std::filesystem::create_symlink("real", folder.path("link"));
  FileSet files;
  files.add(folder.path("link"), "new");
  files.commit();
  EXPECT_TRUE(std::filesystem::is_symlink(folder.path("link")));
  EXPECT_EQ(folder.read("real"), "new");
  struct stat status {};
  ASSERT_EQ(::stat(folder.path("real").c_str(), &status), 0);
  EXPECT_EQ(status.st_mode & 07777, 0640u);
}

TEST(FileSet, LeavesNothingOnAFullDisk) {
  const ScratchFolder folder;
  folder.write("a", "old");
  FileSet files;
  files.add(folder.path("a"), "new");
  files.add(folder.path("b"), std::string(100000, 'x'));
  {
    const FullDisk full(5000);
    EXPECT_THROW(files.commit(), OutputError);
  }
  EXPECT_EQ(folder.read("a"), "old");
  EXPECT_EQ(folder.file_count(), 1u);
}

TEST(FileSet, LeavesNothingWhereOneTargetCannotBe) {
  const ScratchFolder folder;
  std::filesystem::create_directory(folder.path("taken"));
  for (const std::string& bad : {folder.path("missing/file"), folder.path("taken")}) {
    FileSet files;
    files.add(folder.path("a"), "text");
    files.add(bad, "text");
    EXPECT_THROW(files.commit(), OutputError) << bad;
    EXPECT_EQ(folder.file_count(), 1u);
  }
}

// Who reads while they are written, or after a crash, finds each of them, old or new.
TEST(FileSet, EachIsThereAndWholeWhereverItsWriterIsKilled) {
  if (!test::run_killed_at(test::to_the_end, [] {}).can_trace) {
    GTEST_SKIP() << "processes cannot be traced here (an emulator?)";
  }
  const ScratchFolder folder;
  const std::vector<std::string> names{"a", "b", "c"};
  bool is_new = false;
  for (unsigned long stop = 0; !is_new; ++stop) {
    SCOPED_TRACE(testing::Message() << "killed at stop " << stop);
    for (const std::string& name : names) folder.write(name, name + " old");
    FileSet files;
    for (const std::string& name : names) files.add(folder.path(name), name + " new");
    const test::Traced traced =
        test::run_killed_at(stop, [&] { static_cast<void>(files.try_commit()); });
    for (const std::string& name : names) {
      const std::string found = folder.read(name);
      ASSERT_TRUE(found == name + " old" || found == name + " new") << '"' << found << '"';
    }
    is_new = !traced.was_killed;
  }
  for (const std::string& name : names) EXPECT_EQ(folder.read(name), name + " new");
}

TEST(FileSet, WritesDevicesInPlace) {
  FileSet files;
  files.add("/dev/full", "text");
  EXPECT_THROW(files.commit(), OutputError);
  FileSet null;
  null.add("/dev/null", "text");
  null.commit();
  EXPECT_TRUE(std::filesystem::is_character_file("/dev/null"));
}

}  // namespace
}  // namespace etcm::files

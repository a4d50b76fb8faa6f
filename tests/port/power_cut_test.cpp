// A save whose power is cut at any of its system calls, on a disk that keeps no more than it must:
// what was written and not synced is there, is zeros, or is cut off; of changes of the folder since
// it was synced any may be missing. The old state or the new one is found whatever is left.
//
// This program is linked so that what a save calls comes by here first (--wrap).
#include <fcntl.h>
#include <gtest/gtest.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cstdint>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <functional>
#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "state_kept.h"
#include "support/scratch_folder.h"

namespace etcm::port {
namespace {

using test::ScratchFolder;

enum class Kind { write, sync_file, create, link, rename, unlink, sync_folder };

struct Operation {
  Kind kind;
  ino_t file = 0;     // what is written, synced, linked or renamed
  std::string name;   // of the folder: what it takes or loses
  std::string other;  // renamed: the name it had
  std::string bytes;
};

// Null: nobody looks.
std::vector<Operation>* recorded = nullptr;

struct stat status_of(int descriptor) {
  struct stat status {};
  static_cast<void>(::fstat(descriptor, &status));
  return status;
}

std::string name_of(int descriptor) {
  return std::filesystem::read_symlink("/proc/self/fd/" + std::to_string(descriptor))
      .filename()
      .string();
}

ino_t file_at(int folder, const char* name) {
  struct stat status {};
  return ::fstatat(folder, name, &status, AT_SYMLINK_NOFOLLOW) == 0 ? status.st_ino : 0;
}

}  // namespace
}  // namespace etcm::port

extern "C" {

ssize_t __real_write(int descriptor, const void* bytes, std::size_t count);
int __real_fsync(int descriptor);
int __real_linkat(int from, const char* old_name, int to, const char* name, int flags);
int __real_renameat(int from, const char* old_name, int to, const char* name);
int __real_unlinkat(int folder, const char* name, int flags);

ssize_t __wrap_write(int descriptor, const void* bytes, std::size_t count) {
  using namespace etcm::port;
  const ssize_t written = __real_write(descriptor, bytes, count);
  if (recorded == nullptr || written < 0) return written;
  const struct stat status = status_of(descriptor);
  if (status.st_size == written) {
    recorded->push_back({Kind::create, status.st_ino, name_of(descriptor), "", ""});
  }
  recorded->push_back({Kind::write,
                       status.st_ino,
                       "",
                       "",
                       {static_cast<const char*>(bytes), static_cast<std::size_t>(written)}});
  return written;
}

int __wrap_fsync(int descriptor) {
  using namespace etcm::port;
  const int result = __real_fsync(descriptor);
  if (recorded == nullptr || result != 0) return result;
  const struct stat status = status_of(descriptor);
  const Kind kind = S_ISDIR(status.st_mode) ? Kind::sync_folder : Kind::sync_file;
  recorded->push_back({kind, status.st_ino, "", "", ""});
  return result;
}

int __wrap_linkat(int from, const char* old_name, int to, const char* name, int flags) {
  using namespace etcm::port;
  const int result = __real_linkat(from, old_name, to, name, flags);
  if (recorded != nullptr && result == 0) {
    recorded->push_back({Kind::link, file_at(to, name), name, "", ""});
  }
  return result;
}

int __wrap_renameat(int from, const char* old_name, int to, const char* name) {
  using namespace etcm::port;
  const int result = __real_renameat(from, old_name, to, name);
  if (recorded != nullptr && result == 0) {
    recorded->push_back({Kind::rename, file_at(to, name), name, old_name, ""});
  }
  return result;
}

int __wrap_unlinkat(int folder, const char* name, int flags) {
  using namespace etcm::port;
  const int result = __real_unlinkat(folder, name, flags);
  if (recorded != nullptr && result == 0) {
    recorded->push_back({Kind::unlink, 0, name, "", ""});
  }
  return result;
}

}  // extern "C"

namespace etcm::port {
namespace {

using Names = std::map<std::string, ino_t>;
using Contents = std::map<ino_t, std::string>;

std::string contents_of(const std::filesystem::path& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>()};
}

void change(Names& names, const Operation& operation) {
  if (operation.kind == Kind::unlink) names.erase(operation.name);
  if (operation.kind == Kind::rename) names.erase(operation.other);
  if (operation.kind != Kind::unlink) names[operation.name] = operation.file;
}

bool changes_folder(Kind kind) {
  return kind == Kind::create || kind == Kind::link || kind == Kind::rename || kind == Kind::unlink;
}

class PowerCut : public testing::Test {
 protected:
  void SetUp() override {
    // What would be on a disk is worked out here: none has to be waited for.
    if (std::filesystem::is_directory("/dev/shm")) ::setenv("TMPDIR", "/dev/shm", 1);
  }

  // What the disk has before the save that is cut, all of it synced.
  void keep(const ScratchFolder& folder) {
    for (const auto& entry : std::filesystem::directory_iterator(folder.path("s"))) {
      const std::string path = entry.path().string();
      const ino_t file = file_at(AT_FDCWD, path.c_str());
      names_[entry.path().filename().string()] = file;
      contents_[file] = contents_of(entry.path());
    }
  }

  void record(const ScratchFolder& folder, std::string_view text) {
    recorded = &operations_;
    const bool is_saved = save_in(folder.path("s"), text);
    recorded = nullptr;
    ASSERT_TRUE(is_saved);
    ASSERT_GE(operations_.size(), 6u);
  }

  // Calls with what a start finds of each disk that a cut before the operation `end` may leave.
  void cut_before(std::size_t end, const std::function<void(const std::string&)>& look) {
    Names names = names_;
    Contents synced = contents_, written;
    std::vector<Operation> pending;
    for (std::size_t i = 0; i < end; ++i) {
      const Operation& operation = operations_[i];
      if (changes_folder(operation.kind)) pending.push_back(operation);
      if (operation.kind == Kind::write) written[operation.file] += operation.bytes;
      if (operation.kind == Kind::sync_file) {
        synced[operation.file] += written[operation.file];
        written.erase(operation.file);
      }
      if (operation.kind == Kind::sync_folder) {
        for (const Operation& done : pending) change(names, done);
        pending.clear();
      }
    }
    for (std::uint32_t kept = 0; kept < 1u << pending.size(); ++kept) {
      Names left = names;
      for (std::size_t i = 0; i < pending.size(); ++i) {
        if ((kept >> i & 1u) != 0) change(left, pending[i]);
      }
      for (int form = 0; form < 4; ++form) look(start_on(left, synced, written, form));
    }
  }

 private:
  static std::string start_on(const Names& names, const Contents& synced, const Contents& written,
                              int form) {
    const ScratchFolder disk;
    std::filesystem::create_directory(disk.path("s"));
    for (const auto& [name, file] : names) {
      const auto has = [&file = file](const Contents& of) {
        const auto found = of.find(file);
        return found == of.end() ? std::string() : found->second;
      };
      std::string loose = has(written);
      if (form == 0) loose.clear();
      if (form == 1) loose.resize(loose.size() / 2);
      if (form == 2) loose.assign(loose.size(), '\0');
      static_cast<void>(disk.write("s/" + name, has(synced) + loose));
    }
    const std::string found = found_in(disk.path("s"));
    EXPECT_TRUE(save_in(disk.path("s"), "last"));
    EXPECT_EQ(found_in(disk.path("s")), "last");
    return found;
  }

 protected:
  std::vector<Operation> operations_;
  Names names_;
  Contents contents_;
};

TEST_F(PowerCut, LeavesTheOldStateOrTheNewOne) {
  const std::string longer(100'000, 'n');
  for (const int saves_before : {0, 1, 2}) {
    SCOPED_TRACE(saves_before);
    operations_.clear();
    names_.clear();
    contents_.clear();
    const ScratchFolder folder;
    std::filesystem::create_directory(folder.path("s"));
    for (int i = 1; i <= saves_before; ++i) {
      ASSERT_TRUE(save_in(folder.path("s"), i == saves_before ? "old" : "oldest"));
    }
    keep(folder);
    record(folder, longer);
    bool seen_old = false, seen_new = false;
    const std::string old = saves_before == 0 ? "" : "old";
    for (std::size_t end = 0; end <= operations_.size(); ++end) {
      SCOPED_TRACE(testing::Message() << "cut before operation " << end);
      cut_before(end, [&](const std::string& found) {
        ASSERT_TRUE(found == old || found == longer) << found.substr(0, 20);
        (found == old ? seen_old : seen_new) = true;
      });
    }
    EXPECT_TRUE(seen_old);
    EXPECT_TRUE(seen_new);
    // When the save has ended nothing takes it back.
    cut_before(operations_.size(), [&](const std::string& found) { ASSERT_EQ(found, longer); });
  }
}

// The disk is as bad as it should be: of a save that syncs nothing it can lose all.
TEST_F(PowerCut, WithoutASyncWouldLeaveNeither) {
  const ScratchFolder folder;
  std::filesystem::create_directory(folder.path("s"));
  record(folder, "new");
  std::erase_if(operations_, [](const Operation& operation) {
    return operation.kind == Kind::sync_file || operation.kind == Kind::sync_folder;
  });
  bool is_lost = false;
  cut_before(operations_.size(), [&](const std::string& found) { is_lost |= found != "new"; });
  EXPECT_TRUE(is_lost);
}

}  // namespace
}  // namespace etcm::port

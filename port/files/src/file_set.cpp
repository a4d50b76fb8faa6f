#include "etcm/files/file_set.h"

#include <fcntl.h>
#include <signal.h>
#include <sys/stat.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <cstring>
#include <filesystem>
#include <set>
#include <utility>

#include "etcm/files/error.h"

namespace etcm::files {

namespace {

[[noreturn]] void fail(const std::string& path, int error) {
  throw OutputError(path + ": cannot be written: " + std::strerror(error));
}

// Holds back what would end the program between two renames.
class SignalsHeld {
 public:
  SignalsHeld() {
    sigset_t ending;
    sigemptyset(&ending);
    for (const int signal : {SIGINT, SIGTERM, SIGHUP, SIGQUIT}) sigaddset(&ending, signal);
    pthread_sigmask(SIG_BLOCK, &ending, &before_);
  }
  SignalsHeld(const SignalsHeld&) = delete;
  SignalsHeld& operator=(const SignalsHeld&) = delete;
  ~SignalsHeld() { pthread_sigmask(SIG_SETMASK, &before_, nullptr); }

 private:
  sigset_t before_;
};

bool is_written_directly(const std::string& path) {
  struct stat status {};
  return ::stat(path.c_str(), &status) == 0 && !S_ISREG(status.st_mode) && !S_ISDIR(status.st_mode);
}

std::string target_of(const std::string& path) {
  std::error_code error;
  std::filesystem::path real = std::filesystem::canonical(path, error);
  return error ? path : real.string();
}

std::string folder_of(const std::string& path) {
  const std::string folder = std::filesystem::path(path).parent_path().string();
  return folder.empty() ? "." : folder;
}

// Opens a new file beside the target.
int open_temporary(const std::string& temporary) {
  constexpr int flags = O_WRONLY | O_CREAT | O_EXCL | O_NOFOLLOW | O_CLOEXEC;
  int descriptor = ::open(temporary.c_str(), flags, 0666);
  if (descriptor < 0 && errno == EEXIST && ::unlink(temporary.c_str()) == 0) {
    // A process with our number died here before.
    descriptor = ::open(temporary.c_str(), flags, 0666);
  }
  return descriptor;
}

// A file that is replaced keeps its permissions.
int copy_mode(const std::string& target, int descriptor) {
  struct stat status {};
  if (::stat(target.c_str(), &status) != 0) return 0;
  return ::fchmod(descriptor, status.st_mode & 07777) == 0 ? 0 : errno;
}

void write_directly(const std::string& path, std::string_view contents) {
  if (path == "-") return write_all(STDOUT_FILENO, contents, "standard output");
  const int file = ::open(path.c_str(), O_WRONLY | O_CLOEXEC);
  if (file < 0) fail(path, errno);
  try {
    write_all(file, contents, path);
  } catch (...) {
    ::close(file);
    throw;
  }
  if (::close(file) != 0) fail(path, errno);
}

}  // namespace

void write_all(int descriptor, std::string_view text, const std::string& name) {
  while (!text.empty()) {
    const ssize_t written = ::write(descriptor, text.data(), text.size());
    if (written < 0 && errno == EINTR) continue;
    if (written < 0) fail(name, errno);
    text.remove_prefix(static_cast<std::size_t>(written));
  }
}

void FileSet::add(std::string path, std::string contents) {
  files_.push_back({std::move(path), std::move(contents), {}, {}});
}

std::size_t FileSet::bytes() const {
  std::size_t sum = 0;
  for (const File& file : files_) sum += file.contents.size();
  return sum;
}

void FileSet::commit() {
  const SignalsHeld held;
  try {
    write_temporaries();
    rename_all();
  } catch (...) {
    remove_temporaries();
    throw;
  }
}

void FileSet::write_temporaries() {
  for (File& file : files_) {
    if (file.path == "-" || is_written_directly(file.path)) continue;
    file.target = target_of(file.path);
    if (std::filesystem::is_directory(file.target)) fail(file.path, EISDIR);
    const std::string temporary = file.target + "." + std::to_string(::getpid()) + ".tmp";
    const int descriptor = open_temporary(temporary);
    if (descriptor < 0) fail(file.path, errno);
    file.temporary = temporary;
    try {
      write_all(descriptor, file.contents, file.path);
    } catch (...) {
      ::close(descriptor);
      throw;
    }
    int error = copy_mode(file.target, descriptor);
    if (error == 0 && ::fsync(descriptor) != 0) error = errno;
    if (::close(descriptor) != 0 && error == 0) error = errno;
    if (error != 0) fail(file.path, error);
  }
}

void FileSet::rename_all() {
  std::set<std::string> folders;
  for (File& file : files_) {
    if (file.temporary.empty()) continue;
    if (::rename(file.temporary.c_str(), file.target.c_str()) != 0) fail(file.path, errno);
    file.temporary.clear();
    folders.insert(folder_of(file.target));
  }
  for (const std::string& folder : folders) {
    const int descriptor = ::open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
    if (descriptor < 0) continue;
    // Some file systems cannot sync a folder; the files themselves are safe.
    (void)::fsync(descriptor);
    ::close(descriptor);
  }
  // Last, because it cannot be taken back.
  for (const File& file : files_) {
    if (file.target.empty()) write_directly(file.path, file.contents);
  }
}

void FileSet::remove_temporaries() noexcept {
  for (File& file : files_) {
    if (!file.temporary.empty()) ::unlink(file.temporary.c_str());
    file.temporary.clear();
  }
}

}  // namespace etcm::files

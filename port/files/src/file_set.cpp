#include "etcm/files/file_set.h"

#include <fcntl.h>
#include <signal.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <charconv>
#include <climits>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <string_view>
#include <system_error>
#include <utility>

#include "etcm/files/error.h"

namespace etcm::files {

namespace {

// A temporary file is TARGET.PID.tmp.
constexpr std::string_view temporary_end = ".tmp";

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

enum class Kind { none, file, folder, device };

Kind kind_of(const std::string& path) {
  struct stat status {};
  if (::stat(path.c_str(), &status) != 0) return Kind::none;
  if (S_ISREG(status.st_mode)) return Kind::file;
  return S_ISDIR(status.st_mode) ? Kind::folder : Kind::device;
}

// Links followed, into a string that keeps its memory.
void find_target(const std::string& path, std::string& target) {
  std::array<char, PATH_MAX> real;
  target = ::realpath(path.c_str(), real.data()) != nullptr ? real.data() : path.c_str();
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

std::string_view folder_of(const std::string& path) {
  const std::size_t slash = path.rfind('/');
  if (slash == std::string::npos) return ".";
  return std::string_view(path).substr(0, std::max<std::size_t>(slash, 1));
}

void sync_folder(std::string_view folder) {
  std::array<char, PATH_MAX> path{};
  if (folder.size() >= path.size()) return;
  std::copy(folder.begin(), folder.end(), path.begin());
  const int descriptor = ::open(path.data(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
  if (descriptor < 0) return;
  // Some file systems cannot sync a folder; the files themselves are safe.
  (void)::fsync(descriptor);
  ::close(descriptor);
}

// Whether `name` is that of a temporary file for `target`, of whichever process.
bool is_temporary_of(std::string_view name, std::string_view target) {
  if (!name.starts_with(target)) return false;
  name.remove_prefix(target.size());
  if (!name.starts_with('.') || !name.ends_with(temporary_end)) return false;
  name.remove_prefix(1);
  if (name.size() <= temporary_end.size()) return false;
  name.remove_suffix(temporary_end.size());
  return name.find_first_not_of("0123456789") == std::string_view::npos;
}

}  // namespace

FileSet::FileSet() : buffer_(std::size_t{1} << 14) {}

void FileSet::add(std::string path, std::function<void(TextSink&)> write) {
  files_.push_back({std::move(path), std::move(write), {}, {}});
  // The temporary's name is a little longer, and an absolute path may be.
  files_.back().target.reserve(files_.back().path.size() + 256);
  files_.back().temporary.reserve(files_.back().path.size() + 256);
}

void FileSet::add(std::string path, std::string contents) {
  add(std::move(path), [contents = std::move(contents)](TextSink& out) { out << contents; });
}

void FileSet::commit() {
  const Failure failure = try_commit();
  if (failure.path == nullptr) return;
  throw OutputError(*failure.path + ": cannot be written: " + std::strerror(failure.error));
}

FileSet::Failure FileSet::try_commit() {
  const SignalsHeld held;
  Failure failure;
  for (File& file : files_) {
    file.target.clear();
    if (file.path == "-" || kind_of(file.path) == Kind::device) continue;
    if (failure = write_temporary(file); failure.path != nullptr) break;
  }
  if (failure.path == nullptr) failure = rename_all();
  remove_temporaries();
  return failure;
}

int FileSet::write(int descriptor, const File& file) {
  TextSink out(descriptor, buffer_);
  file.write(out);
  return out.finish();
}

FileSet::Failure FileSet::write_temporary(File& file) {
  find_target(file.path, file.target);
  if (kind_of(file.target) == Kind::folder) return {&file.path, EISDIR};
  std::array<char, 16> number{};
  const auto digits = std::to_chars(number.data(), number.data() + number.size(), ::getpid());
  file.temporary = file.target;
  file.temporary += '.';
  file.temporary.append(number.data(), digits.ptr);
  file.temporary += temporary_end;
  const int descriptor = open_temporary(file.temporary);
  if (descriptor < 0) {
    file.temporary.clear();
    return {&file.path, errno};
  }
  int error = write(descriptor, file);
  if (error == 0) error = copy_mode(file.target, descriptor);
  if (error == 0 && ::fsync(descriptor) != 0) error = errno;
  if (::close(descriptor) != 0 && error == 0) error = errno;
  if (error != 0) return {&file.path, error};
  return {};
}

FileSet::Failure FileSet::rename_all() {
  for (File& file : files_) {
    if (file.temporary.empty()) continue;
    if (::rename(file.temporary.c_str(), file.target.c_str()) != 0) return {&file.path, errno};
    file.temporary.clear();
  }
  std::string_view synced;
  for (const File& file : files_) {
    if (file.target.empty() || folder_of(file.target) == synced) continue;
    synced = folder_of(file.target);
    sync_folder(synced);
  }
  // Last, because it cannot be taken back.
  for (const File& file : files_) {
    if (!file.target.empty()) continue;
    if (const Failure failure = write_directly(file); failure.path != nullptr) return failure;
  }
  return {};
}

FileSet::Failure FileSet::write_directly(const File& file) {
  static const std::string standard_output = "standard output";
  if (file.path == "-") {
    const int error = write(STDOUT_FILENO, file);
    return error == 0 ? Failure{} : Failure{&standard_output, error};
  }
  const int descriptor = ::open(file.path.c_str(), O_WRONLY | O_CLOEXEC);
  if (descriptor < 0) return {&file.path, errno};
  int error = write(descriptor, file);
  if (::close(descriptor) != 0 && error == 0) error = errno;
  return error == 0 ? Failure{} : Failure{&file.path, error};
}

void FileSet::remove_leftovers() {
  for (File& file : files_) {
    find_target(file.path, file.target);
    const std::filesystem::path target(file.target);
    std::error_code error;
    std::filesystem::directory_iterator entry(std::string(folder_of(file.target)), error);
    for (; !error && entry != std::filesystem::directory_iterator(); entry.increment(error)) {
      const std::string& path = entry->path().native();
      if (is_temporary_of(entry->path().filename().native(), target.filename().native())) {
        ::unlink(path.c_str());
      }
    }
  }
}

void FileSet::remove_temporaries() {
  for (File& file : files_) {
    if (!file.temporary.empty()) ::unlink(file.temporary.c_str());
    file.temporary.clear();
  }
}

}  // namespace etcm::files

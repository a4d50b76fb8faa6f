#include "posix/state_file.h"

#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>

#include <cerrno>
#include <cstdint>
#include <cstdio>
#include <cstring>
#include <system_error>
#include <utility>

#include "posix/exhaustion.h"

namespace etcm::port {

namespace {

constexpr const char* new_name = "state.new";
constexpr std::array<const char*, 2> names{"state", "state.previous"};
constexpr unsigned refused_max = 9999;

constexpr std::array<char, 8> magic{'E', 'T', 'C', 'M', 'K', 'E', 'P', 'T'};
constexpr std::uint32_t head_layout = 1;
constexpr std::size_t layout_at = 8;
constexpr std::size_t checksum_at = 12;
constexpr std::size_t size_at = 16;

using Head = std::array<std::byte, state_head_size>;

const char* name_of(Copy copy) { return names[static_cast<std::size_t>(copy)]; }

constexpr std::array<std::uint32_t, 256> make_checksum_table() {
  std::array<std::uint32_t, 256> table{};
  for (std::uint32_t i = 0; i < table.size(); ++i) {
    std::uint32_t value = i;
    for (int bit = 0; bit < 8; ++bit) value = value >> 1 ^ ((value & 1u) != 0 ? 0xedb88320u : 0u);
    table[i] = value;
  }
  return table;
}

std::uint32_t add_to_checksum(std::uint32_t sum, std::span<const std::byte> bytes) {
  static constexpr auto table = make_checksum_table();
  for (const std::byte byte : bytes) {
    sum = table[(sum ^ std::to_integer<std::uint32_t>(byte)) & 0xffu] ^ sum >> 8;
  }
  return sum;
}

std::uint32_t checksum_of(const Head& head, std::span<const std::byte> bytes) {
  std::uint32_t sum = 0xffffffffu;
  sum = add_to_checksum(sum, std::span(head).first(checksum_at));
  sum = add_to_checksum(sum, std::span(head).subspan(size_at));
  return ~add_to_checksum(sum, bytes);
}

void store_number(Head& head, std::size_t at, std::size_t width, std::uint64_t value) {
  for (std::size_t i = 0; i < width; ++i) head[at + i] = static_cast<std::byte>(value >> (8 * i));
}

std::uint64_t load_number(const Head& head, std::size_t at, std::size_t width) {
  std::uint64_t value = 0;
  for (std::size_t i = width; i-- > 0;) {
    value = value << 8 | std::to_integer<std::uint64_t>(head[at + i]);
  }
  return value;
}

Head head_of(std::span<const std::byte> bytes) {
  Head head{};
  std::memcpy(head.data(), magic.data(), magic.size());
  store_number(head, layout_at, 4, head_layout);
  store_number(head, size_at, 8, bytes.size());
  store_number(head, checksum_at, 4, checksum_of(head, bytes));
  return head;
}

bool write_whole(int descriptor, std::span<const std::byte> bytes) {
  while (!bytes.empty()) {
    const ssize_t written = ::write(descriptor, bytes.data(), bytes.size());
    if (written < 0 && errno == EINTR) continue;
    if (written < 0) return false;
    bytes = bytes.subspan(static_cast<std::size_t>(written));
  }
  return true;
}

// False where the file ends before, or cannot be read (errno is then not 0).
bool read_whole(int descriptor, std::span<std::byte> bytes) {
  while (!bytes.empty()) {
    errno = 0;
    const ssize_t count = ::read(descriptor, bytes.data(), bytes.size());
    if (count < 0 && errno == EINTR) continue;
    if (count <= 0) return false;
    bytes = bytes.subspan(static_cast<std::size_t>(count));
  }
  return true;
}

// Like mkdir -p; errno tells why not.
bool make_folders(const std::string& path) {
  for (std::size_t end = path.find('/', 1);; end = path.find('/', end + 1)) {
    const std::string part = path.substr(0, end);
    if (::mkdir(part.c_str(), 0755) != 0 && errno != EEXIST && end == std::string::npos) {
      return false;
    }
    if (end == std::string::npos) return true;
  }
}

}  // namespace

StateFile::StateFile(std::string folder) : folder_(std::move(folder)) {}

StateFile::Failure StateFile::open_folder(bool may_make) {
  if (descriptor_.is_open()) return {};
  constexpr int flags = O_RDONLY | O_DIRECTORY | O_CLOEXEC;
  FileDescriptor opened(::open(folder_.c_str(), flags));
  if (!opened.is_open() && errno == ENOENT && may_make) {
    if (!make_folders(folder_)) return {"cannot make the folder", errno};
    opened = FileDescriptor(::open(folder_.c_str(), flags));
  }
  if (!opened.is_open()) return {"cannot open the folder", errno};
  // Two gateways with one folder would take each other's state.
  if (::flock(opened.get(), LOCK_EX | LOCK_NB) != 0) {
    return {"another program keeps its state there, so cannot lock the folder", errno};
  }
  descriptor_ = std::move(opened);
  return {};
}

StateFile::Found StateFile::load(Copy copy, std::vector<std::byte>& bytes, std::string& why) {
  bytes.clear();
  const auto fault = [&](Found found, std::string what) {
    why = std::move(what);
    return found;
  };
  const auto unreadable = [&](const char* action, int error) {
    if (is_out_of_descriptors(error)) {
      throw std::system_error(error, std::generic_category(), folder_ + ": " + action);
    }
    return fault(Found::unreadable, std::string(action) + ": " + std::strerror(error));
  };
  if (const Failure failure = open_folder(false); failure.action != nullptr) {
    if (failure.error == ENOENT) return Found::nothing;
    return unreadable(failure.action, failure.error);
  }
  // Without O_NONBLOCK a pipe of this name would be waited for.
  const FileDescriptor file(
      ::openat(descriptor_.get(), name_of(copy), O_RDONLY | O_NONBLOCK | O_NOCTTY | O_CLOEXEC));
  if (!file.is_open()) {
    return errno == ENOENT ? Found::nothing : unreadable("cannot open the file", errno);
  }
  struct stat status {};
  if (::fstat(file.get(), &status) != 0) return unreadable("cannot look at the file", errno);
  if (!S_ISREG(status.st_mode)) return fault(Found::broken, "is no file");
  const auto file_size = static_cast<std::uint64_t>(status.st_size);
  if (file_size < state_head_size) return fault(Found::broken, "is too short");
  Head head{};
  if (!read_whole(file.get(), head)) return unreadable("cannot read the file", errno);
  if (std::memcmp(head.data(), magic.data(), magic.size()) != 0) {
    return fault(Found::broken, "is no state of a gateway");
  }
  if (const auto layout = load_number(head, layout_at, 4); layout != head_layout) {
    return fault(Found::broken,
                 "has layout " + std::to_string(layout) + ", not " + std::to_string(head_layout));
  }
  const std::uint64_t size = load_number(head, size_at, 8);
  if (size > state_size_max) return fault(Found::broken, "says that it is too long");
  if (size != file_size - state_head_size) return fault(Found::broken, "is cut off or too long");
  bytes.resize(static_cast<std::size_t>(size));
  if (!read_whole(file.get(), bytes)) {
    bytes.clear();
    return unreadable("cannot read the file", errno);
  }
  if (checksum_of(head, bytes) != load_number(head, checksum_at, 4)) {
    bytes.clear();
    return fault(Found::broken, "is damaged: its checksum is wrong");
  }
  return Found::sound;
}

bool StateFile::move_aside(Copy copy, std::string& name) {
  for (unsigned number = 1; number <= refused_max; ++number) {
    name = "state.refused-" + std::to_string(number);
    struct stat status {};
    if (::fstatat(descriptor_.get(), name.c_str(), &status, AT_SYMLINK_NOFOLLOW) == 0) continue;
    if (errno != ENOENT) return false;
    // Nobody else makes such names: the folder is locked.
    return ::renameat(descriptor_.get(), name_of(copy), descriptor_.get(), name.c_str()) == 0;
  }
  errno = EMFILE;
  return false;
}

std::string StateFile::set_aside(Copy copy) {
  std::string name;
  bool& is_refused = is_refused_[static_cast<std::size_t>(copy)];
  is_refused = open_folder(false).action != nullptr || !move_aside(copy, name);
  return is_refused ? name_of(copy) : name;
}

StateFile::Failure StateFile::write_new(std::span<const std::byte> bytes) {
  FileDescriptor file(::openat(descriptor_.get(), new_name,
                               O_WRONLY | O_CREAT | O_TRUNC | O_NOFOLLOW | O_CLOEXEC, 0644));
  if (!file.is_open()) return {"cannot make the file", errno};
  const Head head = head_of(bytes);
  if (!write_whole(file.get(), head) || !write_whole(file.get(), bytes)) {
    return {"cannot write the file", errno};
  }
  if (::fsync(file.get()) != 0) return {"cannot sync the file", errno};
  return {};
}

// `state` becomes `state.previous`, and `state.new` becomes `state`.
StateFile::Failure StateFile::put_in_place() {
  const int folder = descriptor_.get();
  const char* const last = name_of(Copy::last);
  const char* const previous = name_of(Copy::previous);
  // Where there is no `state`, nothing takes the place of the one before.
  const auto link = [&] {
    return ::linkat(folder, last, folder, previous, 0) == 0 || errno == ENOENT;
  };
  bool is_kept = link();
  if (!is_kept && errno == EEXIST) is_kept = ::unlinkat(folder, previous, 0) == 0 && link();
  // Whatever keeps it from being linked (no links on this disk, or not to a file of another user)
  // need not keep it from being renamed.
  if (!is_kept && ::renameat(folder, last, folder, previous) != 0) {
    return {"cannot rename the file", errno};
  }
  if (::renameat(folder, new_name, folder, last) != 0) return {"cannot rename the file", errno};
  // EINVAL: a file system that cannot sync a folder.
  if (::fsync(folder) != 0 && errno != EINVAL) return {"cannot sync the folder", errno};
  return {};
}

StateFile::Failure StateFile::save(std::span<const std::byte> bytes) {
  Failure failure = open_folder(true);
  for (const Copy copy : {Copy::last, Copy::previous}) {
    if (failure.action != nullptr || !is_refused_[static_cast<std::size_t>(copy)]) continue;
    std::string name;
    if (!move_aside(copy, name) && errno != ENOENT) {
      failure = {"cannot move a refused state out of the way", errno};
    } else {
      is_refused_[static_cast<std::size_t>(copy)] = false;
    }
  }
  if (failure.action == nullptr) failure = write_new(bytes);
  if (failure.action == nullptr) failure = put_in_place();
  if (failure.action != nullptr) {
    // What is left of it would take room, where that is what is missing.
    if (descriptor_.is_open()) ::unlinkat(descriptor_.get(), new_name, 0);
    // The folder may have been replaced, or another disk put there.
    descriptor_.close();
  }
  return failure;
}

}  // namespace etcm::port

// One piece of state as a file that survives a power failure at any moment.
//
// In its folder: `state`, and `state.previous`, what it was one save earlier. A save writes
// `state.new`, syncs it, links `state` as `state.previous`, renames `state.new` to `state`, and
// syncs the folder. So from the first save on `state` is there at any moment, with the old bytes or
// the new ones, whole. A file system without hard links (vfat) has a moment between two renames in
// which only `state.previous` is there, with the old ones.
//
// A file is 24 bytes of head and the bytes that were saved. All numbers are little-endian:
//   0  "ETCMKEPT"
//   8  u32  layout of the head, 1
//   12 u32  CRC-32 (IEEE 802.3) of everything in the file but these four bytes
//   16 u64  count of the bytes that follow the head
//
// Nothing here waits for anything but the disk, and saving allocates no memory.
#pragma once

#include <array>
#include <cstddef>
#include <span>
#include <string>
#include <vector>

#include "etcm/port/store.h"
#include "posix/file_descriptor.h"

namespace etcm::port {

inline constexpr std::size_t state_head_size = 24;
// A file that says it has more is no state.
inline constexpr std::size_t state_size_max = std::size_t{1} << 28;

class StateFile {
 public:
  // Touches nothing yet. The folder is made by the first save, where there is none.
  explicit StateFile(std::string folder);

  enum class Found {
    nothing,
    sound,
    broken,      // there is a file, but not one that was saved here, or not whole
    unreadable,  // the disk or the rights do not allow to tell
  };
  // `why` says what is wrong with a broken or unreadable one. Where this program is given no more
  // descriptors it throws std::system_error: what is kept there is most likely sound, and to go on
  // without would be to forget it.
  Found load(Copy copy, std::vector<std::byte>& bytes, std::string& why);

  // Renames it to `state.refused-1`, or the first free number, and returns that name. Where that is
  // not possible, returns its name as it is: nothing is saved until it can be moved.
  std::string set_aside(Copy copy);

  struct Failure {
    const char* action = nullptr;  // null: nothing failed
    int error = 0;                 // of errno
  };
  Failure save(std::span<const std::byte> bytes);

  const std::string& folder() const { return folder_; }

 private:
  Failure open_folder(bool may_make);
  Failure write_new(std::span<const std::byte> bytes);
  Failure put_in_place();
  bool move_aside(Copy copy, std::string& name);

  std::string folder_;
  FileDescriptor descriptor_;         // of the folder, locked, while it is good
  std::array<bool, 2> is_refused_{};  // by copy: to be moved aside before a save
};

}  // namespace etcm::port

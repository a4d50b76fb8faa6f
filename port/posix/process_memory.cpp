#include "posix/process_memory.h"

#include <fcntl.h>
#include <malloc.h>

#include <array>
#include <charconv>

#include "posix/file_descriptor.h"

namespace etcm::port {

// proc(5): the second number of /proc/self/statm, in pages.
std::uint64_t resident_bytes() {
  const FileDescriptor file(::open("/proc/self/statm", O_RDONLY | O_CLOEXEC));
  if (!file.is_open()) return 0;
  std::array<char, 128> text;
  const ssize_t size = ::read(file.get(), text.data(), text.size());
  if (size <= 0) return 0;
  const char* const end = text.data() + size;
  std::uint64_t whole = 0;
  std::uint64_t resident = 0;
  const char* const behind = std::from_chars(text.data(), end, whole).ptr;
  if (behind == end || std::from_chars(behind + 1, end, resident).ec != std::errc{}) return 0;
  return resident * static_cast<std::uint64_t>(::sysconf(_SC_PAGESIZE));
}

std::uint64_t heap_bytes() {
  const struct mallinfo2 info = ::mallinfo2();
  return std::uint64_t{info.uordblks} + info.hblkhd;
}

}  // namespace etcm::port

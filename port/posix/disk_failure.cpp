#include "posix/disk_failure.h"

#include <algorithm>
#include <cerrno>
#include <cstdio>
#include <cstring>

#include "etcm/port/utf8.h"
#include "posix/exhaustion.h"

namespace etcm::port {

namespace {

// The rest of the line is shorter than the room that this leaves.
constexpr std::size_t place_bytes_max = 300;

// Null: none but to look at the place.
const char* cure_of(int error) {
  switch (error) {
    case ENOSPC:
    case EDQUOT:
      return "make room on that disk";
    case EROFS:
      return "mount that disk for writing";
    case EACCES:
    case EPERM:
      return "let the gateway's user write there";
    case EWOULDBLOCK:
      return "end the other program, or give this gateway a folder of its own";
    case EIO:
      return "the disk may be failing: replace it";
    case EMFILE:
    case ENFILE:
      return descriptors_cure;
    default:
      return nullptr;
  }
}

}  // namespace

std::string_view DiskFailure::describe(std::string_view place, const char* action, int error,
                                       const char* section) {
  // strerrordesc_np() needs no memory and no locale, unlike strerror().
  const char* const what = ::strerrordesc_np(error);
  const char* const cure = cure_of(error);
  place = cut_utf8(place, place_bytes_max);
  const int length = std::snprintf(words_.data(), words_.size(), "%.*s: %s (%s); %s%s%s",
                                   static_cast<int>(place.size()), place.data(), action,
                                   what != nullptr ? what : "unknown error",
                                   cure != nullptr ? cure : "look at `folder` of [",
                                   cure != nullptr ? "" : section, cure != nullptr ? "" : "]");
  return {words_.data(), std::min(static_cast<std::size_t>(length), words_.size() - 1)};
}

}  // namespace etcm::port

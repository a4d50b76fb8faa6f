// The system gives this program no more of what it asks for.
#pragma once

#include <cerrno>

namespace etcm::port {

// `error`: of errno.
inline bool is_out_of_descriptors(int error) { return error == EMFILE || error == ENFILE; }
inline bool is_exhaustion(int error) {
  return is_out_of_descriptors(error) || error == ENOBUFS || error == ENOMEM;
}

// What to do about the first of them.
inline constexpr const char* descriptors_cure = "raise LimitNOFILE of the service";

}  // namespace etcm::port

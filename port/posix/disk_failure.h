// What failed on a disk, as a person wants to hear it.
#pragma once

#include <array>
#include <string_view>

namespace etcm::port {

// Keeps the words of the last failure; takes no memory.
class DiskFailure {
 public:
  // "/var/lib/etcm: cannot write the file (No space left on device); make room on that disk".
  // `section` of the configuration names the place. Valid until the next call.
  std::string_view describe(std::string_view place, const char* action, int error,
                            const char* section);

 private:
  std::array<char, 512> words_;
};

}  // namespace etcm::port

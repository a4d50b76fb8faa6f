// What libFuzzer calls.
#include "fuzz_target.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  etcm::fuzz::run({data, size});
  return 0;
}

// The timed comparisons, for Google Benchmark.
#pragma once

namespace etcm::bench {

// Registers every benchmark: ours and, where it is linked, the peer's beside it on the same input.
void register_speed();

}  // namespace etcm::bench

#include "link.h"

namespace etcm::bus {

void Waiter::wait_until(port::Instant end) {
  loop_.wait(end - now());
  if (stop_.received()) throw Interrupted{};
}

}  // namespace etcm::bus

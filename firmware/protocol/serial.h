// Which node it is, wherever it answers.
#pragma once

#include "firmware/protocol/strong_id.h"

namespace etcm::firmware {

// No node has the serial 0xffffffff, which is none.
using Serial = StrongId<struct SerialTag>;

}  // namespace etcm::firmware

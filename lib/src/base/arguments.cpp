#include "base/arguments.h"

extern "C" [[gnu::weak]] void etcm_illegal_argument(etcm::Call, etcm::Fault) { __builtin_trap(); }

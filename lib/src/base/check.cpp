#include "base/check.h"

extern "C" [[gnu::weak]] void etcm_check_failed(const char*, const char*, int) { __builtin_trap(); }

// The machine that the tests run on.
#include <cstdio>

#include "console.h"

void etcm::test::put(const char* text) { std::fputs(text, stdout); }

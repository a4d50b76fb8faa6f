#include "console_c.h"

#include "console.h"

void etcm_put(const char* text) { etcm::test::put(text); }
void etcm_put_number(uint64_t value) { etcm::test::put_number(value); }
void etcm_put_hex(uint64_t value) { etcm::test::put_hex(value); }

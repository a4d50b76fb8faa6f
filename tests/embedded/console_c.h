// console.h for C programs.
#pragma once

#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

void etcm_put(const char* text);
void etcm_put_number(uint64_t value);
void etcm_put_hex(uint64_t value);

#ifdef __cplusplus
}
#endif

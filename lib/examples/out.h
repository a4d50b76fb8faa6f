// How the examples tell what they do: supplied by the machine (out_stdio.c where there is stdio).
#pragma once

#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

void out(const char* text);
void out_number(uint32_t number);

#ifdef __cplusplus
}
#endif

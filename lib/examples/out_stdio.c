#include <stdio.h>

#include "out.h"

void out(const char* text) { fputs(text, stdout); }
void out_number(uint32_t number) { printf("%lu", (unsigned long)number); }

// What the examples tell, on the console of the machine.
#include "../../lib/examples/out.h"
#include "console.h"

void out(const char* text) { etcm::test::put(text); }
void out_number(uint32_t number) { etcm::test::put_number(number); }

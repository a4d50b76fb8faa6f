// How long a unit of work takes (etcm/work.h), per kind of call.
#pragma once

#include <iosfwd>

namespace etcm::bench {

// Prints a Markdown table: over some inputs, hard ones among them, and 200 calls of each kind in
// each, the nanoseconds that a unit took: median, and at worst of calls of a thousand units and
// more. False: an input could not be built.
bool print_work_table(std::ostream& out);

}  // namespace etcm::bench

// The table of how the time of inputs and changes that could be slow grows with their size.
#pragma once

#include <iosfwd>
#include <string>

namespace etcm::bench {

// Prints a Markdown table with one row for each family whose name holds `filter`: seconds at four
// sizes, each twice the one before, and the exponent that fits them best. A size that follows one
// of more than five seconds is left out. Below it a table of the work at the smallest size, and its
// exponent: counted, so the same on every machine. Returns whether all were measured without an
// error.
bool print_cliffs(const std::string& filter, std::ostream& out);

}  // namespace etcm::bench

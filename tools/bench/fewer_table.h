// The table of what looking for fewer Steiner vertices comes to.
#pragma once

#include <iosfwd>

namespace etcm::bench {

// Prints a Markdown table with one row for each of some inputs that nothing was tuned on: what no
// mesh can do without, CGAL's count, ours as build() makes it, with the search for as long as CGAL
// takes, and with much of it. Returns whether every mesh was conforming.
bool print_fewer_table(std::ostream& out);

}  // namespace etcm::bench

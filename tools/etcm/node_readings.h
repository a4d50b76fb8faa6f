// Readings at the nodes of a graph, exactly as decimals: from a table, or from the attributes of
// its nodes.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "etcm/files/constraint_graph.h"

namespace etcm::cli {

// In units of 10^-digits, so that each is an integer of 32 bits, which is what
// etcm::interpolate() takes.
struct NodeReadings {
  std::string source;  // where they stand, as an error names it
  int digits = 0;
  std::vector<std::int32_t> values;  // by node of the graph; 0 where there is none
  std::vector<bool> is_known;
};

// From a CSV file: the number of a node, a comma, its reading, one node a line. A first line of
// names, lines that begin with '#', and empty ones do not count; nor does a line without a reading
// behind its comma. Throws InputError for anything else, for a number that no node has or that
// stands there twice, and for readings that do not fit.
NodeReadings read_node_readings(const std::string& path, const files::ConstraintGraph& graph);

// From the attributes of the graph; the first one has the number 1. Throws InputError where the
// graph has no such attribute, or values do not fit.
NodeReadings attribute_readings(const files::ConstraintGraph& graph, std::size_t number);

// A value in 2^-28 of 10^-digits, as a decimal with three digits more than the readings have, none
// of them a zero at the end. Halves go up.
std::string reading_text(std::int64_t value, int digits);

}  // namespace etcm::cli

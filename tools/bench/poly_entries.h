// Constraint graphs from files as entries of the corpus.
#pragma once

#include <string>
#include <vector>

#include "inputs/corpus.h"

namespace etcm::bench {

// Throws files::InputError where a file is wrong or its coordinates are no whole units in range.
std::vector<inputs::CorpusEntry> read_entries(const std::vector<std::string>& poly_paths);

}  // namespace etcm::bench

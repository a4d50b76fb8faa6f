// The table of Steiner counts: ours and the peer's, over the whole corpus.
#pragma once

#include <iosfwd>
#include <vector>

#include "inputs/corpus.h"

namespace etcm::bench {

// Prints a Markdown table with one row for each entry, and a summary. Every mesh of ours is
// audited. Returns whether every one of ours under the default policy ended and passed.
bool print_corpus_table(const std::vector<inputs::CorpusEntry>& entries, std::ostream& out);

}  // namespace etcm::bench

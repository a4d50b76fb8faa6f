// The figures as files, drawn by gnuplot from the CSV beside them.
#pragma once

#include <string>

namespace etcm::compare {

// Draws figure-2.svg to figure-6.svg from folder/summary.csv, and a PNG of each SVG. Throws
// files::OutputError where a program is missing or fails.
void draw_figures(const std::string& folder);

}  // namespace etcm::compare

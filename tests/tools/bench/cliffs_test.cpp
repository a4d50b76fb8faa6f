// No cliff comes back: how the work of hard inputs grows is what lib/docs/cliffs.md says. Work is
// counted, so the figures are the same on every machine, and a test of them depends on no clock.
#include <gtest/gtest.h>

#include <cctype>
#include <cstddef>
#include <fstream>
#include <sstream>
#include <string>
#include <vector>

#include "bench/cliff_families.h"

namespace etcm::bench {
namespace {

// A logarithm more than linear is 0.1 at these sizes.
constexpr double exponent_margin = 0.1;
constexpr double units_margin = 0.25;

struct Row {
  std::string name;
  Growth growth;
};

std::string next_cell(std::istream& line) {
  std::string cell;
  line.ignore(1);
  std::getline(line, cell, '|');
  if (!cell.empty()) cell.pop_back();
  return cell;
}

// In order: "the same" is what the row above is about.
std::vector<Row> rows_of_document() {
  std::ifstream document(ETCM_CLIFFS_DOCUMENT);
  std::vector<Row> rows;
  bool is_counted = false;
  for (std::string line; std::getline(document, line);) {
    if (line == "| what | n | units | exponent |") {
      is_counted = std::getline(document, line).good();
    } else if (is_counted && line.starts_with("| ")) {
      std::istringstream cells(line.substr(1));
      const std::string name = next_cell(cells), size = next_cell(cells);
      const std::string units = next_cell(cells), exponent = next_cell(cells);
      rows.push_back({name, {std::stoull(units), std::stod(exponent)}});
    } else {
      is_counted = false;
    }
  }
  return rows;
}

class Cliff : public testing::TestWithParam<std::size_t> {};

TEST_P(Cliff, GrowsAsTheDocumentSays) {
  const std::vector<Row> rows = rows_of_document();
  const CliffFamily& family = cliff_families()[GetParam()];
  ASSERT_EQ(rows.size(), cliff_families().size()) << "etcm-bench --cliffs prints the rows";
  const Row& said = rows[GetParam()];
  ASSERT_EQ(said.name, family.name);
  const Growth is = growth_of(family);
  EXPECT_NEAR(is.exponent, said.growth.exponent, exponent_margin);
  const auto units = static_cast<double>(said.growth.units);
  EXPECT_NEAR(static_cast<double>(is.units), units, units * units_margin);
}

// "the same" would be many tests of one name.
std::string name_of_test(const testing::TestParamInfo<std::size_t>& info) {
  std::string name = std::to_string(info.param + 1);
  for (const char c : std::string(cliff_families()[info.param].name)) {
    if (c == ' ') name += '_';
    if (std::isalnum(static_cast<unsigned char>(c)) != 0) name += c;
  }
  return name;
}

INSTANTIATE_TEST_SUITE_P(Families, Cliff, testing::Range(std::size_t{0}, cliff_families().size()),
                         name_of_test);

}  // namespace
}  // namespace etcm::bench

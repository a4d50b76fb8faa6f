#include "compare/report/table_text.h"

#include <iomanip>
#include <sstream>

namespace etcm::compare {

std::string decimal(double value, int digits) {
  std::ostringstream text;
  text << std::fixed << std::setprecision(digits) << value;
  return text.str();
}

std::string share(std::size_t part, std::size_t whole) {
  return part == whole ? "all" : std::to_string(part) + " of " + std::to_string(whole);
}

}  // namespace etcm::compare

#include "firmware/toml/likeliest_word.h"

#include <algorithm>
#include <cstddef>
#include <numeric>
#include <utility>

namespace etcm::firmware {

namespace {

// How many letters must be put in, taken out, replaced or exchanged with the next to make one word
// of the other.
std::size_t edit_distance(std::string_view a, std::string_view b) {
  std::vector<std::size_t> before_last(b.size() + 1);
  std::vector<std::size_t> last(b.size() + 1);
  std::vector<std::size_t> row(b.size() + 1);
  std::iota(last.begin(), last.end(), std::size_t{0});
  for (std::size_t i = 1; i <= a.size(); ++i) {
    row[0] = i;
    for (std::size_t j = 1; j <= b.size(); ++j) {
      const std::size_t replaced = last[j - 1] + (a[i - 1] == b[j - 1] ? 0 : 1);
      row[j] = std::min({replaced, last[j] + 1, row[j - 1] + 1});
      const bool is_exchanged = i > 1 && j > 1 && a[i - 1] == b[j - 2] && a[i - 2] == b[j - 1];
      if (is_exchanged) row[j] = std::min(row[j], before_last[j - 2] + 1);
    }
    std::swap(before_last, last);
    std::swap(last, row);
  }
  return last.back();
}

// The one word that begins so; empty: none, or more than one.
std::string_view only_longer(const std::vector<std::string_view>& words, std::string_view typed) {
  std::string_view found;
  for (const std::string_view word : words) {
    if (typed.size() < 2 || !word.starts_with(typed)) continue;
    if (!found.empty()) return {};
    found = word;
  }
  return found;
}

}  // namespace

std::string_view likeliest_word(const std::vector<std::string_view>& words,
                                std::string_view typed) {
  if (const std::string_view whole = only_longer(words, typed); !whole.empty()) return whole;
  std::string_view best;
  std::size_t best_distance = std::max<std::size_t>(typed.size() / 3, 1) + 1;
  for (const std::string_view word : words) {
    const std::size_t distance = edit_distance(word, typed);
    if (distance < best_distance) {
      best = word;
      best_distance = distance;
    }
  }
  return best;
}

}  // namespace etcm::firmware

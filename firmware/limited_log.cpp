#include "limited_log.h"

#include <algorithm>
#include <cstdio>
#include <cstring>

namespace etcm::firmware {

namespace {

constexpr std::size_t kinds_per_set = 8;
// So many kinds are looked at with each line, whether something about them is to be told.
constexpr std::size_t looks_per_line = 8;

bool is_digit(char c) { return c >= '0' && c <= '9'; }

// FNV-1a over the line without its details; never 0.
std::uint64_t hash_of(port::Level level, std::string_view line) {
  std::uint64_t hash = 0xcbf29ce484222325u;
  const auto add = [&](char c) { hash = (hash ^ static_cast<unsigned char>(c)) * 0x100000001b3u; };
  add(static_cast<char>(level));
  const std::size_t details = std::min(line.find('('), line.find(": "));
  for (std::size_t i = 0; i < line.size(); ++i) {
    if (i > details && is_digit(line[i])) {
      if (!is_digit(line[i - 1])) add('#');
    } else if (i <= details || (line[i] != '-' && line[i] != '.')) {
      // A sign or a decimal point is part of a number too.
      add(line[i]);
    }
  }
  return hash | 1u;
}

}  // namespace

LimitedLog::LimitedLog(port::Log& log, const port::Clock& clock)
    : log_(log), clock_(clock), kinds_(kinds_max) {}

void LimitedLog::write(port::Level level, std::string_view line) {
  const port::Instant now = clock_.now();
  tell_some(now);
  Kind& kind = kind_of(hash_of(level, line), now);
  kind.level = level;
  kind.last = now;
  end_window(kind, now);
  if (kind.lines_left > 0) {
    --kind.lines_left;
    return log_.write(level, line);
  }
  ++kind.left_out;
  kind.sample_size = static_cast<std::uint8_t>(std::min(line.size(), kind.sample.size()));
  std::copy_n(line.begin(), kind.sample_size, kind.sample.begin());
}

void LimitedLog::flush() {
  const port::Instant now = clock_.now();
  for (Kind& kind : kinds_) tell(kind, now);
}

// The record of a kind, a fresh one where it has none.
LimitedLog::Kind& LimitedLog::kind_of(std::uint64_t hash, port::Instant now) {
  const auto set = static_cast<std::size_t>((hash >> 32) % (kinds_max / kinds_per_set));
  const std::size_t first = set * kinds_per_set;
  const auto begin = kinds_.begin() + static_cast<std::ptrdiff_t>(first);
  const auto end = begin + kinds_per_set;
  const auto found = std::find_if(begin, end, [&](const Kind& kind) { return kind.hash == hash; });
  if (found != end) return *found;
  const auto by_age = [](const Kind& a, const Kind& b) { return a.last < b.last; };
  Kind& oldest = *std::min_element(begin, end, by_age);
  tell(oldest, now);
  oldest = {.hash = hash, .window_start = now, .window = first_window, .lines_left = lines_free};
  return oldest;
}

void LimitedLog::tell(Kind& kind, port::Instant now) {
  if (kind.left_out == 0) return;
  const bool is_cut = kind.sample_size == kind.sample.size();
  const auto minutes = std::chrono::ceil<std::chrono::minutes>(now - kind.window_start).count();
  std::array<char, 256> text{};
  const int length = std::snprintf(
      text.data(), text.size(), "%.*s%s [left out: %u like this in the last %lld min]",
      static_cast<int>(kind.sample_size), kind.sample.data(), is_cut ? "..." : "", kind.left_out,
      static_cast<long long>(minutes));
  kind.left_out = 0;
  log_.write(kind.level,
             {text.data(), std::min(static_cast<std::size_t>(length), text.size() - 1)});
}

void LimitedLog::end_window(Kind& kind, port::Instant now) {
  if (now - kind.window_start < kind.window) return;
  const bool was_noisy = kind.left_out > 0;
  tell(kind, now);
  kind.window = was_noisy ? std::min(2 * kind.window, longest_window) : first_window;
  kind.lines_left = was_noisy ? 1 : lines_free;
  kind.window_start = now;
}

// Noise that has stopped is told too, once its window is over and somebody writes anything.
void LimitedLog::tell_some(port::Instant now) {
  for (std::size_t i = 0; i < looks_per_line; ++i) {
    Kind& kind = kinds_[next_told_];
    next_told_ = (next_told_ + 1) % kinds_.size();
    if (kind.left_out > 0) end_window(kind, now);
  }
}

}  // namespace etcm::firmware

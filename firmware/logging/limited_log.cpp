#include "firmware/logging/limited_log.h"

#include <algorithm>
#include <cinttypes>
#include <cstdio>
#include <span>
#include <tuple>

#include "etcm/port/utf8.h"

namespace etcm::firmware {

namespace {

constexpr std::size_t set_size = 8;
// So many kinds are looked at with each line, whether something about them is to be told.
constexpr std::size_t looks_per_line = 8;

bool is_digit(char c) { return c >= '0' && c <= '9'; }

// Behind the name that a number has there: " 'pump house'". `at` where it has none.
std::size_t name_end(std::string_view line, std::size_t at) {
  if (!line.substr(at).starts_with(" '")) return at;
  for (std::size_t i = at + 2; i < line.size(); ++i) {
    const bool ends = i + 1 == line.size() ||
                      std::string_view(" ,:;)]").find(line[i + 1]) != std::string_view::npos;
    if (line[i] == '\'' && ends) return i + 1;
  }
  return at;
}

// FNV-1a over the line without the numbers behind `details`, and the names of these; never 0.
std::uint64_t hash_of(port::Level level, std::string_view line, std::size_t details) {
  std::uint64_t hash = 0xcbf29ce484222325u;
  const auto add = [&](char c) { hash = (hash ^ static_cast<unsigned char>(c)) * 0x100000001b3u; };
  add(static_cast<char>(level));
  for (std::size_t i = 0; i < line.size(); ++i) {
    if (i >= details && is_digit(line[i])) {
      if (i == 0 || !is_digit(line[i - 1])) add('#');
      i = name_end(line, i + 1) - 1;
    } else if (i < details || (line[i] != '-' && line[i] != '.')) {
      // A sign or a decimal point is part of a number too.
      add(line[i]);
    }
  }
  return hash | 1u;
}

std::size_t details_of(std::string_view line) { return std::min(line.find('('), line.find(": ")); }

// Where a record with this hash may be, of the first `count`.
template <class Record>
std::span<Record> set_of(std::vector<Record>& records, std::uint64_t hash, std::size_t count) {
  return std::span(records).subspan(
      static_cast<std::size_t>(hash >> 32) % (count / set_size) * set_size, set_size);
}

template <class Record>
Record* find(std::span<Record> set, std::uint64_t hash) {
  const auto found = std::find_if(set.begin(), set.end(),
                                  [&](const Record& record) { return record.hash == hash; });
  return found == set.end() ? nullptr : &*found;
}

}  // namespace

LimitedLog::LimitedLog(port::Log& log, const port::Clock& clock)
    : log_(log), clock_(clock), kinds_(kinds_max), patterns_(patterns_max + 1) {}

void LimitedLog::write(port::Level level, std::string_view line) {
  // Who asks for them wants all.
  if (level == port::Level::detail) return log_.write(level, line);
  const port::Instant now = clock_.now();
  tell_some(now);
  const std::uint64_t pattern_hash = hash_of(level, line, 0);
  Record& pattern = pattern_of(pattern_hash, level, now);
  bool is_new = false;
  if (Record* const kind = kind_of(hash_of(level, line, details_of(line)), now, is_new)) {
    kind->pattern = pattern_hash;
    kind->level = level;
    kind->last = now;
    end_kind(*kind, now);
    if (kind->lines_left == 0) return kind->leave_out(line, 1);
    --kind->lines_left;
  }
  if (!pattern.take_line(is_new)) return pattern.leave_out(line, 1);
  log_.write(level, line);
}

void LimitedLog::flush() {
  const port::Instant now = clock_.now();
  for (Record& kind : kinds_) tell_kind(kind, now);
  for (Record& pattern : patterns_) tell_pattern(pattern, now);
}

void LimitedLog::Record::leave_out(std::string_view line, std::uint32_t count) {
  left_out += count;
  const std::string_view fits = port::cut_utf8(line, sample.size());
  is_sample_cut = fits.size() < line.size();
  sample_size = static_cast<std::uint8_t>(fits.size());
  std::copy(fits.begin(), fits.end(), sample.begin());
}

bool LimitedLog::Record::take_line(bool is_new) {
  if (lines_left <= (is_new ? 0 : lines_kept)) return false;
  --lines_left;
  return true;
}

void LimitedLog::Record::begin_window(port::Instant now, bool was_noisy) {
  window_start = now;
  window = was_noisy ? std::min(2 * window, longest_window) : first_window;
}

// The record of a pattern, in a window that is not over.
LimitedLog::Record& LimitedLog::pattern_of(std::uint64_t hash, port::Level level,
                                           port::Instant now) {
  const std::span<Record> set = set_of(patterns_, hash, patterns_max);
  Record* pattern = find(set, hash);
  if (pattern == nullptr) {
    const auto spent = std::find_if(set.begin(), set.end(),
                                    [&](const Record& record) { return record.is_spent(now); });
    pattern = spent != set.end() ? &*spent : &patterns_.back();
    if (spent != set.end()) *pattern = {.hash = hash};
  }
  pattern->level = level;
  end_pattern(*pattern, now);
  return *pattern;
}

// The record of a kind, a fresh one where it has none; null where there is no room for one. It is
// new where nothing of it can have been forgotten.
LimitedLog::Record* LimitedLog::kind_of(std::uint64_t hash, port::Instant now, bool& is_new) {
  const std::span<Record> set = set_of(kinds_, hash, kinds_max);
  if (Record* const kind = find(set, hash)) {
    is_new = kind->is_spent(now);
    return kind;
  }
  // What is spent goes first, then whatever was quiet for longest and has nothing to tell.
  const auto rank = [&](const Record& kind) {
    return std::tuple(kind.left_out > 0, !kind.is_spent(now), kind.last);
  };
  Record& oldest = *std::min_element(
      set.begin(), set.end(), [&](const Record& a, const Record& b) { return rank(a) < rank(b); });
  if (oldest.left_out > 0) return nullptr;
  is_new = oldest.is_spent(now);
  oldest = {.hash = hash};
  return &oldest;
}

void LimitedLog::end_pattern(Record& pattern, port::Instant now) {
  if (!pattern.is_over(now)) return;
  const bool was_noisy = pattern.left_out > 0;
  tell_pattern(pattern, now);
  pattern.begin_window(now, was_noisy);
  pattern.lines_left = was_noisy ? pattern_lines_noisy : pattern_lines_free;
  pattern.lines_kept = pattern.lines_left / 2;
}

void LimitedLog::end_kind(Record& kind, port::Instant now) {
  if (!kind.is_over(now)) return;
  const bool was_noisy = kind.left_out > 0;
  tell_kind(kind, now);
  kind.begin_window(now, was_noisy);
  kind.lines_left = was_noisy ? 1 : lines_free;
}

void LimitedLog::tell_pattern(Record& pattern, port::Instant now) {
  tell(pattern,
       &pattern == &patterns_.back() ? "of too many kinds to tell apart"
                                     : "like this, whatever their numbers,",
       now);
}

// Where its pattern has had its lines, what was left out of it becomes the pattern's.
void LimitedLog::tell_kind(Record& kind, port::Instant now) {
  if (kind.left_out == 0) return;
  Record& pattern = pattern_of(kind.pattern, kind.level, now);
  if (pattern.take_line(false)) return tell(kind, "like this", now);
  pattern.leave_out({kind.sample.data(), kind.sample_size}, kind.left_out);
  kind.left_out = 0;
}

void LimitedLog::tell(Record& record, const char* likeness, port::Instant now) {
  if (record.left_out == 0) return;
  const auto minutes = std::chrono::ceil<std::chrono::minutes>(now - record.window_start).count();
  std::array<char, 256> text{};
  const int length = std::snprintf(
      text.data(), text.size(), "%.*s%s [left out: %" PRIu32 " %s in the last %lld min]",
      static_cast<int>(record.sample_size), record.sample.data(), record.is_sample_cut ? "..." : "",
      record.left_out, likeness, static_cast<long long>(minutes));
  record.left_out = 0;
  log_.write(record.level,
             {text.data(), std::min(static_cast<std::size_t>(length), text.size() - 1)});
}

// Noise that has stopped is told too, once its window is over and somebody writes anything.
void LimitedLog::tell_some(port::Instant now) {
  for (std::size_t i = 0; i < looks_per_line; ++i) {
    Record& kind = kinds_[next_kind_];
    next_kind_ = (next_kind_ + 1) % kinds_.size();
    if (kind.left_out > 0) end_kind(kind, now);
  }
  Record& pattern = patterns_[next_pattern_];
  next_pattern_ = (next_pattern_ + 1) % patterns_.size();
  if (pattern.left_out > 0) end_pattern(pattern, now);
}

}  // namespace etcm::firmware

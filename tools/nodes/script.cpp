#include "script.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <fstream>
#include <stdexcept>
#include <string_view>
#include <unordered_map>
#include <utility>

namespace etcm::nodes {

namespace {

constexpr std::string_view header = "time_ms,serial,event,x,y";
constexpr std::size_t column_count = 5;

class LineReader {
 public:
  explicit LineReader(const std::string& path) : path_(path), file_(path) {
    if (!file_) throw std::runtime_error(path + ": cannot be read; check the path");
  }

  bool next() {
    ++number_;
    if (!std::getline(file_, line_)) return false;
    if (!line_.empty() && line_.back() == '\r') line_.pop_back();
    return true;
  }

  std::string_view line() const { return line_; }

  [[noreturn]] void fail(const std::string& what) const {
    throw std::runtime_error(path_ + ":" + std::to_string(number_) + ": " + what);
  }

  std::array<std::string_view, column_count> columns() const {
    std::array<std::string_view, column_count> found;
    std::string_view rest = line_;
    for (std::size_t i = 0; i < column_count; ++i) {
      const std::size_t comma = rest.find(',');
      found[i] = rest.substr(0, comma);
      const bool is_last = i + 1 == column_count;
      if ((comma == std::string_view::npos) != is_last) {
        fail("not five columns; write " + std::string(header));
      }
      if (!is_last) rest.remove_prefix(comma + 1);
    }
    return found;
  }

  template <class Number>
  Number number(std::string_view text, const char* column) const {
    Number value{};
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
    if (error != std::errc{} || end != text.data() + text.size()) {
      fail(std::string(column) + " '" + std::string(text) + "' is not a whole number in range");
    }
    return value;
  }

 private:
  std::string path_;
  std::ifstream file_;
  std::string line_;
  std::size_t number_ = 0;
};

constexpr std::array<std::pair<std::string_view, Action>, 19> action_words{{
    {"join", Action::join},
    {"move", Action::move},
    {"silent", Action::silent},
    {"leave", Action::leave},
    {"unit", Action::unit},
    {"twin", Action::twin},
    {"jitter", Action::jitter},
    {"drift", Action::drift},
    {"no_fix", Action::no_fix},
    {"low_battery", Action::low_battery},
    {"boot", Action::boot},
    {"exception", Action::exception},
    {"torn", Action::torn},
    {"late", Action::late},
    {"garbled", Action::garbled},
    {"truncated", Action::truncated},
    {"wrong_unit", Action::wrong_unit},
    {"noise", Action::noise},
    {"sound", Action::sound},
}};

bool has_position(Action action) {
  return action == Action::join || action == Action::move || action == Action::twin ||
         action == Action::drift;
}

bool has_value(Action action) {
  return action == Action::exception || action == Action::late || action == Action::unit ||
         action == Action::jitter;
}

Action parse_action(const LineReader& reader, std::string_view text) {
  std::string list;
  for (const auto& [word, action] : action_words) {
    if (word == text) return action;
    list += (list.empty() ? "" : ", ") + std::string(word);
  }
  reader.fail("event '" + std::string(text) + "' is unknown; write one of " + list);
}

}  // namespace

Script read_script(const std::string& path) {
  LineReader reader(path);
  if (!reader.next() || reader.line() != header) {
    reader.fail("the first line must be " + std::string(header));
  }
  Script script;
  std::unordered_map<std::uint32_t, std::uint32_t> node_of;
  while (reader.next()) {
    if (reader.line().empty() || reader.line().front() == '#') continue;
    const auto column = reader.columns();
    Event event;
    event.time_ms = reader.number<std::uint32_t>(column[0], "time_ms");
    const auto serial = reader.number<std::uint32_t>(column[1], "serial");
    event.action = parse_action(reader, column[2]);
    if (has_position(event.action)) {
      event.position = {.x = reader.number<std::int32_t>(column[3], "x"),
                        .y = reader.number<std::int32_t>(column[4], "y")};
    } else if (has_value(event.action)) {
      event.value = reader.number<std::uint16_t>(column[3], "x");
    }
    if (event.action == Action::unit && (event.value < 1 || event.value > 247)) {
      reader.fail("x '" + std::string(column[3]) + "' is no unit; give 1 to 247");
    }
    if (event.action == Action::twin) {
      event.node = static_cast<std::uint32_t>(script.serials.size());
      script.serials.push_back(serial);
      script.events.push_back(event);
      continue;
    }
    const auto [entry, is_new] =
        node_of.emplace(serial, static_cast<std::uint32_t>(script.serials.size()));
    if (is_new) script.serials.push_back(serial);
    event.node = entry->second;
    script.events.push_back(event);
  }
  std::stable_sort(script.events.begin(), script.events.end(),
                   [](const Event& a, const Event& b) { return a.time_ms < b.time_ms; });
  return script;
}

}  // namespace etcm::nodes

#include "section.h"

#include <algorithm>
#include <numeric>

namespace etcm::firmware {

namespace {

using namespace std::chrono_literals;

constexpr port::Duration duration_max = 24h;

std::string place_of(const std::string& file, const toml::node& node) {
  return file + ":" + std::to_string(node.source().begin.line);
}

// How many letters must be put in, taken out or exchanged to make one word of the other.
std::size_t edit_distance(std::string_view a, std::string_view b) {
  std::vector<std::size_t> row(b.size() + 1);
  std::iota(row.begin(), row.end(), std::size_t{0});
  for (std::size_t i = 0; i < a.size(); ++i) {
    std::size_t diagonal = std::exchange(row[0], i + 1);
    for (std::size_t j = 0; j < b.size(); ++j) {
      const std::size_t replaced = diagonal + (a[i] == b[j] ? 0 : 1);
      diagonal = row[j + 1];
      row[j + 1] = std::min({replaced, row[j] + 1, row[j + 1] + 1});
    }
  }
  return row.back();
}

// The word that was most likely meant, or an empty one.
std::string likeliest(const std::set<std::string>& words, std::string_view typed) {
  std::string best;
  std::size_t best_distance = std::max<std::size_t>(typed.size() / 3, 1) + 1;
  for (const std::string& word : words) {
    const std::size_t distance = edit_distance(word, typed);
    if (distance < best_distance) {
      best = word;
      best_distance = distance;
    }
  }
  return best;
}

}  // namespace

const toml::node* Section::find(const std::string& key) {
  known_.insert(key);
  return table_.get(key);
}

void Section::mistake(const toml::node& node, const std::string& what) {
  mistakes_.push_back(place_of(file_, node) + ": " + what);
}

void Section::require(const std::string& key, const std::string& example) {
  if (find(key) == nullptr) {
    mistake(table_, in_section("'" + key + "' is missing") + "; add it, such as " + example);
  }
}

void Section::read(const std::string& key, std::string& value, const std::string& example) {
  const toml::node* node = find(key);
  if (node == nullptr) return;
  if (const auto found = node->value_exact<std::string>(); found && !found->empty()) {
    value = *found;
  } else {
    mistake(*node, "'" + key + "' must be a text; write it as " + example);
  }
}

void Section::read(const std::string& key, port::SocketAddress& value) {
  const toml::node* node = find(key);
  if (node == nullptr) return;
  const auto text = node->value_exact<std::string>();
  const auto found = text ? port::parse_socket_address(*text) : std::nullopt;
  if (found) {
    value = *found;
  } else {
    mistake(*node, "'" + key + "' is no address; write it as \"127.0.0.1:502\"");
  }
}

void Section::read(const std::string& key, port::Duration& value, port::Duration least) {
  const toml::node* node = find(key);
  if (node == nullptr) return;
  const auto text = node->value_exact<std::string>();
  const auto found = text ? parse_duration(*text) : std::nullopt;
  if (!found) {
    mistake(*node, "'" + key + "' is no duration; write it as \"500ms\", \"2s\" or \"5min\"");
  } else if (*found > duration_max) {
    mistake(*node, "'" + key + "' is longer than a day; give less");
  } else if (*found < least) {
    mistake(*node,
            "'" + key + "' is too short; give at least \"" + std::to_string(least / 1ms) + "ms\"");
  } else {
    value = *found;
  }
}

void Section::read(const std::string& key, std::uint32_t& value, std::uint32_t least,
                   std::uint32_t most) {
  const toml::node* node = find(key);
  if (node == nullptr) return;
  const auto found = node->value_exact<std::int64_t>();
  if (found && *found >= least && *found <= most) {
    value = static_cast<std::uint32_t>(*found);
  } else {
    mistake(*node, "'" + key + "' is out of range; give a whole number from " +
                       std::to_string(least) + " to " + std::to_string(most));
  }
}

void Section::read(const std::string& key, bool& value) {
  const toml::node* node = find(key);
  if (node == nullptr) return;
  if (const auto found = node->value_exact<bool>()) {
    value = *found;
  } else {
    mistake(*node, "'" + key + "' must be true or false; write it as " + key + " = true");
  }
}

void Section::read(const std::string& key, std::optional<LineSettings>& value) {
  if (find(key) == nullptr) return;
  LineSettings line;
  read(key, line.place, key + " = \"LINE_NAME\"");
  line.is_active_low = line.place.starts_with('!');
  if (line.is_active_low) line.place.erase(0, 1);
  value = line;
}

void Section::each(const std::string& key, const std::function<void(Section&)>& each_table) {
  const toml::node* node = find(key);
  if (node == nullptr) return;
  const toml::array* tables = node->as_array();
  const std::size_t bracket = name_.find(']');
  const std::string within =
      name_.empty() ? "" : name_.substr(name_.rfind('[') + 1, bracket - name_.rfind('[') - 1) + ".";
  const std::string name = "[[" + within + key + "]]";
  if (tables == nullptr || !tables->is_array_of_tables()) {
    mistake(*node, "'" + key + "' must be a list of tables; begin each with " + name);
    return;
  }
  for (const toml::node& element : *tables) {
    Section section(file_, *element.as_table(), name, mistakes_);
    each_table(section);
    section.finish();
  }
}

void Section::sub(const std::string& key, const std::function<void(Section&)>& table) {
  const toml::node* node = find(key);
  if (node == nullptr) return;
  if (!node->is_table()) {
    mistake(*node, "'" + key + "' must be a table; begin it with [" + key + "]");
    return;
  }
  Section section(file_, *node->as_table(), "[" + key + "]", mistakes_);
  table(section);
  section.finish();
}

void Section::finish() {
  for (const auto& [key, node] : table_) {
    const std::string typed(key.str());
    if (known_.contains(typed)) continue;
    std::string list;
    for (const std::string& name : known_) list += (list.empty() ? "" : ", ") + name;
    const std::string meant = likeliest(known_, typed);
    mistakes_.push_back(file_ + ":" + std::to_string(key.source().begin.line) + ": " +
                        in_section("'" + typed + "' is unknown") + "; " +
                        (meant.empty() ? "" : "did you mean '" + meant + "'? ") +
                        "known here: " + list);
  }
}

std::string Section::place() const { return place_of(file_, table_); }

std::string Section::in_section(const std::string& what) const {
  return name_.empty() ? what : what + " in " + name_;
}

}  // namespace etcm::firmware

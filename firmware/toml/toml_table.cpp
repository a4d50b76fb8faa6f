#include "firmware/toml/toml_table.h"

#include <charconv>
#include <string_view>

#include "firmware/toml/likeliest_word.h"

namespace etcm::firmware {

namespace {

using namespace std::chrono_literals;

constexpr port::Duration duration_max = 24h;

// Nothing for anything that is no duration.
std::optional<port::Duration> parse_duration(const std::string& text) {
  std::int64_t count = 0;
  const char* end = text.data() + text.size();
  const auto [unit, error] = std::from_chars(text.data(), end, count);
  // In the largest unit this is far from overflow.
  if (error != std::errc{} || count < 0 || count > 86'400'000) return std::nullopt;
  const std::string_view name(unit, static_cast<std::size_t>(end - unit));
  if (name == "ms") return std::chrono::milliseconds(count);
  if (name == "s") return std::chrono::seconds(count);
  if (name == "min") return std::chrono::minutes(count);
  return std::nullopt;
}

std::string place_of(const std::string& file, const toml::node& node) {
  return file + ":" + std::to_string(node.source().begin.line);
}

}  // namespace

void keep_to_lines(std::vector<std::string>& mistakes, std::size_t from) {
  for (; from < mistakes.size(); ++from) {
    for (char& c : mistakes[from]) {
      if (static_cast<unsigned char>(c) < ' ' || c == '\x7f') c = '?';
    }
  }
}

const toml::node* TomlTable::find(const std::string& key) {
  known_.insert(key);
  return table_.get(key);
}

void TomlTable::mistake(const toml::node& node, const std::string& what) {
  mistakes_.push_back(place_of(file_, node) + ": " + what);
}

void TomlTable::require(const std::string& key, const std::string& example) {
  if (find(key) == nullptr) {
    mistake(table_, in_toml_table("'" + key + "' is missing") + "; add it, such as " + example);
  }
}

void TomlTable::each(const std::string& key, const std::function<void(TomlTable&)>& each_table) {
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
    TomlTable toml_table(file_, *element.as_table(), name, mistakes_);
    each_table(toml_table);
    toml_table.finish();
  }
}

void TomlTable::sub(const std::string& key, const std::function<void(TomlTable&)>& table) {
  const toml::node* node = find(key);
  if (node == nullptr) return;
  if (!node->is_table()) {
    mistake(*node, "'" + key + "' must be a table; begin it with [" + key + "]");
    return;
  }
  TomlTable toml_table(file_, *node->as_table(), "[" + key + "]", mistakes_);
  table(toml_table);
  toml_table.finish();
}

TomlTable TomlTable::inner(const std::string& key, const toml::table& table) {
  return {file_, table, "'" + key + "' of " + name_, mistakes_};
}

std::optional<port::Duration> TomlTable::duration(const std::string& key) {
  const toml::node* const node = find(key);
  if (node == nullptr) return std::nullopt;
  const auto text = node->value_exact<std::string>();
  const auto found = text ? parse_duration(*text) : std::nullopt;
  if (found && *found <= duration_max) return found;
  mistake(*node, "'" + key + "' " +
                     (found ? "is longer than a day; give less"
                            : "is no duration; write it as \"500ms\", \"2s\" or \"5min\""));
  return std::nullopt;
}

void TomlTable::finish() {
  for (const auto& [key, node] : table_) {
    const std::string typed(key.str());
    if (known_.contains(typed)) continue;
    std::string list;
    for (const std::string& name : known_) list += (list.empty() ? "" : ", ") + name;
    const std::string meant(likeliest_word({known_.begin(), known_.end()}, typed));
    mistakes_.push_back(file_ + ":" + std::to_string(key.source().begin.line) + ": " +
                        in_toml_table("'" + typed + "' is unknown") + "; " +
                        (meant.empty() ? "" : "did you mean '" + meant + "'? ") +
                        "known here: " + list);
  }
}

std::string TomlTable::place() const { return place(table_); }

std::string TomlTable::place(const toml::node& node) const { return place_of(file_, node); }

std::string TomlTable::in_toml_table(const std::string& what) const {
  return name_.empty() ? what : what + " in " + name_;
}

}  // namespace etcm::firmware

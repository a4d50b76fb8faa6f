// One table of the configuration file: hands out its values, each checked where it is read, and
// knows at the end which keys nobody asked for.
#pragma once

#include <toml++/toml.h>

#include <cstdint>
#include <functional>
#include <initializer_list>
#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "etcm/port/clock.h"
#include "etcm/port/socket_address.h"
#include "settings.h"

namespace etcm::firmware {

class Section {
 public:
  // `file` is its path, `name` what a person calls the table ("[poll]"; empty for the whole file).
  // All but `name` must outlive this. Each mistake is one line "file:line: what; the cure".
  Section(const std::string& file, const toml::table& table, std::string name,
          std::vector<std::string>& mistakes)
      : file_(file), table_(table), name_(std::move(name)), mistakes_(mistakes) {}

  // The value of a key, or null. A key that was asked for is a known one.
  const toml::node* find(const std::string& key);

  void mistake(const toml::node& node, const std::string& what);
  void require(const std::string& key, const std::string& example);

  // These leave `value` alone where the key is not there, or is wrong.
  void read(const std::string& key, std::string& value, const std::string& example);
  void read(const std::string& key, port::SocketAddress& value);
  void read(const std::string& key, port::Duration& value, port::Duration least);
  void read(const std::string& key, std::uint32_t& value, std::uint32_t least, std::uint32_t most);
  void read(const std::string& key, bool& value);
  // A line of the board; "!" before it: active when low.
  void read(const std::string& key, std::optional<LineSettings>& value);
  // One of a few words.
  template <class Value>
  void read(const std::string& key, Value& value,
            std::initializer_list<std::pair<std::string_view, Value>> words) {
    const toml::node* node = find(key);
    if (node == nullptr) return;
    const auto text = node->value_exact<std::string>();
    std::string list;
    for (const auto& [word, meaning] : words) {
      if (text && *text == word) {
        value = meaning;
        return;
      }
      list += (list.empty() ? "\"" : ", \"") + std::string(word) + "\"";
    }
    mistake(*node, (text ? key + " '" + *text + "' is unknown" : "'" + key + "' must be a text") +
                       "; write one of " + list);
  }

  // Calls `each_table` for each table of an array of tables.
  void each(const std::string& key, const std::function<void(Section&)>& each_table);
  void sub(const std::string& key, const std::function<void(Section&)>& table);

  // Reports keys that mean nothing: most are misspelt.
  void finish();

  // "file:line" of the table.
  std::string place() const;
  const toml::table& table() const { return table_; }
  std::size_t mistake_count() const { return mistakes_.size(); }

 private:
  std::string in_section(const std::string& what) const;

  const std::string& file_;
  const toml::table& table_;
  std::string name_;
  std::vector<std::string>& mistakes_;
  std::set<std::string> known_;
};

}  // namespace etcm::firmware

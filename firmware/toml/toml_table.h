// One table of the configuration file: hands out its values, collects what is wrong with them, and
// knows at the end which keys were not asked for.
#pragma once

#include <toml++/toml.h>

#include <functional>
#include <optional>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "etcm/port/clock.h"

namespace etcm::firmware {

// What was read may stand in a mistake: its control characters become '?', so that each, from this
// one on, is the one line that it is promised to be.
void keep_to_lines(std::vector<std::string>& mistakes, std::size_t from = 0);

class TomlTable {
 public:
  // `file` is its path, `name` what a person calls the table ("[poll]"; empty for the whole file).
  // All but `name` must outlive this. Each mistake is one line "file:line: what; the cure".
  TomlTable(const std::string& file, const toml::table& table, std::string name,
            std::vector<std::string>& mistakes)
      : file_(file), table_(table), name_(std::move(name)), mistakes_(mistakes) {}

  // The value of a key, or null. A key that was asked for is a known one.
  const toml::node* find(const std::string& key);

  void mistake(const toml::node& node, const std::string& what);
  void require(const std::string& key, const std::string& example);

  // Calls `each_table` for each table of an array of tables.
  void each(const std::string& key, const std::function<void(TomlTable&)>& each_table);
  void sub(const std::string& key, const std::function<void(TomlTable&)>& table);

  // A table that is the value of `key`, or one of several.
  TomlTable inner(const std::string& key, const toml::table& table);

  // "500ms", "2s", "5min", at most a day. Nothing where the key is not there or after a mistake.
  std::optional<port::Duration> duration(const std::string& key);

  // Reports keys that mean nothing: most are misspelt.
  void finish();

  // "file:line" of the table, and of a node in it.
  std::string place() const;
  std::string place(const toml::node& node) const;
  const toml::table& table() const { return table_; }

 private:
  std::string in_toml_table(const std::string& what) const;

  const std::string& file_;
  const toml::table& table_;
  std::string name_;
  std::vector<std::string>& mistakes_;
  std::set<std::string> known_;
};

}  // namespace etcm::firmware

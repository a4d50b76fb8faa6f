#include "firmware/config/settings_text.h"

#include <cctype>
#include <cstddef>
#include <sstream>

#include "firmware/config/settings_keys.h"

namespace etcm::firmware {

namespace {

constexpr std::size_t width_max = 100;

std::string range_text(const Key& key) {
  return key.range != nullptr ? key.range : range_of(key.type);
}

// With 16777216 as "16 777 216".
std::string grouped(std::string text) {
  std::size_t end = text.size();
  while (end > 0) {
    std::size_t first = end;
    while (first > 0 && std::isdigit(static_cast<unsigned char>(text[first - 1])) != 0) --first;
    for (std::size_t at = end; end - first > 4 && at > first + 3; at -= 3) text.insert(at - 3, " ");
    end = first == end ? first - 1 : first;
  }
  return text;
}

// Markdown as plain text: `code` without its marks, of [words](to) the words.
std::string plain(const std::string& markdown) {
  std::string text;
  for (std::size_t i = 0; i < markdown.size(); ++i) {
    const std::size_t link = markdown[i] == ']' ? i + 1 : markdown.size();
    if (markdown[i] == '`') continue;
    if (link < markdown.size() && markdown[link] == '(') {
      text.erase(text.rfind('['), 1);
      i = markdown.find(')', link);
      continue;
    }
    text += markdown[i];
  }
  return text;
}

std::string sentence(const char* markdown) {
  std::string text = plain(markdown);
  text.front() = static_cast<char>(std::toupper(static_cast<unsigned char>(text.front())));
  return text + ".";
}

// Lines of a comment.
std::string comment(const std::string& text) {
  std::istringstream words(text);
  std::string lines;
  std::string line = "#";
  for (std::string word; words >> word;) {
    if (line.size() + 1 + word.size() > width_max) {
      lines += line + "\n";
      line = "#";
    }
    line += " " + word;
  }
  return lines + line + "\n";
}

std::string facts(const Key& key) {
  std::string text = "(" + plain(range_text(key));
  if (key.standard.kind == Standard::Kind::unset) {
    text += std::string("; default: ") + plain(key.standard.words);
  } else if (key.standard.kind != Standard::Kind::value) {
    text += "; " + plain(key.standard.words);
  }
  switch (key.effect) {
    case Effect::at_once:
      return text + "; changes at a reload)";
    case Effect::additions:
      return text + "; more at a reload, less needs a restart)";
    case Effect::restart:
      return text + "; needs a restart)";
  }
  return text;
}

std::string printed(const Key& key, bool is_active) {
  return comment(sentence(key.text)) + comment(facts(key)) + (is_active ? "" : "#") + key.name +
         " = " + key.standard.toml + "\n";
}

bool is_needed(const Key& key) {
  return key.standard.kind == Standard::Kind::required ||
         key.standard.kind == Standard::Kind::conditional;
}

// A bus needs its link, so there is one of each kind: the first in use, the second without what
// the first has told.
std::string printed_buses(const KeyTable& table) {
  std::string text = heading_of(table) + "\n";
  for (const Key& key : table.keys) {
    if (is_key_of(key, BusKind::tcp)) text += printed(key, is_needed(key));
  }
  for (const KeyTable& nested : key_tables()) {
    if (!std::string_view(nested.name).starts_with(std::string(table.name) + ".")) continue;
    text += "\n" + comment(sentence(nested.text)) + "#" + heading_of(nested) + "\n";
    for (const Key& key : nested.keys) text += printed(key, false);
  }
  text += "\n" + comment("One on a serial port; it may have the other keys of the first one too.") +
          "#" + heading_of(table) + "\n";
  for (const Key& key : table.keys) {
    if (is_key_of(key, BusKind::rtu) && (is_needed(key) || key.bus == BusKind::rtu)) {
      text += printed(key, false);
    }
  }
  return text;
}

std::string printed(const KeyTable& table) {
  std::string keys;
  if (*table.name == '\0') {
    for (const Key& key : table.keys) keys += "\n" + printed(key, false);
    return keys;
  }
  const std::string text = "\n" + comment(sentence(table.text));
  if (std::string_view(table.name) == "bus") return text + printed_buses(table);
  const bool is_active = table.kind == KeyTable::Kind::always;
  for (const Key& key : table.keys) keys += printed(key, is_active && is_needed(key));
  return text + (is_active ? "" : "#") + heading_of(table) + "\n" + keys;
}

}  // namespace

std::string describe_settings() {
  std::string text =
      "| key | unit, range | default | at a reload | meaning |\n|---|---|---|---|---|\n";
  for (const KeyTable& table : key_tables()) {
    const std::string heading = heading_of(table);
    text += "| **" + (heading.empty() ? "The file" : "`" + heading + "`") + "** | | " +
            table.standard + (*table.standard != '\0' ? " " : "") + "| | " + table.text + " |\n";
    for (const Key& key : table.keys) {
      const Standard& standard = key.standard;
      text += std::string("| `") + key.name + "` | " + grouped(range_text(key)) + " | " +
              (standard.kind == Standard::Kind::value ? "`" + std::string(standard.toml) + "`"
                                                      : standard.words) +
              " | " + to_string(key.effect) + " | " + key.text + " |\n";
    }
  }
  return text;
}

std::string print_settings() {
  std::string text =
      comment(
          "All settings of etcm-gateway. Before a key with '#' stands what it decides; as it is "
          "here, it has its default, or an example where it has none. What has no '#' must be "
          "there. Durations are texts: \"500ms\", \"2s\", \"5min\". Paths start from the folder "
          "of this file, but for rtu.") +
      comment("After a change: etcm-gateway --config THIS_FILE --check-config");
  for (const KeyTable& table : key_tables()) {
    if (!is_nested(table)) text += printed(table);
  }
  return text;
}

}  // namespace etcm::firmware

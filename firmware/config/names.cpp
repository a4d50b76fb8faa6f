#include "firmware/config/names.h"

#include <algorithm>
#include <utility>

#include "etcm/port/utf8.h"

namespace etcm::firmware {

namespace {

// Of the character that the text begins with, so many bytes; 0: it may stand in a name.
std::size_t unseen_bytes(std::string_view text) {
  const auto byte = [&](std::size_t i) {
    return i < text.size() ? static_cast<unsigned char>(text[i]) : 0u;
  };
  if (byte(0) < 0x20 || byte(0) == 0x7f) return 1;
  // U+0080 ... U+009F.
  if (byte(0) == 0xc2 && byte(1) < 0xa0) return 2;
  if (byte(0) != 0xe2) return 0;
  // Marks of direction, ends of lines and paragraphs: U+200E, U+200F, U+2028 ... U+202E; U+2066 ...
  // U+2069.
  const bool is_mark = byte(1) == 0x80 &&
                       (byte(2) == 0x8e || byte(2) == 0x8f || (byte(2) >= 0xa8 && byte(2) <= 0xae));
  const bool is_isolate = byte(1) == 0x81 && byte(2) >= 0xa6 && byte(2) <= 0xa9;
  return is_mark || is_isolate ? 3 : 0;
}

bool is_same_node(const NodeName& a, const NodeName& b) {
  return a.serial == b.serial && a.bus == b.bus && a.address == b.address;
}

}  // namespace

bool is_name(std::string_view text) {
  if (text.empty() || text.size() > name_bytes_max) return false;
  for (std::size_t i = 0; i < text.size(); ++i) {
    if (unseen_bytes(text.substr(i)) > 0) return false;
  }
  return true;
}

std::string name_of_map(std::string_view text) {
  std::string name;
  for (std::size_t i = 0; i < text.size();) {
    const std::size_t bytes = unseen_bytes(text.substr(i));
    name += bytes > 0 ? ' ' : text[i];
    i += std::max<std::size_t>(bytes, 1);
  }
  name.resize(port::cut_utf8(name, name_bytes_max).size());
  return name;
}

NodeMistake add_name(Settings& settings, NodeName name) {
  if (name.address != 0) {
    NodeMistake wrong = find_bus(settings, name.address, name.bus);
    if (!wrong.what.empty()) return wrong;
  }
  for (const NodeName& other : settings.node_names) {
    if (!is_same_node(other, name)) continue;
    if (other.name == name.name) return {};
    return {"name",
            "this node is named '" + other.name + "' by " + other.source + "; take one name out"};
  }
  settings.node_names.push_back(std::move(name));
  return {};
}

}  // namespace etcm::firmware

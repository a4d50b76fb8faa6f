#include "etcm/files/json.h"

#include <algorithm>
#include <cstdint>
#include <iterator>
#include <nlohmann/json.hpp>

#include "etcm/files/record_reader.h"

namespace etcm::files {

namespace {

using Kind = JsonValue::Kind;

// Room for so many values is made at once: of most objects all.
constexpr std::size_t items_least = 4;

// Counts the lines before the character that was read last. A number ends where the character
// behind it has been read, which may be the end of its line: that one does not count yet.
class LineCountingIterator {
 public:
  using iterator_category = std::input_iterator_tag;
  using value_type = char;
  using difference_type = std::ptrdiff_t;
  using pointer = const char*;
  using reference = const char&;

  LineCountingIterator(const char* at, std::size_t* line) : at_(at), line_(line) {}
  reference operator*() const { return *at_; }
  LineCountingIterator& operator++() {
    if (last_was_end_) ++*line_;
    last_was_end_ = *at_++ == '\n';
    return *this;
  }
  friend bool operator==(const LineCountingIterator& a, const LineCountingIterator& b) {
    return a.at_ == b.at_;
  }

 private:
  const char* at_;
  std::size_t* line_;
  bool last_was_end_ = false;
};

// Takes the events of the parser and makes the values.
class Builder {
 public:
  using number_integer_t = nlohmann::json::number_integer_t;
  using number_unsigned_t = nlohmann::json::number_unsigned_t;
  using number_float_t = nlohmann::json::number_float_t;
  using string_t = nlohmann::json::string_t;
  using binary_t = nlohmann::json::binary_t;

  Builder(const std::string& path, const JsonBounds& bounds, const std::size_t& line)
      : path_(path), bounds_(bounds), line_(line) {}

  JsonValue result() { return std::move(root_); }

  // Each answers whether to go on; what is wrong is thrown.
  bool null() { return take(Kind::null, {}); }
  bool boolean(bool value) {
    add(Kind::boolean, {}).is_true = value;
    return true;
  }
  bool number_integer(number_integer_t value) { return take(Kind::number, std::to_string(value)); }
  bool number_unsigned(number_unsigned_t value) {
    return take(Kind::number, std::to_string(value));
  }
  bool number_float(number_float_t, const string_t& digits) { return take(Kind::number, digits); }
  bool string(string_t& value) { return take(Kind::text, std::move(value)); }
  bool binary(binary_t&) { return false; }  // JSON has none

  bool start_object(std::size_t) { return open(Kind::object); }
  bool start_array(std::size_t) { return open(Kind::array); }
  bool end_object() { return close(); }
  bool end_array() { return close(); }
  bool key(string_t& name) {
    std::vector<std::string>& keys = open_.back()->keys;
    if (keys.size() == bounds_.keys) {
      fail("an object with more than " + std::to_string(bounds_.keys) +
           " keys; this is no GeoJSON, check the file");
    }
    if (std::find(keys.begin(), keys.end(), name) != keys.end()) {
      fail("'" + name + "' stands twice; take one out");
    }
    keys.push_back(std::move(name));
    return true;
  }

  bool parse_error(std::size_t, const std::string&, const nlohmann::json::exception& error) {
    // The library's own sentence, without its number and the place it begins with.
    std::string what = error.what();
    if (const auto number = what.find("] "); number != std::string::npos) what.erase(0, number + 2);
    if (const auto column = what.find("column "); column != std::string::npos) {
      if (const auto colon = what.find(": ", column); colon != std::string::npos) {
        what.erase(0, colon + 2);
      }
    }
    const auto is_control = [](char c) { return static_cast<unsigned char>(c) < ' '; };
    std::replace_if(what.begin(), what.end(), is_control, ' ');
    fail("is no JSON: " + what + "; correct it there, or export the file again");
  }

 private:
  bool take(Kind kind, std::string text) {
    add(kind, std::move(text));
    return true;
  }

  JsonValue& add(Kind kind, std::string text) {
    if (++count_ > bounds_.values) {
      fail("more than " + std::to_string(bounds_.values) +
           " values; split the file, or simplify its lines");
    }
    JsonValue value;
    value.kind = kind;
    value.line_number = line_;
    value.text = std::move(text);
    JsonValue* made = &root_;
    if (open_.empty()) {
      root_ = std::move(value);
    } else {
      // What is open is the last element of what holds it, so nothing that is open moves.
      std::vector<JsonValue>& items = open_.back()->items;
      if (items.size() == items.capacity()) items.reserve(std::max(items_least, 2 * items.size()));
      made = &items.emplace_back(std::move(value));
    }
    return *made;
  }

  bool open(Kind kind) {
    if (open_.size() == bounds_.depth) {
      fail("brackets are nested more than " + std::to_string(bounds_.depth) +
           " deep; this is no GeoJSON, check the file");
    }
    open_.push_back(&add(kind, {}));
    return true;
  }

  bool close() {
    open_.pop_back();
    return true;
  }

  [[noreturn]] void fail(const std::string& message) const {
    throw InputError(path_, line_, message);
  }

  const std::string& path_;
  const JsonBounds& bounds_;
  const std::size_t& line_;
  JsonValue root_;
  std::vector<JsonValue*> open_;
  std::size_t count_ = 0;
};

}  // namespace

const JsonValue* JsonValue::find(std::string_view key) const {
  const auto found = std::find(keys.begin(), keys.end(), key);
  return found == keys.end() ? nullptr : &items[static_cast<std::size_t>(found - keys.begin())];
}

const char* to_string(JsonValue::Kind kind) {
  switch (kind) {
    case Kind::null:
      return "null";
    case Kind::boolean:
      return "true or false";
    case Kind::number:
      return "a number";
    case Kind::text:
      return "a text";
    case Kind::array:
      return "an array";
    case Kind::object:
      return "an object";
  }
  return "nothing";
}

JsonValue read_json(const std::string& path) {
  return parse_json(read_text(path, json_bytes_max), path);
}

JsonValue parse_json(std::string_view text, const std::string& name, const JsonBounds& bounds) {
  std::size_t line = 1;
  Builder builder(name, bounds, line);
  nlohmann::json::sax_parse(LineCountingIterator(text.data(), &line),
                            LineCountingIterator(text.data() + text.size(), &line), &builder);
  return builder.result();
}

}  // namespace etcm::files

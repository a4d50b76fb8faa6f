// What a value of the configuration file looks like: how it is read, what is said where it is
// wrong, and how a document tells its range. The keys that have these values are a table in
// settings_keys.h.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <type_traits>
#include <utility>
#include <variant>
#include <vector>

#include "firmware/config/settings.h"

namespace etcm::firmware {

class TomlTable;

// What the keys of one table are read into.
using Target =
    std::variant<Settings*, BusSettings*, DeviceSettings*, NodeSettings*, FeatureSettings*>;

// One value in a target.
template <class Value>
struct Access {
  Value (*get)(Target);
  void (*set)(Target, Value);
};

struct DurationType {
  Access<port::Duration> field;
  port::Duration least;
};
// Whole milliseconds; need not be there.
struct OptionalDurationType {
  Access<std::optional<port::Duration>> field;
  port::Duration most;
};
struct CountType {
  Access<std::uint32_t> field;
  std::uint32_t least;
  std::uint32_t most;
  std::string_view measure;  // of a count that is a measure, or empty
};
struct ChoiceType {
  Access<std::size_t> field;  // which of the words
  std::span<const std::string_view> words;
};
struct BaudType {
  Access<std::uint32_t> field;
};
struct FlagType {
  Access<bool> field;
};
struct TextType {
  Access<std::string> field;
};
// What people call something (names.h).
struct CalledType {
  Access<std::string> field;
};
// From the folder of the configuration file.
struct PathType {
  Access<std::string> field;
};
// One or several of these.
struct PathsType {
  Access<std::vector<std::string>> field;
};
struct AddressType {
  Access<port::SocketAddress> field;
};
// An address that need not be there.
struct OptionalAddressType {
  Access<std::optional<port::SocketAddress>> field;
};
// A host by address or name, and a port.
struct EndpointType {
  Access<port::Endpoint> field;
  bool has_standard_port;  // which is taken where it has none; until then it is 0
};
// One level of the topics of a fleet.
struct NameType {
  Access<std::string> field;
};
struct NetworksType {
  Access<std::vector<port::Network>> field;
};
// Names of hosts, in lower case and without a dot behind.
struct HostNamesType {
  Access<std::vector<std::string>> field;
};
struct UnitsType {
  Access<std::vector<UnitRange>> field;
};
// "!" before the name: active when low.
struct BoardLineType {
  Access<std::optional<LineSettings>> field;
};
// A count that need not be there.
struct OptionalCountType {
  Access<std::optional<std::uint32_t>> field;
  std::uint32_t least;
  std::uint32_t most;
};
// A decimal of either sign, in 10^-9, that need not be there.
struct DecimalType {
  Access<std::optional<std::int64_t>> field;
  std::int64_t most;  // either way
};
// A positive decimal, exactly, in 10^-9.
struct ScaleType {
  Access<std::int64_t> field;
};
// Two decimals, as above but of either sign.
struct OriginType {
  Access<SiteOrigin> field;
};

using ValueType =
    std::variant<DurationType, OptionalDurationType, CountType, ChoiceType, BaudType, FlagType,
                 TextType, CalledType, NameType, PathType, PathsType, AddressType,
                 OptionalAddressType, EndpointType, NetworksType, HostNamesType, UnitsType,
                 BoardLineType, OptionalCountType, DecimalType, ScaleType, OriginType>;

// A key as it stands in a file.
struct GivenKey {
  TomlTable& toml_table;
  std::string name;
  std::string example;                  // a good value, as it is written
  const std::filesystem::path& folder;  // where relative paths start
};

// Puts the value into the target. A target stays as it is where the file does not have the key, or
// has a wrong value: that is a mistake of the section.
void read_value(const ValueType& type, const GivenKey& key, Target target);

void copy_value(const ValueType& type, Target from, Target to);
bool is_same_value(const ValueType& type, Target a, Target b);

// What may be written, as Markdown: "1 ... 32".
std::string range_of(const ValueType& type);

// ---- Rows of the table: a type from the members that lead to its value.
//
// duration<&Settings::poll, &PollSettings::interval>(1ms). The first member is one of a target. An
// optional on the way must be there, and a variant must hold what the next member is of.

namespace detail {

template <class Member>
struct MemberOf;
template <class Owner_, class Value_>
struct MemberOf<Value_ Owner_::*> {
  using Owner = Owner_;
  using Value = Value_;
};

template <class Held>
inline constexpr bool is_variant = false;
template <class... Held>
inline constexpr bool is_variant<std::variant<Held...>> = true;

template <class Wanted, class Held>
auto& opened(Held& held) {
  if constexpr (is_variant<Held>) {
    return std::get<Wanted>(held);
  } else if constexpr (std::is_same_v<Held, std::optional<Wanted>>) {
    return held.value();
  } else {
    return held;
  }
}

template <class Value, class Held>
auto& reach(Held& held) {
  if constexpr (is_variant<Held>) {
    return std::get<Value>(held);
  } else {
    return held;
  }
}
template <class Value, auto first, auto... rest, class Held>
auto& reach(Held& held) {
  return reach<Value, rest...>(opened<typename MemberOf<decltype(first)>::Owner>(held).*first);
}

template <class Value, auto first, auto... rest>
auto& value_at(Target target) {
  using Owner = typename MemberOf<decltype(first)>::Owner;
  return reach<Value, first, rest...>(*std::get<Owner*>(target));
}

template <class Value, auto... path>
constexpr Access<Value> field() {
  return {[](Target target) { return static_cast<Value>(value_at<Value, path...>(target)); },
          [](Target target, Value value) {
            auto& held = value_at<Value, path...>(target);
            held = static_cast<std::remove_reference_t<decltype(held)>>(std::move(value));
          }};
}

template <auto& meanings>
inline constexpr auto words_of = [] {
  std::array<std::string_view, std::size(meanings)> words{};
  for (std::size_t i = 0; i < words.size(); ++i) words[i] = meanings[i].word;
  return words;
}();

}  // namespace detail

template <auto... path>
constexpr DurationType duration(port::Duration least) {
  return {detail::field<port::Duration, path...>(), least};
}
template <auto... path>
constexpr OptionalDurationType optional_duration(port::Duration most) {
  return {detail::field<std::optional<port::Duration>, path...>(), most};
}
template <auto... path>
constexpr CountType count(std::uint32_t least, std::uint32_t most, std::string_view measure = {}) {
  return {detail::field<std::uint32_t, path...>(), least, most, measure};
}

// A word of the file and what it stands for.
template <class Value>
struct Meaning {
  std::string_view word;
  Value value;
};
template <auto& meanings, auto... path>
constexpr ChoiceType choice() {
  using Value = decltype(meanings[0].value);
  return {{[](Target target) {
             const auto& value = detail::value_at<Value, path...>(target);
             std::size_t i = 0;
             while (i < std::size(meanings) && meanings[i].value != value) ++i;
             return i;
           },
           [](Target target, std::size_t i) {
             detail::value_at<Value, path...>(target) = meanings[i].value;
           }},
          detail::words_of<meanings>};
}

template <auto... path>
constexpr BaudType baud() {
  return {detail::field<std::uint32_t, path...>()};
}
template <auto... path>
constexpr FlagType flag() {
  return {detail::field<bool, path...>()};
}
template <auto... path>
constexpr TextType text() {
  return {detail::field<std::string, path...>()};
}
template <auto... path>
constexpr CalledType called() {
  return {detail::field<std::string, path...>()};
}
template <auto... path>
constexpr PathType path_from_file() {
  return {detail::field<std::string, path...>()};
}
template <auto... path>
constexpr PathsType paths_from_file() {
  return {detail::field<std::vector<std::string>, path...>()};
}
template <auto... path>
constexpr AddressType address() {
  return {detail::field<port::SocketAddress, path...>()};
}
template <auto... path>
constexpr OptionalAddressType optional_address() {
  return {detail::field<std::optional<port::SocketAddress>, path...>()};
}
template <auto... path>
constexpr EndpointType endpoint() {
  return {detail::field<port::Endpoint, path...>(), false};
}
template <auto... path>
constexpr EndpointType endpoint_with_standard_port() {
  return {detail::field<port::Endpoint, path...>(), true};
}
template <auto... path>
constexpr NameType name() {
  return {detail::field<std::string, path...>()};
}
template <auto... path>
constexpr NetworksType networks() {
  return {detail::field<std::vector<port::Network>, path...>()};
}
template <auto... path>
constexpr HostNamesType host_names() {
  return {detail::field<std::vector<std::string>, path...>()};
}
template <auto... path>
constexpr UnitsType units() {
  return {detail::field<std::vector<UnitRange>, path...>()};
}
template <auto... path>
constexpr BoardLineType board_line() {
  return {detail::field<std::optional<LineSettings>, path...>()};
}
template <auto... path>
constexpr OptionalCountType optional_count(std::uint32_t least, std::uint32_t most) {
  return {detail::field<std::optional<std::uint32_t>, path...>(), least, most};
}
template <auto... path>
constexpr DecimalType decimal(std::int64_t most) {
  return {detail::field<std::optional<std::int64_t>, path...>(), most};
}
template <auto... path>
constexpr ScaleType scale() {
  return {detail::field<std::int64_t, path...>()};
}
template <auto... path>
constexpr OriginType origin() {
  return {detail::field<SiteOrigin, path...>()};
}

}  // namespace etcm::firmware

// Reads Sparkplug payloads by nothing but the wire format of Protocol Buffers: a second opinion.
#pragma once

#include <bit>
#include <cstdint>
#include <map>
#include <optional>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

namespace etcm::test {

// The values of a message by the number of their field; bytes of what has a length.
struct ProtobufFields {
  std::map<unsigned, std::vector<std::uint64_t>> numbers;
  std::map<unsigned, std::vector<std::string>> texts;

  std::optional<std::uint64_t> number(unsigned field) const {
    const auto found = numbers.find(field);
    return found == numbers.end() ? std::nullopt : std::optional(found->second.at(0));
  }
  std::string text(unsigned field) const {
    const auto found = texts.find(field);
    return found == texts.end() ? std::string() : found->second.at(0);
  }
};

inline std::uint64_t take_varint(std::string_view& bytes) {
  std::uint64_t value = 0;
  for (unsigned shift = 0;; shift += 7) {
    const auto byte = static_cast<unsigned char>(bytes.at(0));
    bytes.remove_prefix(1);
    value |= std::uint64_t{byte & 0x7fu} << shift;
    if (byte < 0x80) return value;
  }
}

inline ProtobufFields read_protobuf(std::string_view bytes) {
  ProtobufFields fields;
  while (!bytes.empty()) {
    const std::uint64_t tag = take_varint(bytes);
    const auto field = static_cast<unsigned>(tag >> 3);
    if ((tag & 7) == 0) {
      fields.numbers[field].push_back(take_varint(bytes));
    } else if ((tag & 7) == 1) {
      std::uint64_t value = 0;
      for (unsigned i = 0; i < 8; ++i) {
        value |= std::uint64_t{static_cast<unsigned char>(bytes.at(i))} << 8 * i;
      }
      fields.numbers[field].push_back(value);
      bytes.remove_prefix(8);
    } else if ((tag & 7) == 2) {
      const auto length = static_cast<std::size_t>(take_varint(bytes));
      if (length > bytes.size()) throw std::runtime_error("a length leads out of the message");
      fields.texts[field].emplace_back(bytes.substr(0, length));
      bytes.remove_prefix(length);
    } else {
      throw std::runtime_error("a wire type that Sparkplug does not use");
    }
  }
  return fields;
}

struct SparkplugMetric {
  std::string name;
  std::optional<std::uint64_t> alias;
  std::uint64_t timestamp = 0;
  std::uint64_t datatype = 0;
  std::string value;  // as text; "null"
  std::map<std::string, std::string> properties{};
};

struct SparkplugPayload {
  std::uint64_t timestamp = 0;
  std::optional<std::uint64_t> sequence;
  std::vector<SparkplugMetric> metrics{};

  const SparkplugMetric* find(std::string_view name) const {
    for (const SparkplugMetric& metric : metrics) {
      if (metric.name == name) return &metric;
    }
    return nullptr;
  }
  // Of the metric of this name; "none" where there is none.
  std::string value(std::string_view name) const {
    const SparkplugMetric* const metric = find(name);
    return metric == nullptr ? "none" : metric->value;
  }
};

// The numbers of the fields are those of the specification's section 6.4.
inline std::string value_of(std::uint64_t datatype, const ProtobufFields& metric) {
  if (metric.number(7).value_or(0) == 1) return "null";
  const auto number = [&](unsigned field) { return metric.number(field).value(); };
  switch (datatype) {
    case 3:
      return std::to_string(static_cast<std::int32_t>(number(10)));
    case 4:
      return std::to_string(static_cast<std::int64_t>(number(11)));
    case 10:
      return std::to_string(std::bit_cast<double>(number(13)));
    case 11:
      return number(14) == 1 ? "true" : "false";
    case 12:
      return metric.texts.at(15).at(0);
    default:
      throw std::runtime_error("datatype " + std::to_string(datatype));
  }
}

inline SparkplugPayload read_sparkplug(std::string_view bytes) {
  const ProtobufFields fields = read_protobuf(bytes);
  SparkplugPayload payload{.timestamp = fields.number(1).value(), .sequence = fields.number(3)};
  if (!fields.texts.contains(2)) return payload;
  for (const std::string& one : fields.texts.at(2)) {
    const ProtobufFields metric = read_protobuf(one);
    SparkplugMetric& read = payload.metrics.emplace_back();
    read.name = metric.text(1);
    read.alias = metric.number(2);
    read.timestamp = metric.number(3).value();
    read.datatype = metric.number(4).value();
    read.value = value_of(read.datatype, metric);
    if (!metric.texts.contains(9)) continue;
    const ProtobufFields properties = read_protobuf(metric.texts.at(9).at(0));
    for (std::size_t i = 0; i < properties.texts.at(1).size(); ++i) {
      const ProtobufFields value = read_protobuf(properties.texts.at(2).at(i));
      read.properties[properties.texts.at(1)[i]] =
          value.texts.contains(8) ? value.text(8) : std::to_string(value.number(3).value());
    }
  }
  return payload;
}

}  // namespace etcm::test

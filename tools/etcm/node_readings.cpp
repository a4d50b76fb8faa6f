#include "node_readings.h"

#include <algorithm>
#include <limits>
#include <optional>
#include <string_view>

#include "etcm/files/error.h"
#include "etcm/files/record_reader.h"
#include "etcm/types.h"

namespace etcm::cli {

namespace {

using files::Decimal;

// More would leave no digit before the point.
constexpr int reading_digits_max = 9;

struct ReadingLine {
  std::size_t node = 0;
  Decimal value;
  std::size_t line_number = 0;
};

std::string_view trimmed(std::string_view text) {
  const auto is_blank = [](char c) { return c == ' ' || c == '\t' || c == '\r'; };
  while (!text.empty() && is_blank(text.front())) text.remove_prefix(1);
  while (!text.empty() && is_blank(text.back())) text.remove_suffix(1);
  return text;
}

std::string in_quotes(std::string_view text) {
  return "'" + std::string(text.substr(0, 40)) + (text.size() > 40 ? "..." : "") + "'";
}

// Digits behind the point that the value needs; none where they are too many.
std::optional<int> digits_of(const Decimal& value) {
  Decimal scaled = value;
  for (int digits = 0; digits <= reading_digits_max; ++digits) {
    if (scaled.is_integer()) return digits;
    scaled = scaled * Decimal::of(10);
  }
  return std::nullopt;
}

NodeReadings fitted(const std::string& source, std::size_t node_count,
                    const std::vector<ReadingLine>& lines) {
  NodeReadings readings{.source = source,
                        .digits = 0,
                        .values = std::vector<std::int32_t>(node_count),
                        .is_known = std::vector<bool>(node_count)};
  const auto fail = [&](const ReadingLine& line, const std::string& what) {
    throw files::InputError(source, line.line_number,
                            "reading " + line.value.to_string() + " " + what);
  };
  for (const ReadingLine& line : lines) {
    const auto digits = digits_of(line.value);
    if (!digits) fail(line, "has more than 9 digits behind the point; round it");
    readings.digits = std::max(readings.digits, *digits);
  }
  Decimal scale = Decimal::of(1);
  for (int i = 0; i < readings.digits; ++i) scale = scale * Decimal::of(10);
  for (const ReadingLine& line : lines) {
    const auto scaled = (line.value * scale).to_integer();
    if (!scaled || *scaled < std::numeric_limits<std::int32_t>::min() ||
        *scaled > std::numeric_limits<std::int32_t>::max()) {
      fail(line, "is too large beside others with " + std::to_string(readings.digits) +
                     " digits behind the point: all must fit in 32 bits; round them, or use a "
                     "larger unit");
    }
    readings.values[line.node] = static_cast<std::int32_t>(*scaled);
    readings.is_known[line.node] = true;
  }
  return readings;
}

}  // namespace

NodeReadings read_node_readings(const std::string& path, const files::ConstraintGraph& graph) {
  const std::string text = files::read_text(path);
  std::vector<ReadingLine> lines;
  std::vector<std::size_t> line_of(graph.nodes.size());  // of each node; 0: none yet
  bool is_first = true;
  std::size_t line_number = 0;
  for (std::string_view rest = text; !rest.empty();) {
    const std::size_t end = std::min(rest.find('\n'), rest.size());
    const std::string_view line = trimmed(rest.substr(0, end));
    rest.remove_prefix(std::min(end + 1, rest.size()));
    ++line_number;
    if (line.empty() || line.front() == '#') continue;
    const auto fail = [&](const std::string& what) {
      throw files::InputError(path, line_number, what);
    };
    const std::size_t comma = line.find(',');
    if (comma == std::string_view::npos || line.find(',', comma + 1) != std::string_view::npos) {
      fail(in_quotes(line) + " is no node and reading; write them as 12,3.5");
    }
    const std::string_view node_field = trimmed(line.substr(0, comma));
    const std::string_view value_field = trimmed(line.substr(comma + 1));
    const auto node = Decimal::parse(node_field);
    const auto value = Decimal::parse(value_field);
    const bool is_heading = is_first && !node && !value && !value_field.empty();
    is_first = false;
    if (is_heading) continue;
    const auto number = node ? node->to_integer() : std::nullopt;
    if (!number) fail("node number " + in_quotes(node_field) + " is no integer");
    const std::int64_t index = *number - graph.index_base;
    if (index < 0 || index >= static_cast<std::int64_t>(graph.nodes.size())) {
      fail("node " + std::to_string(*number) + " does not exist; " +
           (graph.nodes.empty() ? "the graph has no nodes"
                                : "nodes run from " + std::to_string(graph.index_base) + " to " +
                                      std::to_string(graph.node_number(graph.nodes.size() - 1))));
    }
    std::size_t& earlier = line_of[static_cast<std::size_t>(index)];
    if (earlier != 0) {
      fail("node " + std::to_string(*number) + " has a line already, " + std::to_string(earlier) +
           "; take one of them out");
    }
    earlier = line_number;
    if (value_field.empty()) continue;
    if (!value) {
      fail("reading " + in_quotes(value_field) +
           " is no decimal number; leave it empty where there is none");
    }
    lines.push_back({static_cast<std::size_t>(index), *value, line_number});
  }
  return fitted(path, graph.nodes.size(), lines);
}

NodeReadings attribute_readings(const files::ConstraintGraph& graph, std::size_t number) {
  if (number < 1 || number > graph.attribute_count) {
    throw files::InputError(
        graph.node_file, 0,
        "its nodes have " + (graph.attribute_count == 0
                                 ? "no attributes; give the readings with --readings"
                                 : std::to_string(graph.attribute_count) +
                                       " attributes, and no attribute " + std::to_string(number)));
  }
  std::vector<ReadingLine> lines;
  for (std::size_t node = 0; node < graph.nodes.size(); ++node) {
    const std::string& text = graph.attributes[node * graph.attribute_count + number - 1];
    lines.push_back(
        {node, Decimal::parse(text).value_or(Decimal()), graph.nodes[node].line_number});
  }
  return fitted(graph.node_file, graph.nodes.size(), lines);
}

std::string reading_text(std::int64_t value, int digits) {
  constexpr std::size_t more_digits = 3;
  constexpr std::int64_t more = 1000;
  // In two parts, for a thousand times the value does not fit.
  const std::int64_t whole = value >> subunit_bits;
  const std::int64_t part = value - whole * subunits_per_unit;
  const std::int64_t rounded =
      whole * more + ((part * more + subunits_per_unit / 2) >> subunit_bits);
  std::string text = std::to_string(rounded < 0 ? -rounded : rounded);
  const std::size_t behind = static_cast<std::size_t>(digits) + more_digits;
  if (text.size() <= behind) text.insert(0, behind + 1 - text.size(), '0');
  text.insert(text.size() - behind, ".");
  text.erase(text.find_last_not_of('0') + 1);
  if (text.back() == '.') text.pop_back();
  return rounded < 0 ? "-" + text : text;
}

}  // namespace etcm::cli

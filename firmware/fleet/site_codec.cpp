#include "firmware/fleet/site_codec.h"

#include <cstdlib>

#include "etcm/port/message_broker.h"
#include "etcm/port/utf8.h"
#include "firmware/fleet/fleet_hash.h"
#include "firmware/fleet/fleet_record.h"
#include "firmware/fleet/json_fields.h"
#include "firmware/fleet/json_text.h"

namespace etcm::firmware {

namespace {

using files::JsonValue;

constexpr std::int64_t degree_nano = 1'000'000'000;

void write_position(JsonText& json, Position position) {
  json.array().number(position.x).number(position.y).end();
}

// A node by its serial, an anchor by its place.
void write_end(JsonText& json, const FeatureEnd& end) {
  if (end.is_anchor) {
    write_position(json, end.position);
  } else {
    json.number(end.serial.value);
  }
}

Position whole(const Point& point) {
  return {.x = static_cast<std::int32_t>(point.x / subunits_per_unit),
          .y = static_cast<std::int32_t>(point.y / subunits_per_unit)};
}

void write_edges(JsonText& json, std::string_view key, const std::vector<DomainEdge>& edges) {
  json.key(key).array();
  for (const DomainEdge& edge : edges) {
    json.array();
    write_position(json, whole(edge.from));
    write_position(json, whole(edge.to));
    json.end();
  }
  json.end();
}

void write_plane(JsonText& json, const DocumentPlane& plane) {
  json.key("plane").object();
  if (!plane.crs.empty()) json.key("crs").text(plane.crs);
  json.key("unit").nano(plane.unit);
  json.key(plane.is_about_place ? "longitude" : "x").nano(plane.x);
  json.key(plane.is_about_place ? "latitude" : "y").nano(plane.y).end();
}

void write_content(JsonText& json, const SiteDocument& document) {
  write_plane(json, document.plane);
  json.key("anchors").array();
  for (const Position anchor : document.anchors) write_position(json, anchor);
  json.end().key("features").array();
  for (const SiteFeature& feature : document.features) {
    json.object().key("from");
    write_end(json, feature.from);
    write_end(json.key("to"), feature.to);
    if (!feature.name.empty()) json.key("name").text(feature.name);
    json.end();
  }
  json.end();
  write_edges(json, "outline", document.outline);
  write_edges(json, "holes", document.holes);
}

std::optional<Position> read_position(const JsonValue& value) {
  if (value.kind != JsonValue::Kind::array || value.items.size() != 2) return std::nullopt;
  const auto x = whole_number(value.items[0], -position_max, position_max);
  const auto y = whole_number(value.items[1], -position_max, position_max);
  if (!x || !y) return std::nullopt;
  return Position{.x = static_cast<std::int32_t>(*x), .y = static_cast<std::int32_t>(*y)};
}

std::optional<FeatureEnd> read_end(const JsonValue* value) {
  if (value == nullptr) return std::nullopt;
  if (value->kind == JsonValue::Kind::number) {
    const auto serial = whole_number(*value, 0, Serial::none_value - 1);
    if (!serial) return std::nullopt;
    return FeatureEnd(Serial{static_cast<std::uint32_t>(*serial)});
  }
  const std::optional<Position> position = read_position(*value);
  return position ? std::optional(FeatureEnd::anchor(*position)) : std::nullopt;
}

std::optional<DomainEdge> read_domain_edge(const JsonValue& value) {
  if (value.kind != JsonValue::Kind::array || value.items.size() != 2) return std::nullopt;
  const auto from = read_position(value.items[0]), to = read_position(value.items[1]);
  if (!from || !to) return std::nullopt;
  return DomainEdge{.from = to_point(*from), .to = to_point(*to)};
}

// They stand in the log and on the page.
bool is_printable(std::string_view text) {
  while (!text.empty()) {
    const std::size_t size = port::utf8_character(text);
    if (size == 0 || static_cast<unsigned char>(text.front()) < 0x20) return false;
    text.remove_prefix(size);
  }
  return true;
}

DocumentPlane read_plane(JsonFields& fields) {
  DocumentPlane plane;
  const JsonValue* const value = fields.object("plane");
  if (value == nullptr) return plane;
  JsonFields of(*value, "plane/");
  if (of.has("crs")) plane.crs = of.text("crs", site_crs_max);
  plane.is_about_place = of.has("longitude");
  plane.unit = of.nano("unit");
  plane.x = of.nano(plane.is_about_place ? "longitude" : "x");
  plane.y = of.nano(plane.is_about_place ? "latitude" : "y");
  const bool is_on_earth =
      std::abs(plane.x) <= 180 * degree_nano && std::abs(plane.y) <= 90 * degree_nano;
  if (plane.is_about_place && !is_on_earth) of.reject("longitude", "is nowhere on the earth");
  if (plane.unit <= 0) of.reject("unit", "is no length");
  if (!is_printable(plane.crs)) of.reject("crs", "is no name");
  if (plane.is_about_place && !plane.crs.empty()) of.reject("crs", "is there beside longitude");
  if (!of.is_sound()) fields.reject(of.wrong(), "");
  return plane;
}

std::optional<SiteFeature> read_site_feature(const JsonValue& value) {
  const auto from = read_end(value.find("from")), to = read_end(value.find("to"));
  if (!from || !to) return std::nullopt;
  SiteFeature feature{.from = *from, .to = *to};
  if (const JsonValue* const name = value.find("name")) {
    const bool is_sound = name->kind == JsonValue::Kind::text &&
                          name->text.size() <= site_name_max && is_printable(name->text);
    if (!is_sound) return std::nullopt;
    feature.name = name->text;
  }
  return feature;
}

// Each item of a list, by `read`.
template <class Value, class Read>
void read_list(JsonFields& fields, std::string_view key, std::vector<Value>& values, Read read) {
  const JsonValue* const list = fields.list(key, fleet_values_max);
  if (list == nullptr) return;
  for (const JsonValue& item : list->items) {
    const std::optional<Value> value = read(item);
    if (!value) {
      fields.reject(std::string(key) + "/" + std::to_string(values.size()), "is not sound");
      return;
    }
    values.push_back(*value);
  }
}

}  // namespace

std::string encode_site_content(const SiteDocument& document) {
  JsonText json;
  write_content(json.object(), document);
  return json.end().take();
}

std::string encode_site(const SiteDocument& document) {
  JsonText json;
  json.object().key("number").number(document.number);
  json.key("hash").hash(document.version().hash).key("gateway").text(document.gateway);
  write_content(json, document);
  return json.end().take();
}

std::optional<SiteDocument> decode_site(std::string_view payload, std::string& wrong) {
  if (payload.size() > port::broker_message_bytes_max) {
    wrong = "is too long";
    return std::nullopt;
  }
  const std::optional<JsonValue> json = parse_message(payload, wrong);
  if (!json) return std::nullopt;
  JsonFields fields(*json);
  SiteDocument document;
  document.number = fields.number("number", fleet_number_max);
  const std::uint64_t hash = fields.hash("hash");
  document.gateway = fields.text("gateway", fleet_name_max);
  document.plane = read_plane(fields);
  read_list(fields, "anchors", document.anchors, read_position);
  read_list(fields, "features", document.features, read_site_feature);
  read_list(fields, "outline", document.outline, read_domain_edge);
  read_list(fields, "holes", document.holes, read_domain_edge);
  if (document.number == 0) fields.reject("number", "is 0");
  if (!is_fleet_name(document.gateway)) fields.reject("gateway", "is no name of a gateway");
  if (fields.is_sound() && document.version().hash != hash) {
    fields.reject("hash", "is not that of the content");
  }
  if (fields.is_sound()) return document;
  wrong = fields.wrong();
  return std::nullopt;
}

}  // namespace etcm::firmware

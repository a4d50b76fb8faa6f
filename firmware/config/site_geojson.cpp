#include "firmware/config/site_geojson.h"

#include <algorithm>
#include <map>
#include <optional>
#include <set>
#include <string_view>
#include <utility>

#include "etcm/files/decimal.h"
#include "etcm/files/error.h"
#include "etcm/files/json.h"
#include "firmware/config/names.h"
#include "firmware/config/site.h"

namespace etcm::firmware {

namespace {

using files::InputError;
using files::JsonValue;
using Kind = JsonValue::Kind;

constexpr std::size_t mistakes_max = 20;

enum class Role : std::uint8_t { feature, domain, hole };

// What one feature of the file says beside its geometry.
struct Label {
  std::string name;
  Role role = Role::feature;
  const JsonValue* serials = nullptr;  // of the coordinates of a line
  std::optional<Serial> serial;        // of a point
  const JsonValue* unit = nullptr;     // of the device that was surveyed at a point
  std::string bus;                     // of that unit
};

struct DrawnLine {
  std::vector<Position> points;
  std::string name;
  std::string source;
};

std::string child(const std::string& where, std::size_t index) {
  return where + "/" + std::to_string(index);
}

// Of a feature or of the first feature with a geometry; null where there is none.
const JsonValue* first_position(const JsonValue& root) {
  const JsonValue* const features = root.find("features");
  if (features != nullptr) {
    for (const JsonValue& feature : features->items) {
      if (const JsonValue* const found = first_position(feature)) return found;
    }
    return nullptr;
  }
  const JsonValue* const geometry = root.find("geometry");
  const JsonValue* at = geometry != nullptr ? geometry->find("coordinates") : nullptr;
  while (at != nullptr && at->kind == Kind::array && !at->items.empty()) {
    if (at->items.front().kind == Kind::number) return at;
    at = &at->items.front();
  }
  return nullptr;
}

// In 10^-9; none for what will be a mistake where it is read.
std::optional<port::PlanePoint> plane_point(const JsonValue& position) {
  if (position.items.size() < 2) return std::nullopt;
  const auto number = [](const JsonValue& item) -> std::optional<std::int64_t> {
    const auto value = item.kind == Kind::number ? files::Decimal::parse(item.text) : std::nullopt;
    if (!value) return std::nullopt;
    return (*value * files::Decimal::of(site_nano)).rounded().to_integer();
  };
  const auto x = number(position.items[0]), y = number(position.items[1]);
  if (!x || !y) return std::nullopt;
  return port::PlanePoint{.x = *x, .y = *y};
}

// "urn:ogc:def:crs:EPSG::25833" is "EPSG:25833".
std::string short_crs(const std::string& name) {
  constexpr std::string_view urn = "urn:ogc:def:crs:";
  if (!name.starts_with(urn)) return name;
  const std::string rest = name.substr(urn.size());
  const std::size_t authority = rest.find(':'), code = rest.rfind(':');
  if (authority == std::string::npos) return name;
  return rest.substr(0, authority) + rest.substr(code);
}

class Drawing {
 public:
  Drawing(Settings& settings, const SiteFrame& frame, std::vector<std::string>& mistakes)
      : settings_(settings), grid_(settings.site, frame), mistakes_(mistakes) {}

  void read(const JsonValue& root) {
    const std::string type = type_of(root, "");
    if (type == "FeatureCollection") {
      const JsonValue& features = member(root, "", "features", Kind::array);
      for (std::size_t i = 0; i < features.items.size(); ++i) {
        if (!try_feature(features.items[i], child("features", i))) return;
      }
    } else if (type == "Feature") {
      try_feature(root, "");
    } else {
      fail(root, "", "a " + type + " says nothing but its geometry; make it a FeatureCollection");
    }
    finish();
  }

 private:
  // False: there have been so many mistakes that more of them help nobody.
  bool try_feature(const JsonValue& feature, const std::string& where) {
    try {
      read_feature(feature, where);
    } catch (const InputError& error) {
      if (++mistake_count_ > mistakes_max) {
        mistakes_.push_back(settings_.site.path + ": more mistakes follow; correct these first");
        return false;
      }
      mistakes_.push_back(error.what());
    }
    return true;
  }

  void read_feature(const JsonValue& feature, const std::string& where) {
    if (type_of(feature, where) != "Feature") {
      fail(feature, where, "is no Feature; write \"type\": \"Feature\", with a geometry");
    }
    const JsonValue* const geometry = feature.find("geometry");
    if (geometry == nullptr || geometry->kind == Kind::null) return;  // draws nothing
    const Label label = read_label(feature, where);
    read_geometry(*geometry, inside(where, "geometry"), label);
  }

  Label read_label(const JsonValue& feature, const std::string& where) {
    Label label;
    const JsonValue* const properties = feature.find("properties");
    if (properties == nullptr || properties->kind == Kind::null) return label;
    const std::string here = inside(where, "properties");
    if (properties->kind != Kind::object) {
      fail(*properties, here, "must be an object or null");
    }
    const JsonValue* const name = properties->find("name");
    if (name != nullptr && name->kind == Kind::text) label.name = name_of_map(name->text);
    const JsonValue* const role = properties->find("kind");
    if (role != nullptr && role->kind != Kind::null) label.role = role_of(*role, here + "/kind");
    const JsonValue* const serial = properties->find("serial");
    if (serial != nullptr) label.serial = serial_of(*serial, here + "/serial");
    const JsonValue* const unit = properties->find("unit");
    if (unit != nullptr && unit->kind != Kind::null) label.unit = unit;
    const JsonValue* const bus = properties->find("bus");
    if (bus != nullptr && bus->kind == Kind::text) label.bus = bus->text;
    const JsonValue* const serials = properties->find("serials");
    if (serials != nullptr && serials->kind != Kind::null) label.serials = serials;
    return label;
  }

  // A feature of any other kind is a line like all others: maps have many kinds.
  Role role_of(const JsonValue& value, const std::string& where) const {
    if (value.text == "domain") return Role::domain;
    if (value.text == "hole") return Role::hole;
    std::string small = value.text;
    std::transform(small.begin(), small.end(), small.begin(),
                   [](char c) { return c >= 'A' && c <= 'Z' ? static_cast<char>(c + 32) : c; });
    if (small == "domain" || small == "hole") {
      fail(value, where, "is '" + name_of_map(value.text) + "'; write it as \"" + small + "\"");
    }
    return Role::feature;
  }

  std::optional<Serial> serial_of(const JsonValue& value, const std::string& where) const {
    if (value.kind == Kind::null) return std::nullopt;
    const auto number =
        value.kind == Kind::number ? files::Decimal::parse(value.text) : std::nullopt;
    const auto serial = number ? number->to_integer() : std::nullopt;
    if (!serial || *serial < 0 || *serial >= Serial::none_value) {
      fail(value, where, "is no serial; give a whole number from 0 to 4294967294, or null");
    }
    return Serial{static_cast<std::uint32_t>(*serial)};
  }

  void read_geometry(const JsonValue& geometry, const std::string& where, const Label& label) {
    const std::string type = type_of(geometry, where);
    if (label.role != Role::feature && type != "Polygon" && type != "MultiPolygon") {
      fail(geometry, where,
           "a " + type +
               " cannot be a domain or a hole; draw it as a Polygon, or take its 'kind' "
               "out");
    }
    if (type == "GeometryCollection") {
      fail(geometry, where, "a GeometryCollection; write its parts as features of their own");
    }
    const std::string here = where + "/coordinates";
    const JsonValue& coordinates = member(geometry, where, "coordinates", Kind::array);
    if (type == "Point") {
      read_point(coordinates, here, label);
    } else if (type == "LineString") {
      read_line(coordinates, here, label, label.serials);
    } else if (type == "MultiLineString") {
      each_part(coordinates, here, label.serials,
                [&](const JsonValue& part, const std::string& at, const JsonValue* serials) {
                  read_line(part, at, label, serials);
                });
    } else if (type == "Polygon") {
      read_polygon(coordinates, here, label, label.serials);
    } else if (type == "MultiPolygon") {
      each_part(coordinates, here, label.serials,
                [&](const JsonValue& part, const std::string& at, const JsonValue* serials) {
                  read_polygon(part, at, label, serials);
                });
    } else {
      fail(geometry, where,
           "the geometry '" + name_of_map(type) +
               "' is unknown here; use Point, LineString, MultiLineString, Polygon or "
               "MultiPolygon");
    }
  }

  void read_point(const JsonValue& coordinates, const std::string& where, const Label& label) {
    const Position position = position_of(coordinates, where);
    const std::optional<Serial> serial =
        label.unit != nullptr ? survey(*label.unit, label, position) : label.serial;
    name_node(label, coordinates);
    note(position, coordinates, where, serial);
    if (!serial) anchors_.push_back(position);
  }

  // What is no node here may be called anything.
  void name_node(const Label& label, const JsonValue& at) {
    if (label.name.empty() || (label.unit == nullptr && !label.serial)) return;
    NodeName name{.name = label.name,
                  .source = settings_.site.path + ":" + std::to_string(at.line_number)};
    if (label.unit != nullptr) {
      name.bus = settings_.nodes.back().bus;
      name.address = settings_.nodes.back().address;
    } else {
      name.serial = *label.serial;
    }
    const NodeMistake wrong = add_name(settings_, std::move(name));
    if (!wrong.what.empty()) fail(at, std::string("properties/") + wrong.key, wrong.what);
  }

  // The serial of the device at this unit, which stands here.
  Serial survey(const JsonValue& unit, const Label& label, Position position) {
    const auto number = unit.kind == Kind::number ? files::Decimal::parse(unit.text) : std::nullopt;
    const auto address = number ? number->to_integer() : std::nullopt;
    if (!address || *address < 1 || *address > unit_max) {
      fail(unit, "properties/unit", "is no unit; give a whole number from 1 to 247");
    }
    NodeSettings node{.bus = label.bus,
                      .address = static_cast<std::uint32_t>(*address),
                      .source = settings_.site.path + ":" + std::to_string(unit.line_number),
                      .position = position};
    if (label.serial) node.serial = label.serial->value;
    const NodeMistake wrong = add_node(settings_, std::move(node));
    if (!wrong.what.empty()) fail(unit, std::string("properties/") + wrong.key, wrong.what);
    const NodeSettings& added = settings_.nodes.back();
    const auto bus =
        std::find_if(settings_.buses.begin(), settings_.buses.end(),
                     [&](const BusSettings& other) { return other.name == added.bus; });
    return device_serial(settings_, static_cast<std::size_t>(bus - settings_.buses.begin()),
                         ModbusAddress{static_cast<std::uint8_t>(added.address)});
  }

  void read_polygon(const JsonValue& rings, const std::string& where, const Label& label,
                    const JsonValue* serials) {
    each_part(rings, where, serials,
              [&](const JsonValue& ring, const std::string& at, const JsonValue* ring_serials) {
                const std::size_t first = read_line(ring, at, label, ring_serials);
                const std::vector<Position>& points = lines_[first].points;
                if (points.front() != points.back()) {
                  lines_.pop_back();
                  fail(ring, at, "the ring is not closed; repeat its first coordinate at the end");
                }
                if (points.size() < 4) {
                  lines_.pop_back();
                  fail(ring, at, "the ring has no area; give it three different corners at least");
                }
                if (label.role == Role::feature) return;
                auto& edges = label.role == Role::domain ? outline_ : holes_;
                for (std::size_t i = 1; i < points.size(); ++i) {
                  edges.push_back({.from = to_point(points[i - 1]), .to = to_point(points[i])});
                }
              });
  }

  // Returns the index of the new line.
  std::size_t read_line(const JsonValue& coordinates, const std::string& where, const Label& label,
                        const JsonValue* serials) {
    if (coordinates.kind != Kind::array) fail(coordinates, where, "must be an array of positions");
    if (serials != nullptr &&
        (serials->kind != Kind::array || serials->items.size() != coordinates.items.size())) {
      fail(*serials, where,
           "has " + std::to_string(coordinates.items.size()) +
               " positions, and 'serials' does not fit; give it as many entries, null where no "
               "node stands");
    }
    DrawnLine line{.points = {},
                   .name = label.name,
                   .source = settings_.site.path + ":" + std::to_string(coordinates.line_number)};
    for (std::size_t i = 0; i < coordinates.items.size(); ++i) {
      const std::string at = child(where, i);
      const Position position = position_of(coordinates.items[i], at);
      note(position, coordinates.items[i], at,
           serials != nullptr ? serial_of(serials->items[i], at) : std::nullopt);
      // Tools write the same position twice, and rounding makes two the same.
      if (line.points.empty() || line.points.back() != position) line.points.push_back(position);
    }
    if (line.points.size() < 2) {
      fail(coordinates, where, "a line of fewer than two different positions; take it out");
    }
    lines_.push_back(std::move(line));
    return lines_.size() - 1;
  }

  template <class Each>
  void each_part(const JsonValue& parts, const std::string& where, const JsonValue* serials,
                 const Each& each) {
    if (parts.kind != Kind::array) fail(parts, where, "must be an array");
    if (serials != nullptr &&
        (serials->kind != Kind::array || serials->items.size() != parts.items.size())) {
      fail(*serials, where,
           "has " + std::to_string(parts.items.size()) +
               " parts, and 'serials' does not fit; give it one list for each of them");
    }
    for (std::size_t i = 0; i < parts.items.size(); ++i) {
      const JsonValue* part_serials = serials != nullptr ? &serials->items[i] : nullptr;
      if (part_serials != nullptr && part_serials->kind == Kind::null) part_serials = nullptr;
      each(parts.items[i], child(where, i), part_serials);
    }
  }

  Position position_of(const JsonValue& value, const std::string& where) const {
    // A third number is a height, which a plane has not.
    if (value.kind != Kind::array || value.items.size() < 2) {
      fail(value, where, "is no position; give it as [x, y]");
    }
    const auto number = [&](const JsonValue& item) {
      const auto decimal =
          item.kind == Kind::number ? files::Decimal::parse(item.text) : std::nullopt;
      if (!decimal)
        fail(item, where,
             "holds " + std::string(to_string(item.kind)) +
                 " where a number must be; give it as [x, y]");
      return *decimal;
    };
    return grid_.place(value.line_number, where + ": ", number(value.items[0]),
                       number(value.items[1]));
  }

  // A node stands here, where a serial is given.
  void note(Position position, const JsonValue& at, const std::string& where,
            std::optional<Serial> serial) {
    if (!serial) return;
    const std::uint64_t key = FeatureEnd::anchor(position).key();
    const auto [here, is_new] = serial_at_.emplace(key, *serial);
    if (!is_new && here->second != *serial) {
      fail(at, where,
           "node " + std::to_string(serial->value) + " stands where node " +
               std::to_string(here->second.value) + " does; correct one of the serials");
    }
    const auto [place, is_first] = place_of_.emplace(*serial, key);
    if (!is_first && place->second != key) {
      fail(at, where,
           "node " + std::to_string(serial->value) +
               " stands at two places of this file; correct one of the serials");
    }
  }

  FeatureEnd end_at(Position position) const {
    const FeatureEnd anchor = FeatureEnd::anchor(position);
    const auto found = serial_at_.find(anchor.key());
    return found == serial_at_.end() ? anchor : FeatureEnd(found->second);
  }

  void add_anchor(const FeatureEnd& end, const std::string& source) {
    if (end.is_anchor && anchored_.insert(end.key()).second) {
      settings_.anchors.push_back({.position = end.position, .source = source});
    }
  }

  // Now that it is known at which places nodes stand.
  void finish() {
    std::set<std::pair<std::uint64_t, std::uint64_t>> drawn;
    for (const DrawnLine& line : lines_) {
      for (std::size_t i = 1; i < line.points.size(); ++i) {
        const FeatureEnd from = end_at(line.points[i - 1]);
        const FeatureEnd to = end_at(line.points[i]);
        add_anchor(from, line.source);
        add_anchor(to, line.source);
        if (!drawn.insert(std::minmax(from.key(), to.key())).second) continue;
        settings_.features.push_back(
            {.from = from, .to = to, .name = line.name, .source = line.source});
      }
    }
    for (const Position position : anchors_) {
      add_anchor(end_at(position), settings_.site.path);
    }
    settings_.domain = {std::move(outline_), std::move(holes_)};
  }

  std::string type_of(const JsonValue& value, const std::string& where) const {
    if (value.kind != Kind::object) fail(value, where, "must be an object");
    return member(value, where, "type", Kind::text).text;
  }

  const JsonValue& member(const JsonValue& object, const std::string& where, const char* key,
                          Kind kind) const {
    const JsonValue* const found = object.kind == Kind::object ? object.find(key) : nullptr;
    if (found == nullptr) {
      fail(object, where,
           std::string("'") + key + "' is missing; is this a GeoJSON file? Export it as one");
    }
    if (found->kind != kind) {
      fail(*found, inside(where, key), std::string("must be ") + to_string(kind));
    }
    return *found;
  }

  static std::string inside(const std::string& where, const std::string& key) {
    return where.empty() ? key : where + "/" + key;
  }

  [[noreturn]] void fail(const JsonValue& at, const std::string& where,
                         const std::string& what) const {
    throw InputError(settings_.site.path, at.line_number,
                     (where.empty() ? "" : where + ": ") + what);
  }

  Settings& settings_;
  const SiteGrid grid_;
  std::vector<std::string>& mistakes_;
  std::size_t mistake_count_ = 0;
  std::vector<DrawnLine> lines_;
  std::vector<Position> anchors_;              // points of their own
  std::map<std::uint64_t, Serial> serial_at_;  // by the key of the place
  std::map<Serial, std::uint64_t> place_of_;   // by serial
  std::set<std::uint64_t> anchored_;
  std::vector<DomainEdge> outline_;
  std::vector<DomainEdge> holes_;
};

}  // namespace

void read_site_geojson(const JsonValue& root, const SiteFrame& frame, Settings& settings,
                       std::vector<std::string>& mistakes) {
  Drawing(settings, frame, mistakes).read(root);
}

GeoJsonFrame frame_of(const JsonValue& root, const std::string& path) {
  GeoJsonFrame frame{.crs = {}, .first = {}, .line_number = root.line_number};
  if (const JsonValue* const position = first_position(root)) {
    frame.line_number = position->line_number;
    frame.first = plane_point(*position);
  }
  const JsonValue* const crs = root.find("crs");
  if (crs == nullptr || crs->kind == Kind::null) return frame;
  const JsonValue* const properties = crs->find("properties");
  const JsonValue* const name = properties != nullptr ? properties->find("name") : nullptr;
  if (name == nullptr || name->kind != Kind::text) {
    throw InputError(path, crs->line_number,
                     "crs: names no coordinate system; take it out, and name that of the file in "
                     "[site]");
  }
  frame.line_number = crs->line_number;
  frame.crs = short_crs(name->text);
  return frame;
}

}  // namespace etcm::firmware

#include "firmware/status/mesh_document.h"

#include <utility>

#include "firmware/records/node_table.h"
#include "firmware/status/bus_meter.h"

namespace etcm::firmware {

namespace {

// Sections of the document.
enum : std::uint32_t {
  head,
  features,
  edges,
  long_links,
  gaps,
  vertices,
  unplaced_nodes,
  relays,
  holes,
  missing_features,
  tail
};

// Of a unit: what a person can still make use of.
constexpr int coordinate_digits = 4;
// Of metres in a unit, which is no less than 10^-9 of what the plane counts in.
constexpr int metre_digits = 12;
// Neighbours that are looked at in one piece of a list of edges.
constexpr std::uint32_t looks_max = 1000;

void write_plane_place(const Point& place, const char* between, TextWriter& piece) {
  const auto units = [](std::int64_t coordinate) {
    return static_cast<double>(coordinate) / static_cast<double>(subunits_per_unit);
  };
  piece.decimal(units(place.x), coordinate_digits) << between;
  piece.decimal(units(place.y), coordinate_digits);
}

void write_degrees(const port::EarthPoint& place, const char* between, TextWriter& piece) {
  piece.nano(place.longitude) << between;
  piece.nano(place.latitude);
}

void write_rejection(const Rejection& rejection, TextWriter& piece) {
  if (rejection.is_none()) return;
  piece << ",\"refused\":";
  piece.json(explain(rejection));
}

// As the next property of something that has one.
void write_name(std::string_view name, TextWriter& piece) {
  if (name.empty()) return;
  piece << ",\"name\":";
  piece.json(name);
}

// The serial of a node, the place of an anchor.
void write_end(const FeatureEnd& end, TextWriter& piece) {
  if (end.is_anchor) {
    piece << "[" << end.position.x << "," << end.position.y << "]";
  } else {
    piece << end.serial.value;
  }
}

}  // namespace

bool MeshDocument::write_next(Cursor& cursor, port::Instant, TextWriter& piece) const {
  switch (cursor.section) {
    case head:
      write_head(piece);
      cursor.next_section();
      return true;
    case features:
    case edges:
      if (cursor.item == 0 && cursor.part == 0) {
        write_lines_head(cursor.section == features ? "features" : "edges", cursor, piece);
      }
      write_edges(cursor, cursor.section == features, piece);
      return true;
    case long_links:
      if (cursor.item == 0) write_lines_head("long_links", cursor, piece);
      write_long_link(cursor, piece);
      return true;
    case gaps:
      if (cursor.item == 0) write_lines_head("gaps", cursor, piece);
      write_gap(cursor, piece);
      return true;
    case relays:
      write_relay(cursor, piece);
      return true;
    case holes:
      write_hole(cursor, piece);
      return true;
    case vertices:
      write_vertex(cursor, piece);
      return true;
    case unplaced_nodes:
      write_unplaced_node(cursor, piece);
      return true;
    case missing_features:
      write_missing_feature(cursor, piece);
      return true;
    case tail:
      piece << "\n]}\n";
      cursor.next_section();
      return true;
    default:
      return false;
  }
}

void MeshDocument::write_head(TextWriter& piece) const {
  piece << "{\"type\":\"FeatureCollection\"";
  write_name(snapshot_.names->site(), piece);
  piece << ",\"generation\":" << snapshot_.generation << ",\"instance\":\"";
  piece.hex(instance_) << "\",\"radio_range\":" << snapshot_.analysis.radio_range
                       << ",\"sensing_range\":" << snapshot_.analysis.sensing_range;
  if (const double metres = metres_per_unit(plane_); metres > 0) {
    piece << ",\"metres_per_unit\":";
    piece.decimal(metres, metre_digits);
  }
  piece << ",\"features\":[";
}

void MeshDocument::write_lines_head(const char* kind, const Cursor& cursor,
                                    TextWriter& piece) const {
  piece << (cursor.section == features ? "" : ",")
        << "\n{\"type\":\"Feature\",\"properties\":{\"kind\":\"" << kind
        << "\"},\"geometry\":{\"type\":\"MultiLineString\",\"coordinates\":[";
}

void MeshDocument::write_line(Cursor& cursor, std::uint32_t from_row, std::uint32_t to_row,
                              TextWriter& piece) const {
  const ShownPoint from = in_frame(snapshot_.vertices[from_row].point);
  const ShownPoint to = in_frame(snapshot_.vertices[to_row].point);
  if (!is_shown(from) || !is_shown(to)) return;
  piece << cursor.separator() << "[";
  write_coordinates(from, piece);
  piece << ",";
  write_coordinates(to, piece);
  piece << "]";
}

void MeshDocument::write_long_link(Cursor& cursor, TextWriter& piece) const {
  const auto& links = snapshot_.analysis.long_links;
  if (cursor.item < links.size()) {
    const LongLink& link = links[cursor.item++];
    write_line(cursor, link.from_row, link.to_row, piece);
  } else {
    piece << "]}}";
    cursor.next_section();
  }
}

// Those that nodes beside the feature do not see either.
void MeshDocument::write_gap(Cursor& cursor, TextWriter& piece) const {
  const auto& all = snapshot_.analysis.gaps;
  if (cursor.item < all.size()) {
    const BarrierGap& gap = all[cursor.item++];
    if (!gap.watched) write_line(cursor, gap.from_row, gap.to_row, piece);
  } else {
    piece << "]}}";
    cursor.next_section();
  }
}

// Where a Steiner vertex stands, that is the proposal.
void MeshDocument::write_relay(Cursor& cursor, TextWriter& piece) const {
  const auto& all = snapshot_.analysis.relays;
  if (cursor.item >= all.size()) return cursor.next_section();
  const ProposedRelay& relay = all[cursor.item++];
  if (relay.row != no_row && snapshot_.vertices[relay.row].kind == VertexKind::steiner) return;
  piece << ",\n{\"type\":\"Feature\",\"geometry\":";
  write_place(relay.point, piece);
  piece << "\"kind\":\"relay\"";
  write_feature("feature", relay.feature, piece);
  piece << "}}";
}

void MeshDocument::write_hole(Cursor& cursor, TextWriter& piece) const {
  const auto& all = snapshot_.analysis.holes;
  if (cursor.item >= all.size()) return cursor.next_section();
  const CoverageHole& hole = all[cursor.item++];
  piece << ",\n{\"type\":\"Feature\",\"geometry\":";
  write_place(hole.point, piece);
  piece << "\"kind\":\"hole\",\"distance\":" << hole.distance << "}}";
}

MeshDocument::ShownPoint MeshDocument::in_frame(const Point& point) const {
  return {.point = point, .degrees = is_in_degrees() ? earth_point(plane_, point) : std::nullopt};
}

void MeshDocument::write_coordinates(const ShownPoint& place, TextWriter& piece) const {
  piece << "[";
  if (is_in_degrees()) {
    write_degrees(*place.degrees, ",", piece);
  } else {
    write_plane_place(place.point, ",", piece);
  }
  piece << "]";
}

void MeshDocument::write_place(const Point& point, TextWriter& piece) const {
  const ShownPoint place{.point = point, .degrees = earth_point(plane_, point)};
  if (is_shown(place)) {
    piece << "{\"type\":\"Point\",\"coordinates\":";
    write_coordinates(place, piece);
    piece << "}";
  } else {
    piece << "null";
  }
  piece << ",\"properties\":{";
  if (is_in_degrees()) {
    piece << "\"x\":";
    write_plane_place(point, ",\"y\":", piece);
    piece << ",";
  } else if (place.degrees) {
    piece << "\"longitude\":";
    write_degrees(*place.degrees, ",\"latitude\":", piece);
    piece << ",";
  }
}

// One of its readings, neighbours or turns a call: there may be any number of them.
void MeshDocument::write_vertex(Cursor& cursor, TextWriter& piece) const {
  if (cursor.item >= snapshot_.vertices.size()) return cursor.next_section();
  const SnapshotVertex& vertex = snapshot_.vertices[cursor.item];
  if (vertex.kind == VertexKind::none) {
    ++cursor.item;
    return;
  }
  const auto readings = readings_at(vertex.serial);
  if (cursor.part == 0) write_vertex_head(vertex, cursor.item, piece);
  if (cursor.part < readings.size()) return write_reading(readings[cursor.part++], piece);
  const auto number = static_cast<std::uint32_t>(cursor.part++ - readings.size());
  if (number == 0) piece << ",\"neighbours\":[";
  if (number < vertex.degree) {
    const std::uint32_t row = snapshot_.neighbours[vertex.first_neighbour + number].row;
    piece << (number == 0 ? "" : ",") << row + 1;
    return;
  }
  const std::uint32_t turn = number - vertex.degree;
  if (turn == 0) {
    piece << "],\"open\":[";
    cursor.has_begun = false;
  }
  if (turn < vertex.degree) {
    if (!domain_.has_on_left(vertex.first_neighbour + turn)) piece << cursor.separator() << turn;
    return;
  }
  piece << "]}}";
  ++cursor.item;
  cursor.part = 0;
}

void MeshDocument::write_along(std::uint32_t row, TextWriter& piece) const {
  std::string_view before = ",\"along\":[";
  for (const SnapshotNeighbour& neighbour : neighbours_of(snapshot_, row)) {
    if (neighbour.constrained) piece << std::exchange(before, ",") << neighbour.row + 1;
  }
  piece << "]";
}

// The page has them from a document of their own, and draws the mesh anew only where it changed.
std::span<const PublishedReading> MeshDocument::readings_at(Serial serial) const {
  if (frame_ == Frame::plane) return {};
  return readings_of(readings_, serial);
}

void MeshDocument::write_reading(const PublishedReading& reading, TextWriter& piece) const {
  piece << ",";
  piece.json(readings_.properties[property_of(reading)]) << ":";
  reading.nano ? piece.nano(*reading.nano) : piece << "null";
  if (!reading.disagrees) return;
  const Quantity& quantity = readings_.quantities[reading.quantity.value];
  std::array<char, sizeof "expected  ()" + reading_name_max + reading_unit_max> room;
  TextWriter name(room);
  name << "expected " << quantity.name;
  if (!quantity.unit.empty()) name << " (" << quantity.unit << ")";
  piece << ",";
  piece.json(name.text()) << ":";
  reading.expected_nano ? piece.nano(*reading.expected_nano) : piece << "null";
}

void MeshDocument::write_vertex_head(const SnapshotVertex& vertex, std::uint32_t row,
                                     TextWriter& piece) const {
  piece << ",\n{\"type\":\"Feature\",\"id\":" << row + 1 << ",\"geometry\":";
  write_place(vertex.point, piece);
  if (vertex.is_anchor) {
    piece << "\"kind\":\"anchor\"";
  } else if (vertex.kind == VertexKind::node) {
    piece << "\"kind\":\"node\",\"serial\":" << vertex.serial.value;
    write_name(snapshot_.names->text(vertex.name), piece);
    write_whereabouts(vertex.unit_index, vertex.owner, piece);
    piece << ",\"in_mesh\":true,\"stale\":";
    piece.yes_or_no(vertex.stale);
    if (vertex.lacks_fix) piece << ",\"no_fix\":true";
    // Where nobody can say which of them is wrong all are shown.
    const bool is_apart = vertex.far_from == FarFrom::site || vertex.far_from == FarFrom::others;
    if (is_apart) piece << ",\"far\":true";
    write_rejection(vertex.rejection, piece);
  } else {
    piece << "\"kind\":\"steiner\"";
    write_feature("feature", vertex.feature, piece);
    write_along(row, piece);
  }
}

void MeshDocument::write_unplaced_node(Cursor& cursor, TextWriter& piece) const {
  if (cursor.item >= snapshot_.unplaced_nodes.size()) return cursor.next_section();
  const SnapshotUnplacedNode& node = snapshot_.unplaced_nodes[cursor.item];
  const auto readings = readings_at(node.serial);
  if (cursor.part == 0) write_unplaced_head(node, piece);
  if (cursor.part < readings.size()) return write_reading(readings[cursor.part++], piece);
  piece << "}}";
  ++cursor.item;
  cursor.part = 0;
}

void MeshDocument::write_unplaced_head(const SnapshotUnplacedNode& node, TextWriter& piece) const {
  piece << ",\n{\"type\":\"Feature\",\"geometry\":";
  if (node.has_position) {
    write_place(to_point(node.position), piece);
  } else {
    piece << "null,\"properties\":{";
  }
  piece << "\"kind\":\"node\",\"serial\":" << node.serial.value;
  write_name(snapshot_.names->text(node.name), piece);
  write_whereabouts(node.unit_index, node.owner, piece);
  piece << ",\"in_mesh\":false";
  if (node.is_missing || node.is_absent) piece << ",\"missing\":true";
  if (node.is_absent) piece << ",\"never_heard\":true";
  if (node.has_left) piece << ",\"left\":true";
  write_rejection(node.rejection, piece);
}

// One edge a call at the most, from whichever of its ends has the lower row.
void MeshDocument::write_edges(Cursor& cursor, bool constrained, TextWriter& piece) const {
  for (std::uint32_t look = 0; look < looks_max; ++look) {
    if (cursor.item >= snapshot_.vertices.size()) {
      piece << "]}}";
      return cursor.next_section();
    }
    const SnapshotVertex& vertex = snapshot_.vertices[cursor.item];
    if (cursor.part >= vertex.degree) {
      ++cursor.item;
      cursor.part = 0;
      continue;
    }
    const SnapshotNeighbour& other = snapshot_.neighbours[vertex.first_neighbour + cursor.part++];
    if (other.row < cursor.item || other.constrained != constrained) continue;
    write_line(cursor, cursor.item, other.row, piece);
    return;
  }
}

void MeshDocument::write_missing_feature(Cursor& cursor, TextWriter& piece) const {
  if (cursor.item >= snapshot_.missing_features.size()) return cursor.next_section();
  const SnapshotMissingFeature& feature = snapshot_.missing_features[cursor.item++];
  piece << ",\n{\"type\":\"Feature\",\"geometry\":null,\"properties\":{\"kind\":\"missing\"";
  write_feature("feature", feature.number, piece);
  piece << ",\"from\":";
  write_end(feature.from, piece);
  piece << ",\"to\":";
  write_end(feature.to, piece);
  write_rejection(feature.rejection, piece);
  if (feature.blocker) write_blocker(*feature.blocker, piece);
  piece << "}}";
}

void MeshDocument::write_blocker(const Blocker& blocker, TextWriter& piece) const {
  write_feature("blocker", blocker.number + 1, piece);
  if (!blocker.near) return;
  piece << ",\"near\":[" << blocker.near->x << "," << blocker.near->y << "]";
}

void MeshDocument::write_feature(std::string_view what, std::uint32_t number,
                                 TextWriter& piece) const {
  piece << ",\"" << what << "\":" << number;
  const std::string_view name = snapshot_.names->feature(number);
  if (name.empty()) return;
  piece << ",\"" << what << "_name\":";
  piece.json(name);
}

void MeshDocument::write_whereabouts(UnitIndex unit, MemberIndex owner, TextWriter& piece) const {
  if (!owner.is_none()) {
    piece << ",\"owner\":";
    piece.json(snapshot_.gateways[owner.value]);
    return;
  }
  if (unit.is_none()) return;
  piece << ",\"bus\":";
  piece.json(bus_label(poller_, poller_.bus_of(unit)))
      << ",\"unit\":" << poller_.address_of(unit).value;
}

}  // namespace etcm::firmware

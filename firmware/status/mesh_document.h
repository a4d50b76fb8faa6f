// A snapshot as GeoJSON: a map program opens it, and the status page draws from it. Its coordinates
// are degrees (RFC 7946) or the units of the mesh; a point has the others as properties, "x" and
// "y" or "longitude" and "latitude", where the site knows both.
//
// Its features, by the property "kind":
//   "node", "steiner", "anchor"
//                      a point; "neighbours" are ids of other points, counter-clockwise. With each
//                      neighbour and the next one it makes a triangle of the domain, but where
//                      "open" has the index of the first of the two, from 0. "along" of a Steiner
//                      vertex has its two neighbours on its feature
//   "edges"            all edges of the mesh that are no part of a feature
//   "features"         those that are
//   "long_links"       edges longer than the radio range, if one is set
//   "gaps"             segments of features that no node senses, if a sensing range is set
//   "relay"            a point: where one more relay than the Steiner vertices would have to stand
//   "hole"             a point out of the sensing range, and how far the nearest node is
//   "missing"          a configured feature that is not in the mesh; no geometry
// What people call the site, a node or a feature is "name", and "feature_name" beside the number of
// a feature. A node that another gateway of the fleet hears has its name as "owner", and no bus and
// unit. A node that is known and not in the mesh has "in_mesh": false and no id; one that is
// missing also "missing": true, with its last place and unit. One that is stale although it answers
// has "no_fix": true, one that stands far from all others "far": true. What a node measures has a
// property "reading NAME (UNIT)" each, with the value or, where the device has no valid one, null;
// when it is stale, "stale reading NAME (UNIT)".
#pragma once

#include <optional>

#include "firmware/polling/poller.h"
#include "firmware/publish/reading_snapshot.h"
#include "firmware/publish/snapshot.h"
#include "firmware/publish/snapshot_domain.h"
#include "firmware/site/site_plane.h"
#include "firmware/status/document.h"

namespace etcm::firmware {

// What belongs together of one generation.
struct ShownMesh {
  explicit ShownMesh(const MeshConfig& config) : domain(config) {}

  Snapshot snapshot;
  SnapshotDomain domain;  // of it
  SitePlane plane;
  ReadingSnapshot readings;
};

class MeshDocument final : public Document {
 public:
  // What its coordinates are. Those of a site without degrees are in the plane either way.
  enum class Frame : std::uint8_t { plane, degrees };

  // Names of units are asked of `poller`. Both must outlive this; the mesh changes only while
  // nobody reads.
  MeshDocument(const ShownMesh& mesh, const Poller& poller, std::uint64_t instance, Frame frame)
      : snapshot_(mesh.snapshot),
        domain_(mesh.domain),
        plane_(mesh.plane),
        readings_(mesh.readings),
        poller_(poller),
        instance_(instance),
        frame_(frame) {}

  bool write_next(Cursor& cursor, port::Instant asked_at, TextWriter& piece) const override;

 private:
  void write_head(TextWriter& piece) const;
  void write_lines_head(const char* kind, const Cursor& cursor, TextWriter& piece) const;
  void write_line(Cursor& cursor, std::uint32_t from_row, std::uint32_t to_row,
                  TextWriter& piece) const;
  void write_long_link(Cursor& cursor, TextWriter& piece) const;
  void write_gap(Cursor& cursor, TextWriter& piece) const;
  void write_relay(Cursor& cursor, TextWriter& piece) const;
  void write_hole(Cursor& cursor, TextWriter& piece) const;
  bool is_in_degrees() const { return frame_ == Frame::degrees && plane_.projection != nullptr; }
  struct ShownPoint {
    Point point;
    std::optional<port::EarthPoint> degrees;  // none: not asked for, or nowhere on the earth
  };
  ShownPoint in_frame(const Point& point) const;
  // Whether it has coordinates in this frame.
  bool is_shown(const ShownPoint& place) const { return !is_in_degrees() || place.degrees; }
  // "[10.4,63.4]". REQUIRES: is_shown().
  void write_coordinates(const ShownPoint& place, TextWriter& piece) const;
  // A geometry (null for what is not shown) and "properties":{ with the place in the other frame,
  // to be completed.
  void write_place(const Point& point, TextWriter& piece) const;
  void write_vertex(Cursor& cursor, TextWriter& piece) const;
  void write_along(std::uint32_t row, TextWriter& piece) const;
  void write_vertex_head(const SnapshotVertex& vertex, std::uint32_t row, TextWriter& piece) const;
  void write_unplaced_node(Cursor& cursor, TextWriter& piece) const;
  void write_unplaced_head(const SnapshotUnplacedNode& node, TextWriter& piece) const;
  std::span<const PublishedReading> readings_at(Serial serial) const;
  void write_reading(const PublishedReading& reading, TextWriter& piece) const;
  void write_edges(Cursor& cursor, bool constrained, TextWriter& piece) const;
  void write_missing_feature(Cursor& cursor, TextWriter& piece) const;
  // Where it answers, or the gateway that hears it.
  void write_blocker(const Blocker& blocker, TextWriter& piece) const;
  // Its number, and its name under NAME of "NAME_name".
  void write_feature(std::string_view what, std::uint32_t number, TextWriter& piece) const;
  void write_whereabouts(UnitIndex unit, MemberIndex owner, TextWriter& piece) const;

  const Snapshot& snapshot_;
  const SnapshotDomain& domain_;
  const SitePlane& plane_;
  const ReadingSnapshot& readings_;
  const Poller& poller_;
  const std::uint64_t instance_;
  const Frame frame_;
};

}  // namespace etcm::firmware

#include "firmware/status/readings_document.h"

namespace etcm::firmware {

namespace {

using namespace std::chrono_literals;

// Sections of the document.
enum : std::uint32_t { beginning, quantities, names, values };

// Nodes that are looked at in one piece, of which one at the most is written.
constexpr std::uint32_t name_looks_max = 1000;

}  // namespace

bool ReadingsDocument::write_next(Cursor& cursor, port::Instant asked_at, TextWriter& piece) const {
  switch (cursor.section) {
    case beginning:
      piece << "{\"instance\":\"";
      piece.hex(instance_) << "\",\"generation\":" << readings_.generation
                           << ",\"sequence\":" << readings_.sequence << ",\n\"quantities\":[";
      cursor.next_section();
      return true;
    case quantities:
      if (cursor.item >= readings_.quantities.size()) {
        piece << "],\n\"names\":[";
        cursor.next_section();
      } else {
        const Quantity& quantity = readings_.quantities[cursor.item++];
        piece << cursor.separator() << "{\"name\":";
        piece.json(quantity.name) << ",\"unit\":";
        piece.json(quantity.unit) << "}";
      }
      return true;
    case names:
      write_name(cursor, piece);
      return true;
    case values:
      if (cursor.item >= readings_.readings.size()) {
        piece << "]}\n";
        cursor.next_section();
      } else {
        const PublishedReading& reading = readings_.readings[cursor.item++];
        piece << cursor.separator() << "[" << reading.serial.value << "," << reading.quantity.value
              << ",";
        reading.nano ? piece.nano(*reading.nano) : piece << "null";
        piece << "," << age_of(reading.taken_at, asked_at) / 1ms << ",";
        piece.yes_or_no(reading.is_stale) << ",";
        reading.expected_nano ? piece.nano(*reading.expected_nano) : piece << "null";
        piece << ",";
        piece.yes_or_no(reading.disagrees) << "]";
      }
      return true;
    default:
      return false;
  }
}

// Those in the mesh by row, then the others.
void ReadingsDocument::write_name(Cursor& cursor, TextWriter& piece) const {
  const std::size_t rows = mesh_.vertices.size();
  for (std::uint32_t look = 0; look < name_looks_max; ++look) {
    const std::size_t at = cursor.item++;
    if (at >= rows + mesh_.unplaced_nodes.size()) {
      piece << "],\n\"readings\":[";
      return cursor.next_section();
    }
    const bool is_placed = at < rows;
    const NameIndex name =
        is_placed ? mesh_.vertices[at].name : mesh_.unplaced_nodes[at - rows].name;
    if (name.is_none()) continue;
    const Serial serial =
        is_placed ? mesh_.vertices[at].serial : mesh_.unplaced_nodes[at - rows].serial;
    piece << cursor.separator() << "[" << serial.value << ",";
    piece.json(mesh_.names->text(name)) << "]";
    return;
  }
}

}  // namespace etcm::firmware

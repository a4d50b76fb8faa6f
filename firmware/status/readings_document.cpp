#include "firmware/status/readings_document.h"

namespace etcm::firmware {

namespace {

using namespace std::chrono_literals;

// Sections of the document.
enum : std::uint32_t { beginning, quantities, values };

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
        piece << "],\n\"readings\":[";
        cursor.next_section();
      } else {
        const Quantity& quantity = readings_.quantities[cursor.item++];
        piece << cursor.separator() << "{\"name\":";
        piece.json(quantity.name) << ",\"unit\":";
        piece.json(quantity.unit) << "}";
      }
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

}  // namespace etcm::firmware

#include "firmware/status/units_document.h"

#include "firmware/status/shown_unit.h"

namespace etcm::firmware {

namespace {

using namespace std::chrono_literals;

// Sections of the document.
enum : std::uint32_t { units_head, all_units };

void write_answers(const UnitCounters& counters, TextWriter& piece) {
  const std::uint64_t answers = counters.count(port::BusResult::ok);
  if (answers == 0) return;
  const auto in_ms = [&](const char* name, port::Duration time) {
    piece << ",\"" << name << "\":";
    piece.decimal(static_cast<double>(time.count()) / 1e6, 1);
  };
  in_ms("answer_ms", counters.answer_time_last);
  in_ms("answer_mean_ms", counters.answer_time / static_cast<std::int64_t>(answers));
  in_ms("answer_longest_ms", counters.answer_time_max);
}

void write_faults(const UnitCounters& counters, port::Instant asked_at, TextWriter& piece) {
  piece << ",\"requests\":" << counters.requests << ",\"recent\":" << counters.recent.count()
        << ",\"recent_errors\":" << counters.recent.faults();
  if (counters.last_fault == UnitFault::none) return;
  piece << ",\"last_error\":";
  piece.json(to_string(counters.last_fault));
  if (counters.last_fault == UnitFault::exception) {
    piece << ",\"exception\":" << counters.exception;
  }
  if (counters.last_fault == UnitFault::unbelieved) {
    piece << ",\"last_error_text\":";
    piece.json(explain_unbelieved(counters));
  }
  piece << ",\"last_error_ms\":" << age_of(counters.failed_at, asked_at) / 1ms;
}

}  // namespace

bool UnitsDocument::write_next(Cursor& cursor, port::Instant asked_at, TextWriter& piece) const {
  const Poller& poller = sources_.gateway.poller();
  switch (cursor.section) {
    case units_head:
      piece << "{\"instance\":\"";
      piece.hex(instance_of(sources_)) << "\",\"units\":[";
      cursor.next_section();
      return true;
    case all_units:
      // A bus has 247 at the most, and what is only looked for is quickly passed over.
      while (cursor.item < poller.unit_count() && !is_shown(poller, UnitIndex{cursor.item})) {
        ++cursor.item;
      }
      if (cursor.item < poller.unit_count()) {
        piece << cursor.separator() << "\n";
        write_unit(UnitIndex{cursor.item++}, asked_at, piece);
      } else {
        piece << "]}\n";
        cursor.next_section();
      }
      return true;
    default:
      return false;
  }
}

void UnitsDocument::write_unit(UnitIndex unit, port::Instant asked_at, TextWriter& piece) const {
  const ShownUnit shown = shown_unit(sources_, unit, asked_at);
  const UnitCounters& counters = sources_.gateway.poller().counters(unit);
  piece << "{\"bus\":";
  piece.json(shown.bus) << ",\"unit\":" << shown.address << ",\"state\":\""
                        << to_string(shown.state) << "\"";
  if (shown.since) piece << ",\"since_ms\":" << *shown.since / 1ms;
  if (shown.has_answered_before) piece << ",\"answered_before\":true";
  write_faults(counters, asked_at, piece);
  write_answers(counters, piece);
  if (!shown.profile.empty()) {
    piece << ",\"profile\":";
    piece.json(shown.profile);
  }
  if (shown.node != nullptr) piece << ",\"serial\":" << shown.node->serial.value;
  if (!shown.name.empty()) {
    piece << ",\"name\":";
    piece.json(shown.name);
  }
  if (shown.node != nullptr && shown.node->answered_at != port::Instant{}) {
    piece << ",\"said_ms\":" << age_of(shown.node->answered_at, asked_at) / 1ms;
  }
  if (shown.is_moving) piece << ",\"moving\":true";
  if (shown.has_left) piece << ",\"left\":true";
  if (shown.has_low_battery) piece << ",\"low_battery\":true";
  if (shown.lacks_fix) piece << ",\"no_fix\":true";
  if (shown.lacks_fix && counters.told != DevicePosition::State::value) {
    piece << ",\"no_position\":";
    piece.json(explain(counters.told).what);
  }
  if (sources_.gateway.poller().is_surveyed(unit)) piece << ",\"surveyed\":true";
  piece << "}";
}

}  // namespace etcm::firmware

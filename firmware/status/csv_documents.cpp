#include "firmware/status/csv_documents.h"

#include "firmware/status/shown_unit.h"

namespace etcm::firmware {

namespace {

using namespace std::chrono_literals;

// Sections of each of these documents.
enum : std::uint32_t { csv_head, csv_rows };

// Units that are looked at in one piece, of which one at the most is written.
constexpr std::uint32_t csv_looks_max = 1000;

void write_age(port::Instant since, port::Instant asked_at, TextWriter& piece) {
  piece.decimal(std::chrono::duration<double>(age_of(since, asked_at)).count(), 1);
}

const char* word_of_state(const NodeRecord& node) {
  if (node.is_missing) return "missing";
  if (node.is_quarantined()) return "quarantined";
  if (!node.is_placed()) return node.has_asked_to_leave() ? "left" : "waiting";
  return node.stale ? "stale" : "fresh";
}

}  // namespace

bool NodesCsv::write_next(Cursor& cursor, port::Instant asked_at, TextWriter& piece) const {
  if (cursor.section == csv_head) {
    piece << "serial,name,state,x,y,longitude,latitude,position_age_s,bus,unit,gateway,moving,"
             "low_battery,refused\r\n";
    cursor.next_section();
    return true;
  }
  // By serial, whoever comes and goes meanwhile: `item` is the least that is still to come.
  if (cursor.section != csv_rows) return false;
  const NodeRecord* next = nullptr;
  for (const NodeRecord& node : sources_.gateway.nodes().records()) {
    if (!node.is_known() || node.serial.value < cursor.item) continue;
    if (next == nullptr || node.serial < next->serial) next = &node;
  }
  if (next == nullptr) return false;
  cursor.item = next->serial.value + 1;
  write_row(*next, asked_at, piece);
  return true;
}

void NodesCsv::write_row(const NodeRecord& node, port::Instant asked_at, TextWriter& piece) const {
  piece << node.serial.value << ",";
  const std::string_view name = sources_.gateway.nodes().called(node).name;
  if (!name.empty()) piece.csv(name);
  piece << "," << word_of_state(node) << ",";
  if (node.has_position()) {
    piece << node.position.x << "," << node.position.y << ",";
    const auto degrees =
        earth_point(sources_.gateway.settings().site.plane(), to_point(node.position));
    if (degrees) piece.nano(degrees->longitude) << ",";
    if (degrees) piece.nano(degrees->latitude);
    piece << (degrees ? "," : ",,");
    write_age(node.positioned_at, asked_at, piece);
    piece << ",";
  } else {
    piece << ",,,,,";
  }
  write_whereabouts(node, piece);
  const auto is_set = [&](std::uint16_t bit) { return (node.status & bit) != 0 ? "yes" : "no"; };
  piece << "," << is_set(node_status::moving) << "," << is_set(node_status::low_battery) << ",";
  if (node.is_quarantined()) piece.csv(explain(node.rejection));
  piece << "\r\n";
}

// Bus, unit and gateway.
void NodesCsv::write_whereabouts(const NodeRecord& node, TextWriter& piece) const {
  if (node.is_foreign()) {
    const std::string_view gateway = gateway_name(sources_.gateway.snapshot(), node.owner);
    piece << ",,";
    if (!gateway.empty()) piece.csv(gateway);
    return;
  }
  if (node.last_unit.is_none()) {
    piece << ",,";
    return;
  }
  const Poller& poller = sources_.gateway.poller();
  piece.csv(bus_label(poller, poller.bus_of(node.last_unit)))
      << "," << poller.address_of(node.last_unit).value << ",";
}

bool UnitsCsv::write_next(Cursor& cursor, port::Instant asked_at, TextWriter& piece) const {
  if (cursor.section == csv_head) {
    piece << "bus,unit,state,since_s,serial,name,profile,requests,recent,recent_errors,last_error,"
             "exception,last_error_age_s,answer_ms,answer_longest_ms,moving,low_battery,no_fix\r\n";
    cursor.next_section();
    return true;
  }
  const Poller& poller = sources_.gateway.poller();
  for (std::uint32_t look = 0; look < csv_looks_max; ++look) {
    if (cursor.item >= poller.unit_count()) return false;
    const UnitIndex unit{cursor.item++};
    if (!is_shown(poller, unit)) continue;
    write_row(unit, asked_at, piece);
    return true;
  }
  return true;
}

void UnitsCsv::write_row(UnitIndex unit, port::Instant asked_at, TextWriter& piece) const {
  const ShownUnit shown = shown_unit(sources_, unit, asked_at);
  const UnitCounters& counters = sources_.gateway.poller().counters(unit);
  piece.csv(shown.bus) << "," << shown.address << "," << to_string(shown.state) << ",";
  if (shown.since) piece.decimal(std::chrono::duration<double>(*shown.since).count(), 1);
  piece << ",";
  if (shown.node != nullptr) piece << shown.node->serial.value;
  piece << ",";
  if (!shown.name.empty()) piece.csv(shown.name);
  piece << ",";
  if (!shown.profile.empty()) piece.csv(shown.profile);
  piece << "," << counters.requests << "," << counters.recent.count() << ","
        << counters.recent.faults() << "," << to_string(counters.last_fault) << ",";
  if (counters.last_fault == UnitFault::exception) piece << counters.exception;
  piece << ",";
  if (counters.last_fault != UnitFault::none) write_age(counters.failed_at, asked_at, piece);
  piece << ",";
  const bool has_answered = counters.count(port::BusResult::ok) > 0;
  if (has_answered) {
    piece.decimal(std::chrono::duration<double, std::milli>(counters.answer_time_last).count(), 1);
  }
  piece << ",";
  if (has_answered) {
    piece.decimal(std::chrono::duration<double, std::milli>(counters.answer_time_max).count(), 1);
  }
  const auto yes_or_no = [](bool value) { return value ? "yes" : "no"; };
  piece << "," << yes_or_no(shown.is_moving) << "," << yes_or_no(shown.has_low_battery) << ","
        << yes_or_no(shown.lacks_fix) << "\r\n";
}

bool EventsCsv::write_next(Cursor& cursor, port::Instant asked_at, TextWriter& piece) const {
  if (cursor.section == csv_head) {
    piece << "number,time,age_s,level,text\r\n";
    cursor.next_section();
    return true;
  }
  const std::optional<RecentEvent> event = next_event(sources_.events, cursor);
  if (event) write_row(*event, asked_at, piece);
  return event.has_value();
}

void EventsCsv::write_row(const RecentEvent& event, port::Instant asked_at,
                          TextWriter& piece) const {
  piece << event.number << ",";
  piece.utc(sources_.wall_clock.milliseconds() - age_of(event.at, asked_at) / 1ms) << ",";
  write_age(event.at, asked_at, piece);
  piece << "," << word_of(event.level) << ",";
  piece.csv(event.text) << "\r\n";
}

}  // namespace etcm::firmware

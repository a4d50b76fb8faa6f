#include "firmware/control/control.h"

#include <algorithm>
#include <charconv>
#include <chrono>
#include <optional>

#include "firmware/alarms/alarm_subject.h"
#include "firmware/control/doubts.h"
#include "firmware/control/shown_names.h"
#include "firmware/logging/text_line.h"
#include "firmware/status/health.h"

namespace etcm::firmware {

namespace {

// The next word of a line, which begins behind it then; empty at the end.
std::string_view take_word(std::string_view& line) {
  line.remove_prefix(std::min(line.find_first_not_of(' '), line.size()));
  const std::string_view word = line.substr(0, line.find(' '));
  line.remove_prefix(word.size());
  return word;
}

std::optional<std::uint32_t> number_in(std::string_view word) {
  std::uint32_t number = 0;
  const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), number);
  if (error != std::errc{} || end != word.data() + word.size()) return std::nullopt;
  return number;
}

}  // namespace

Control::Control(Gateway& gateway, AlarmBook& alarms, const StatusSources& sources, port::Log& log)
    : gateway_(gateway),
      alarms_(alarms),
      sources_(sources),
      log_(log),
      meter_(gateway.poller()),
      alarms_document_(alarms, sources.wall_clock, AlarmsShown::open, &sources.gateway),
      history_document_(alarms, sources.wall_clock, AlarmsShown::all, &sources.gateway),
      alarms_on_(alarms, sources.wall_clock, &sources_),
      alarms_all_(alarms, sources.wall_clock),
      status_(sources_, meter_),
      metrics_(sources_, meter_),
      units_(sources_),
      features_(sources_),
      now_(sources.started_at) {}

void Control::advance(port::Instant now) {
  now_ = now;
  meter_.advance(now);
}

void Control::begin(std::size_t number, std::string_view line) {
  DocumentReader& client = clients_[number];
  client.begin(now_);
  TextWriter answer = client.writer();
  const std::string_view command = take_word(line);
  // Names may have spaces.
  if (command == "dismiss") {
    dismiss(line.substr(std::min(line.size(), std::size_t{1})), answer);
    return client.show(answer.text());
  }
  const std::string_view what = take_word(line);
  if (!take_word(line).empty()) {
    answer << "error one word is too many\n";
  } else if (command == "show") {
    if (const Document* const shown = document(what); shown != nullptr) {
      client.show(*shown);
      answer << "ok\n";
    } else if (what == "config") {
      answer << "ok\n" << sources_.config << "\n";
    } else if (what == "health") {
      answer << "ok\n";
      if (is_healthy(sources_, now_, answer)) answer << "ok";
      answer << "\n";
      write_doubts(sources_, doubts_of(sources_, now_), answer);
    } else {
      answer << "error there is nothing of this name to show; there are ";
      std::string_view before;
      for (const std::string_view name : shown_names) {
        answer << before << name;
        before = ", ";
      }
      answer << "\n";
    }
  } else if (command == "acknowledge") {
    acknowledge(what, answer);
  } else {
    answer << "error this gateway does not know that command; is it of another version?\n";
  }
  client.show(answer.text());
}

const Document* Control::document(std::string_view name) const {
  if (name == "alarms") return &alarms_on_;
  if (name == "history") return &alarms_all_;
  if (name == "alarms.json") return &alarms_document_;
  if (name == "history.json") return &history_document_;
  if (name == "status.json") return &status_;
  if (name == "units.json") return &units_;
  if (name == "features.json") return &features_;
  if (name == "metrics") return &metrics_;
  return nullptr;
}

// A serial, the name of a node or of a gateway, or all.
void Control::dismiss(std::string_view what, TextWriter& answer) {
  if (what == "all") {
    // What holds a feature is not dismissed, and the next look finds it again.
    for (std::uint32_t i = 0; i < alarms_.open_count(); ++i) {
      const AlarmKey key = alarms_.open(i).key;
      if (key.kind == AlarmKind::missing_node || key.kind == AlarmKind::gone_gateway) {
        alarms_.dismiss(key);
      }
    }
    const std::uint32_t count = gateway_.dismiss_all(now_);
    answer << "ok\n" << count << " dismissed\n";
    return;
  }
  const std::optional<std::uint32_t> serial = number_in(what);
  if (serial && gateway_.nodes().find(Serial{*serial}) != nullptr) {
    return dismiss(Serial{*serial}, answer);
  }
  if (gateway_.dismiss_gateway(what, now_)) {
    alarms_.dismiss({AlarmKind::gone_gateway, subject_of(what)});
    answer << "ok\ngateway " << what << " is no longer in the list\n";
    return;
  }
  if (const auto wait = gateway_.nodes_leave_in(what, now_)) {
    answer << "error gateway " << what << " is gone, and its nodes are waited for until "
           << "leave_after is over; dismiss it then, in "
           << std::chrono::ceil<std::chrono::seconds>(*wait).count() + 1 << " s at the soonest\n";
    return;
  }
  const Called called = nodes_called(what);
  if (called.missing_count == 1) return dismiss(called.missing, answer);
  if (called.missing_count > 1) {
    answer << "error " << called.missing_count
           << " nodes of this name are missing; give the serial of one\n";
  } else if (!called.other.is_none()) {
    dismiss(called.other, answer);
  } else if (serial) {
    dismiss(Serial{*serial}, answer);
  } else {
    answer << "error no node and no gateway that has gone is called '" << what
           << "'; sudo etcm-gateway ctl list shows who is missing\n";
  }
}

Control::Called Control::nodes_called(std::string_view name) const {
  Called called;
  for (const NodeRecord& node : gateway_.nodes().records()) {
    if (!node.is_known() || gateway_.nodes().called(node).name != name) continue;
    if (!node.is_missing) {
      called.other = node.serial;
    } else if (called.missing_count++ == 0) {
      called.missing = node.serial;
    }
  }
  return called;
}

void Control::dismiss(Serial serial, TextWriter& answer) {
  if (!serial.is_none() && gateway_.dismiss(serial)) {
    alarms_.dismiss({AlarmKind::missing_node, serial.value});
    answer << "ok\n" << gateway_.nodes().called(serial) << " is no longer missed\n";
  } else if (const NodeRecord* const node = gateway_.nodes().find(serial)) {
    answer << "error " << gateway_.nodes().called(serial)
           << (node->is_missing
                   ? " holds a feature that the mesh cannot have without it; take the "
                     "feature out of the site file, and reload\n"
                   : " is not missing, so there is nothing to dismiss; sudo etcm-gateway ctl "
                     "list shows who is missing\n");
  } else {
    answer << "error node " << serial.value
           << " is not known here: it was dismissed already, or never here; sudo etcm-gateway ctl "
              "list shows who is missing\n";
  }
}

// The number of an alarm, or all.
void Control::acknowledge(std::string_view what, TextWriter& answer) {
  if (what == "all") {
    const std::uint32_t count = alarms_.acknowledge_all();
    log_.write(port::Level::info, TextLine() << "alarms: " << count << " acknowledged");
    answer << "ok\n" << count << " acknowledged\n";
    return;
  }
  const std::optional<std::uint32_t> number = number_in(what);
  if (!number || !alarms_.acknowledge(*number)) {
    answer << "error no alarm that is on has the number " << what
           << ": it has ended, or never was; sudo etcm-gateway ctl list shows those that are on\n";
    return;
  }
  log_.write(port::Level::info, TextLine() << "alarm " << *number << " is acknowledged");
  answer << "ok\nalarm " << *number << " is acknowledged\n";
}

}  // namespace etcm::firmware

#include "firmware/nodes/admission.h"

#include <algorithm>

#include "firmware/logging/text_line.h"

namespace etcm::firmware {

namespace {

// So often in a row a unit must answer with another serial than it had.
constexpr std::uint8_t sightings_wanted = 3;

// A unit that did not answer so often in a row is not where it was.
constexpr std::uint32_t failures_of_the_gone = 3;

}  // namespace

Admission::Admission(const PollSettings& settings, const FeatureTable& features, NodeTable& nodes,
                     const Poller& poller, port::Log& log)
    : settings_(settings),
      features_(features),
      nodes_(nodes),
      poller_(poller),
      log_(log),
      conflicts_(poller.unit_count()) {}

NodeRecord* Admission::admit(UnitIndex unit, Serial serial, port::Instant now) {
  UnitConflict& conflict = conflicts_[unit.value];
  NodeRecord* const here = nodes_.at(unit);
  if (here != nullptr && here->serial == serial) {
    conflict.sightings = 0;
    if (conflict.conflict == IdentityConflict::waiting) clear(conflict);
    return here;
  }
  if (conflict.serial != serial) {
    clear(conflict);
    conflict.serial = serial;
    conflict.conflict = IdentityConflict::waiting;
    conflict.since = now;
  }
  conflict.seen_at = now;
  conflict.sightings = static_cast<std::uint8_t>(std::min(conflict.sightings + 1, 255));

  if (here != nullptr) {
    if (here->serial == swap_words(serial)) {
      return disbelieve(unit, IdentityConflict::swapped_words, here->serial);
    }
    if (conflict.displaced == serial)
      return disbelieve(unit, IdentityConflict::same_unit, here->serial);
    if (conflict.sightings < sightings_wanted) return nullptr;
  } else if (!is_named(serial) && is_named(swap_words(serial))) {
    return disbelieve(unit, IdentityConflict::swapped_words, swap_words(serial));
  }

  NodeRecord* node = nodes_.find(serial);
  if (node == nullptr) {
    node = add(serial, now);
    if (node == nullptr) return disbelieve(unit, IdentityConflict::no_room, Serial::none());
  } else if (!node->unit_index.is_none()) {
    if (conflict.conflict == IdentityConflict::same_serial || node->heard_at > conflict.since) {
      return disbelieve(unit, IdentityConflict::same_serial, serial);
    }
    if (!has_gone(*node, now)) return nullptr;
    log_.write(port::Level::info, TextLine() << "node " << serial.value << " went from "
                                             << poller_.name(node->unit_index) << " to "
                                             << poller_.name(unit));
  }
  if (here != nullptr) {
    log_.write(port::Level::info, TextLine()
                                      << poller_.name(unit) << ": node " << serial.value
                                      << " is there now, node " << here->serial.value << " is not");
  }
  conflict.displaced = here == nullptr ? Serial::none() : here->serial;
  nodes_.assign_unit(*node, unit);
  clear(conflict);
  return node;
}

void Admission::sweep(port::Instant now) {
  for (UnitIndex unit{0}; unit.value < conflicts_.size(); ++unit.value) {
    UnitConflict& conflict = conflicts_[unit.value];
    if (conflict.conflict != IdentityConflict::none &&
        now - conflict.seen_at > settings_.leave_after)
      clear(conflict);
  }
}

bool Admission::has_gone(const NodeRecord& node, port::Instant now) const {
  return poller_.failures(node.unit_index) >= failures_of_the_gone ||
         now - node.heard_at > settings_.stale_after;
}

// A node that answers comes before one that is missing.
NodeRecord* Admission::add(Serial serial, port::Instant now) {
  if (NodeRecord* const node = nodes_.add(serial, now); node != nullptr) return node;
  NodeRecord* longest = nullptr;
  for (NodeRecord& node : nodes_.records()) {
    if (!node.is_missing || node.is_placed()) continue;
    if (longest == nullptr || node.heard_at < longest->heard_at) longest = &node;
  }
  if (longest == nullptr) return nullptr;
  log_.write(port::Level::warning,
             TextLine() << "node " << longest->serial.value
                        << " is no longer missed, though it did not come back: there is no room to "
                           "know node "
                        << serial.value << " too; dismiss those that are missing by a reload");
  nodes_.release(*longest);
  changed_ = true;
  return nodes_.add(serial, now);
}

NodeRecord* Admission::disbelieve(UnitIndex unit, IdentityConflict why, Serial other) {
  UnitConflict& conflict = conflicts_[unit.value];
  if (std::exchange(conflict.conflict, why) == why) return nullptr;
  changed_ = true;
  TextLine line;
  switch (why) {
    case IdentityConflict::none:
    case IdentityConflict::waiting:
      break;
    case IdentityConflict::same_serial:
      line << "two nodes with serial " << conflict.serial.value << ": "
           << poller_.name(nodes_.find(other)->unit_index) << " and " << poller_.name(unit)
           << "; the second is ignored, give it a serial of its own";
      break;
    case IdentityConflict::same_unit:
      line << "two nodes answer as " << poller_.name(unit) << ": serials " << other.value << " and "
           << conflict.serial.value << "; the second is ignored, give it a unit of its own";
      break;
    case IdentityConflict::swapped_words:
      line << poller_.name(unit) << ": answers with serial " << conflict.serial.value
           << ", which is " << other.value
           << " with its words swapped; set `word_order` of the bus (ABCD <-> CDAB, BADC <-> DCBA)";
      break;
    case IdentityConflict::no_room:
      line << poller_.name(unit) << ": no room to know node " << conflict.serial.value
           << " too; too many nodes without a unit, wait for them to leave";
      break;
  }
  log_.write(port::Level::error, line);
  return nullptr;
}

void Admission::clear(UnitConflict& conflict) {
  changed_ = changed_ || conflict.is_alarm();
  const Serial displaced = conflict.displaced;
  conflict = {};
  conflict.displaced = displaced;
}

}  // namespace etcm::firmware

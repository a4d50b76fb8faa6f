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
    const bool is_back = !conflict.serial.is_none() && conflict.serial == conflict.displaced;
    conflict.alternates = conflict.alternates || is_back;
    if (conflict.conflict == IdentityConflict::waiting) clear(conflict);
    here->answered_at = now;
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
    if (conflict.displaced == serial && conflict.alternates) {
      return disbelieve(unit, IdentityConflict::same_unit, here->serial);
    }
    if (conflict.displaced == serial && !may_be_back(conflict, *here, now)) return nullptr;
    if (conflict.sightings < sightings_wanted) return nullptr;
  } else if (!is_named(serial) && is_named(swap_words(serial))) {
    return disbelieve(unit, IdentityConflict::swapped_words, swap_words(serial));
  }

  NodeRecord* node = nodes_.find(serial);
  if (node == nullptr) {
    node = add(serial, now);
    if (node == nullptr) return disbelieve(unit, IdentityConflict::no_room, Serial::none());
  } else if (!node->unit_index.is_none()) {
    if (conflict.conflict == IdentityConflict::same_serial || answered_at(*node) > conflict.since) {
      return disbelieve(unit, IdentityConflict::same_serial, serial);
    }
    if (!has_gone(*node, now)) return nullptr;
    TextLine line;
    log_.write(port::Level::info, line << nodes_.called(*node) << " went from "
                                       << poller_.name(node->unit_index) << " to "
                                       << poller_.name(unit));
  }
  if (here != nullptr) {
    TextLine line;
    log_.write(port::Level::info, line << poller_.name(unit) << ": " << nodes_.called(*node)
                                       << " is there now, " << nodes_.called(*here) << " is not");
  }
  conflict.displaced = here == nullptr ? Serial::none() : here->serial;
  conflict.alternates = conflict.alternates && here != nullptr;
  nodes_.assign_unit(*node, unit);
  node->answered_at = now;
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
  // One of this gateway is missing then, and has none.
  for (NodeRecord& node : nodes_.records()) {
    const bool is_gone = node.is_known() && node.is_foreign() && !node.unit_index.is_none() &&
                         now - node.answered_at > settings_.leave_after;
    if (is_gone) nodes_.vacate(node);
  }
}

// Of one that is known from an earlier run, when that heard it.
port::Instant Admission::answered_at(const NodeRecord& node) const {
  return node.is_foreign() ? node.answered_at : std::max(node.answered_at, node.heard_at);
}

bool Admission::has_gone(const NodeRecord& node, port::Instant now) const {
  return poller_.failures(node.unit_index) >= failures_of_the_gone ||
         now - answered_at(node) > settings_.stale_after;
}

// One that had another serial for a while has its own again, once: where it does not alternate with
// the one that is here.
bool Admission::may_be_back(UnitConflict& conflict, const NodeRecord& here,
                            port::Instant now) const {
  if (now - answered_at(here) <= settings_.stale_after) return false;
  conflict.alternates = true;
  return true;
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
  TextLine line;
  log_.write(port::Level::warning,
             line << nodes_.called(*longest)
                  << " is no longer missed, though it did not come back: there is no room to "
                     "know "
                  << nodes_.called(serial)
                  << " too; dismiss those that are missing (sudo etcm-gateway ctl dismiss all)");
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
    case IdentityConflict::other_gateway:
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
      line << poller_.name(unit) << ": no room to know " << nodes_.called(conflict.serial)
           << " too; too many nodes without a unit, wait for them to leave";
      break;
  }
  log_.write(port::Level::error, line);
  return nullptr;
}

void Admission::clear(UnitConflict& conflict) {
  changed_ = changed_ || conflict.is_alarm();
  const bool alternates = conflict.alternates;
  const Serial displaced = conflict.displaced;
  conflict = {};
  conflict.displaced = displaced;
  conflict.alternates = alternates;
}

}  // namespace etcm::firmware

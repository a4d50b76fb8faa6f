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

Admission::Admission(const PollSettings& settings, const FeatureBook& features, Roster& roster,
                     const Poller& poller, port::Log& log)
    : settings_(settings),
      features_(features),
      roster_(roster),
      poller_(poller),
      log_(log),
      doubts_(poller.unit_count()) {}

NodeRecord* Admission::admit(std::uint32_t unit, std::uint32_t serial, port::Instant now) {
  UnitDoubt& doubt = doubts_[unit];
  NodeRecord* const here = roster_.at(unit);
  if (here != nullptr && here->serial == serial) {
    doubt.sightings = 0;
    if (doubt.doubt == Doubt::waiting) clear(doubt);
    return here;
  }
  if (doubt.serial != serial) {
    clear(doubt);
    doubt.serial = serial;
    doubt.doubt = Doubt::waiting;
    doubt.since = now;
  }
  doubt.seen_at = now;
  doubt.sightings = static_cast<std::uint8_t>(std::min(doubt.sightings + 1, 255));

  if (here != nullptr) {
    if (here->serial == swap_words(serial)) {
      return disbelieve(unit, Doubt::swapped_words, here->serial);
    }
    if (doubt.displaced == serial) return disbelieve(unit, Doubt::same_unit, here->serial);
    if (doubt.sightings < sightings_wanted) return nullptr;
  } else if (!is_named(serial) && is_named(swap_words(serial))) {
    return disbelieve(unit, Doubt::swapped_words, swap_words(serial));
  }

  NodeRecord* node = roster_.find(serial);
  if (node == nullptr) {
    node = add(serial, now);
    if (node == nullptr) return disbelieve(unit, Doubt::no_room, no_serial);
  } else if (node->unit != no_unit) {
    if (doubt.doubt == Doubt::same_serial || node->heard_at > doubt.since) {
      return disbelieve(unit, Doubt::same_serial, node->unit);
    }
    if (!has_gone(*node, now)) return nullptr;
    log_.write(port::Level::info, TextLine()
                                      << "node " << serial << " went from "
                                      << poller_.name(node->unit) << " to " << poller_.name(unit));
  }
  if (here != nullptr) {
    log_.write(port::Level::info, TextLine()
                                      << poller_.name(unit) << ": node " << serial
                                      << " is there now, node " << here->serial << " is not");
  }
  doubt.displaced = here == nullptr ? no_serial : here->serial;
  roster_.seat(*node, unit);
  clear(doubt);
  return node;
}

void Admission::sweep(port::Instant now) {
  for (std::uint32_t unit = 0; unit < doubts_.size(); ++unit) {
    UnitDoubt& doubt = doubts_[unit];
    if (doubt.doubt != Doubt::none && now - doubt.seen_at > settings_.leave_after) clear(doubt);
  }
}

bool Admission::has_gone(const NodeRecord& node, port::Instant now) const {
  return poller_.failures(node.unit) >= failures_of_the_gone ||
         now - node.heard_at > settings_.stale_after;
}

// Who answers comes before who is missing.
NodeRecord* Admission::add(std::uint32_t serial, port::Instant now) {
  if (NodeRecord* const node = roster_.add(serial, now); node != nullptr) return node;
  NodeRecord* longest = nullptr;
  for (NodeRecord& node : roster_.records()) {
    if (!node.is_missing || node.is_placed()) continue;
    if (longest == nullptr || node.heard_at < longest->heard_at) longest = &node;
  }
  if (longest == nullptr) return nullptr;
  log_.write(port::Level::warning,
             TextLine() << "node " << longest->serial
                        << " is no longer missed, though it did not come back: there is no room to "
                           "know node "
                        << serial << " too; dismiss those that are missing by a reload");
  roster_.release(*longest);
  changed_ = true;
  return roster_.add(serial, now);
}

NodeRecord* Admission::disbelieve(std::uint32_t unit, Doubt why, std::uint32_t other) {
  UnitDoubt& doubt = doubts_[unit];
  if (std::exchange(doubt.doubt, why) == why) return nullptr;
  changed_ = true;
  TextLine line;
  switch (why) {
    case Doubt::none:
    case Doubt::waiting:
      break;
    case Doubt::same_serial:
      line << "two nodes with serial " << doubt.serial << ": " << poller_.name(other) << " and "
           << poller_.name(unit) << "; the second is ignored, give it a serial of its own";
      break;
    case Doubt::same_unit:
      line << "two nodes answer as " << poller_.name(unit) << ": serials " << other << " and "
           << doubt.serial << "; the second is ignored, give it a unit of its own";
      break;
    case Doubt::swapped_words:
      line << poller_.name(unit) << ": answers with serial " << doubt.serial << ", which is "
           << other
           << " with its words swapped; set `word_order` of the bus (ABCD <-> CDAB, BADC <-> DCBA)";
      break;
    case Doubt::no_room:
      line << poller_.name(unit) << ": no room to know node " << doubt.serial
           << " too; too many nodes without a unit, wait for them to leave";
      break;
  }
  log_.write(port::Level::error, line);
  return nullptr;
}

void Admission::clear(UnitDoubt& doubt) {
  changed_ = changed_ || doubt.is_alarm();
  const std::uint32_t displaced = doubt.displaced;
  doubt = {};
  doubt.displaced = displaced;
}

}  // namespace etcm::firmware

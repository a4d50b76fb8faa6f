// Nodes where features of the site end and that are not known: nobody has heard them since the
// start, and most often the serial is mistyped; or they have left, or were dismissed.
#pragma once

#include <cstdint>
#include <span>
#include <string_view>
#include <vector>

#include "etcm/port/clock.h"
#include "etcm/port/log.h"
#include "firmware/gateway/fleet_report.h"
#include "firmware/logging/text_line.h"
#include "firmware/polling/poller.h"
#include "firmware/records/feature_table.h"
#include "firmware/records/node_table.h"

namespace etcm::firmware {

struct NodeEnd {
  Serial serial;
  std::uint32_t feature = 0;  // the first that ends there, from 0
  bool is_heard = false;      // once, in this run
  UnitIndex last_unit{};      // where it was then; none: not here
  bool is_told = false;       // to the log that it is not, or is not known any more
};

class UnheardEnds {
 public:
  // What it is given must outlive it.
  UnheardEnds(const FeatureTable& features, port::Log& log) : features_(features), log_(log) {}

  // Another site. Who was heard stays so, and so does who is known not to be. O(n log n), and takes
  // its memory.
  void take_site(port::Instant now);
  // Who is heard by now. Who is not is so once each unit was asked, `patience` has passed, and all
  // is known that other gateways hear. `fleet`: null, there are none. O(units and ends).
  void look(const NodeTable& nodes, const Poller& poller, const FleetReport* fleet,
            port::Duration patience, port::Instant now);

  // By serial; those that are not known are told.
  std::span<const NodeEnd> ends() const { return ends_; }
  // Null: no feature ends there. O(log n).
  const NodeEnd* find(Serial serial) const;
  // What is wrong with one that is not heard, and what to do about it, where the feature is said to
  // be: "there", or "in " and its source.
  void explain(const NodeEnd& end, const NodeTable& nodes, TextLine& text) const;
  static void write_cure(const NodeEnd& end, const NodeTable& nodes, std::string_view where,
                         TextLine& cure);

 private:
  const FeatureTable& features_;
  port::Log& log_;
  std::vector<NodeEnd> ends_;
  port::Instant since_{};  // the site is this one
  bool is_known_ = false;
};

}  // namespace etcm::firmware

// Nodes that stand far from the site or from all others (publish/far_nodes.h), once they have done
// so for a while: at the start those that are right may come later than one that is not.
#pragma once

#include <cstdint>
#include <span>
#include <string_view>
#include <vector>

#include "etcm/port/clock.h"
#include "etcm/port/log.h"
#include "firmware/config/settings.h"
#include "firmware/logging/text_line.h"
#include "firmware/polling/poller.h"
#include "firmware/publish/snapshot.h"
#include "firmware/records/node_table.h"

namespace etcm::firmware {

struct FarNode {
  Serial serial;
  std::uint32_t row = 0;  // of the snapshot
  port::Instant since{};
  bool is_told = false;  // to the log
};

class FarNodeWatch {
 public:
  // What it is given must outlive it.
  FarNodeWatch(const NodeTable& nodes, const Poller& poller, port::Log& log)
      : nodes_(nodes), poller_(poller), log_(log) {}

  // Those of this gateway in the snapshot published last. The log is told of one once, and when it
  // is far no longer. O(n), and O(f log f) in those that are far.
  void look(const Snapshot& snapshot, const Settings& settings, port::Instant now);

  // By serial. What is wrong counts where they are told.
  std::span<const FarNode> list() const { return far_; }
  // Null: it is not far, told or not. O(log n).
  const FarNode* find(Serial serial) const;
  // "node 7, unit 3 of yard, stands 6240 km from the site": in this snapshot it is far.
  void explain(const FarNode& node, const Snapshot& snapshot, const Settings& settings,
               TextLine& text) const;
  std::string_view cure_of(const FarNode& node) const;

 private:
  void list(const Snapshot& snapshot, port::Instant now);

  const NodeTable& nodes_;
  const Poller& poller_;
  port::Log& log_;
  std::vector<FarNode> far_;
  std::vector<FarNode> before_;
};

}  // namespace etcm::firmware

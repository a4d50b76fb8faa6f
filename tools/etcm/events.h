// A history of a mesh as a text file: one event a line, '#' starts a comment.
//   join ID X Y      leave ID      move ID X Y      feature ID A B      unfeature ID
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "etcm/files/grid.h"

namespace etcm::cli {

enum class EventKind : std::uint8_t { join, leave, move, feature, unfeature };

// The word that a line of it begins with.
std::string_view name_of(EventKind kind);

struct Event {
  EventKind kind = EventKind::join;
  std::int64_t id = 0;    // of a node or a feature: as numbered in the .poly, or any new number
  Position position;      // join, move
  std::int64_t from = 0;  // feature: ids of nodes
  std::int64_t to = 0;
  std::size_t line_number = 0;
};

// Throws InputError. Coordinates are placed as those of the graph are.
std::vector<Event> read_events(const std::string& path, const files::Placement& placement);

}  // namespace etcm::cli

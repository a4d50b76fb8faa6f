// Lengths as a person reads them.
#pragma once

#include <string_view>

#include "etcm/types.h"
#include "firmware/logging/text_line.h"
#include "firmware/site/site_plane.h"

namespace etcm::firmware {

// "3 mm", "12.5 m", "1.11 km": three digits, and no zeros behind them.
void write_metres(TextLine& text, double metres);

// How far that is, in metres, and what follows: "12.5 m from " with " from ". Nothing where nobody
// has said how long a unit of the mesh is.
void write_distance(TextLine& text, const SitePlane& plane, Position from, Position to,
                    std::string_view behind);

}  // namespace etcm::firmware

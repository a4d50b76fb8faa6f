// A place as a person reads it.
#pragma once

#include "etcm/types.h"
#include "firmware/logging/text_line.h"
#include "firmware/site/site_plane.h"

namespace etcm::firmware {

// "(378, 224)"
TextLine& operator<<(TextLine& text, Position position);

// In units, and where it is known in degrees: "(378, 224), 63.430500° N, 10.395100° E".
void write_place(TextLine& text, const SitePlane& plane, Position position);
// The same, and as the site file has it where that counts otherwise and not in degrees.
void write_site_place(TextLine& text, const SitePlane& plane, Position position);

}  // namespace etcm::firmware

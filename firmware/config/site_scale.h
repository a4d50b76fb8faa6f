// Whether lengths in the plane of a site are true where it is.
#pragma once

#include "firmware/config/settings.h"

namespace etcm::firmware {

// Adds a warning where lengths at the first place of the site that is not so are off by more than
// half a percent: the coordinate system is made for another part of the earth, or the place is not
// meant. Only a plane with a projection whose unit of length is known is looked at.
void check_scale(Settings& settings);

}  // namespace etcm::firmware

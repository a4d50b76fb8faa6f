// A Triangle .poly as a site file.
#pragma once

#include "firmware/config/settings.h"

namespace etcm::firmware {

// Adds its segments to the features. Where its node numbers are serials, its coordinates do not
// matter: the nodes themselves say where they stand. Else its nodes are anchors, closed segments
// bound the domain as in Triangle, and its holes are holes. Throws files::InputError.
void read_site_poly(Settings& settings);

}  // namespace etcm::firmware

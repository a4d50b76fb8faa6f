// The whole configuration: the settings and the site file they name, checked against each other.
#pragma once

#include <string>
#include <vector>

#include "firmware/config/settings.h"

namespace etcm::firmware {

// Reads both. The result is good for use only where there is no mistake: then what the site alone
// can make wrong (lines that cross, too little room) has been tried on a mesh of it.
// `projections` may be null: such a gateway has the plane alone.
Settings read_configuration(const std::string& path, port::ProjectionSource* projections,
                            std::vector<std::string>& mistakes);

// The last part of it: whether the site can be in a mesh of these settings.
void check_site(const std::string& path, const Settings& settings,
                std::vector<std::string>& mistakes);

}  // namespace etcm::firmware

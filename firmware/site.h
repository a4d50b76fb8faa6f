// The features of a site file.
#pragma once

#include <string>
#include <vector>

#include "settings.h"

namespace etcm::firmware {

// The features of a .poly whose node numbers are the nodes' serials; where its nodes stand does not
// matter, the nodes themselves say so. Throws files::InputError.
std::vector<FeatureSettings> read_site(const std::string& path);

}  // namespace etcm::firmware

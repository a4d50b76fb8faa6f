// What is wrong between settings of several tables, each of which is good for itself.
#pragma once

#include <toml++/toml.h>

#include <string>
#include <vector>

#include "firmware/config/settings.h"

namespace etcm::firmware {

// `file` is what `settings` were read from, without a mistake, at `path`. What cannot work adds a
// line "file:line: what is wrong; the cure" to `mistakes`; what works worse than was meant adds
// one to `settings.warnings`. Both stand in the order of the file.
void check_across(const toml::table& file, const std::string& path, Settings& settings,
                  std::vector<std::string>& mistakes);

}  // namespace etcm::firmware

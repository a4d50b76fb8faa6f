// Profiles as files and settings write them.
#pragma once

#include <string>
#include <vector>

#include "firmware/profile/profile.h"
#include "firmware/toml/toml_table.h"

namespace etcm::firmware {

// A [[profile]]. Mistakes are told as TomlTable tells them; the profile is good for use only where
// there are none.
Profile read_profile(TomlTable& table);

// The folder of those that were installed with the program that runs; empty where that is not
// known.
std::string installed_profiles();

// Every [[profile]] of a file, or of all files NAME.toml of a folder in the order of their names.
// Each mistake is one line "file:line: what is wrong; the cure".
std::vector<Profile> read_profiles(const std::string& path, std::vector<std::string>& mistakes);

// The same; of the configuration of a gateway (a file with [mesh] or [[bus]]) those that the
// gateway has: its own, which take the place of others of their name, and those that its `profiles`
// names, or else those in `installed`, where there are any.
std::vector<Profile> read_profiles_or_gateways(const std::string& path,
                                               const std::string& installed,
                                               std::vector<std::string>& mistakes);

}  // namespace etcm::firmware

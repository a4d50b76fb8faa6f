// The table of keys as text.
#pragma once

#include <string>

namespace etcm::firmware {

// The table of the operating guide, as Markdown; `etcm-gateway --settings-table` prints it.
std::string describe_settings();

// A configuration file with every key, its default and what it decides; `etcm-gateway --settings`
// prints it. As it stands it is good and changes no default: a '#' stands before each key that it
// need not have.
std::string print_settings();

}  // namespace etcm::firmware

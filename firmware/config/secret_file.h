// Files with a password or a key in their first line.
#pragma once

#include <string>

namespace etcm::firmware {

// Without the end of the line. Empty: there is none, and `why` says so, with the cure.
std::string read_secret(const std::string& path, std::string& why);
// The same of a key: hexadecimal, 16 to 64 bytes of it.
std::string read_key(const std::string& path, std::string& why);

// Whether it is one of those that systemd gives to a service alone, while it runs (LoadCredential).
bool is_credential(const std::string& path);

// Whether everybody on this machine may read it.
bool is_public(const std::string& path);

}  // namespace etcm::firmware

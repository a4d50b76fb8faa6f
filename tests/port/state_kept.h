// Pieces of state, and what a folder holds of them.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

#include "posix/state_file.h"

namespace etcm::port {

inline std::vector<std::byte> bytes_of(std::string_view text) {
  std::vector<std::byte> bytes(text.size());
  for (std::size_t i = 0; i < text.size(); ++i) bytes[i] = static_cast<std::byte>(text[i]);
  return bytes;
}

// What a gateway that starts finds: the last copy, else the one before; "" for neither. Like the
// gateway, it sets aside what is broken.
inline std::string found_in(const std::string& folder) {
  StateFile file(folder);
  std::vector<std::byte> bytes;
  std::string why;
  for (const Copy copy : {Copy::last, Copy::previous}) {
    const StateFile::Found found = file.load(copy, bytes, why);
    if (found == StateFile::Found::sound) {
      std::string text;
      for (const std::byte byte : bytes) text += static_cast<char>(byte);
      return text;
    }
    if (found == StateFile::Found::broken) file.set_aside(copy);
  }
  return "";
}

inline bool save_in(const std::string& folder, std::string_view text) {
  return StateFile(folder).save(bytes_of(text)).action == nullptr;
}

}  // namespace etcm::port

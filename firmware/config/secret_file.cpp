#include "firmware/config/secret_file.h"

#include <algorithm>
#include <cctype>
#include <filesystem>
#include <fstream>
#include <system_error>

namespace etcm::firmware {

std::string read_secret(const std::string& path, std::string& why) {
  std::error_code ignored;
  std::ifstream file(path);
  std::string line;
  if (!file || std::filesystem::is_directory(path, ignored)) {
    if (std::filesystem::exists(path, ignored)) {
      why = path + " cannot be read; give a file that the gateway's user may read";
    } else {
      why = "there is no " + path +
            (is_credential(path) ? "; name it in a LoadCredential of the service (systemctl edit)"
                                 : "; make it, or correct the path");
    }
    return {};
  }
  std::getline(file, line);
  if (!line.empty() && line.back() == '\r') line.pop_back();
  if (line.empty()) why = path + " has nothing in its first line; write the secret there";
  return line;
}

std::string read_key(const std::string& path, std::string& why) {
  constexpr std::size_t digits_least = 32;
  constexpr std::size_t digits_most = 128;
  std::string key = read_secret(path, why);
  if (key.empty()) return key;
  const bool is_hex = std::all_of(key.begin(), key.end(), [](char c) {
    return std::isxdigit(static_cast<unsigned char>(c)) != 0;
  });
  if (is_hex && key.size() % 2 == 0 && key.size() >= digits_least && key.size() <= digits_most) {
    return key;
  }
  why = path +
        " has no key of 16 to 64 bytes in hexadecimal in its first line; `openssl rand -hex "
        "32` makes one, for the broker too";
  return {};
}

bool is_credential(const std::string& path) { return path.starts_with("/run/credentials/"); }

bool is_public(const std::string& path) {
  std::error_code failed;
  const auto status = std::filesystem::status(path, failed);
  return !failed && (status.permissions() & std::filesystem::perms::others_read) !=
                        std::filesystem::perms::none;
}

}  // namespace etcm::firmware

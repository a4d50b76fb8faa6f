// The files of the status page (firmware/status/page) and the pages of the operating guide, which
// are
// "/guide" and below it, as the build put them into the program.
#pragma once

#include <cstdint>
#include <span>
#include <string_view>

namespace etcm::firmware {

struct PageFile {
  std::string_view path;  // "/map.js"; the page itself is "/"
  const char* media_type;
  std::uint64_t version;  // differs where the content does
  std::string_view content;
};

std::span<const PageFile> page_files();

}  // namespace etcm::firmware

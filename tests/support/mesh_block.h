// A mesh and its bytes, for tests that copy, keep and harm them.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <span>
#include <string_view>
#include <vector>

#include "etcm/storage.h"

namespace etcm::test {

class MeshBlock {
 public:
  explicit MeshBlock(const MeshConfig& config) : words_(storage_bytes(config) / 8 + 1) {}
  // The same bytes at another place, with no mesh of its own yet.
  MeshBlock(const MeshBlock& other) : words_(other.words_) {}
  MeshBlock& operator=(const MeshBlock&) = delete;

  std::span<std::byte> bytes() { return std::as_writable_bytes(std::span(words_)); }
  Mesh& operator*() { return mesh_; }
  Mesh* operator->() { return &mesh_; }

  // Behind the first byte of what says what the bytes are.
  std::byte& in_seal(std::size_t at) {
    constexpr std::string_view magic = "etcmmesh";
    const auto seal =
        std::search(bytes().begin(), bytes().end(), magic.begin(), magic.end(),
                    [](std::byte a, char b) { return a == static_cast<std::byte>(b); });
    return seal[static_cast<std::ptrdiff_t>(at)];
  }

 private:
  std::vector<std::uint64_t> words_;
  Mesh mesh_;
};

inline constexpr std::size_t seal_version = 8, seal_id_bits = 12, seal_bytes = 16;

}  // namespace etcm::test

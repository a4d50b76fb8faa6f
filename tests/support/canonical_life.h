// A mesh of some family of inputs under random changes, made canonical now and then: it must be the
// mesh that build() makes of what stands.
#pragma once

#include <gtest/gtest.h>

#include <cstdint>
#include <string>
#include <vector>

#include "inputs/random.h"
#include "support/meshes.h"

namespace etcm::test {

class CanonicalLife {
 public:
  // Family, size, policy and how often it is made canonical follow from the seed.
  explicit CanonicalLife(std::uint64_t seed);

  // Makes `events` changes. Fails where the canonical mesh is not that of build().
  testing::AssertionResult live(int events);

  const std::string& name() const { return graph_.name; }
  std::uint64_t compared() const { return compared_; }

 private:
  void change();
  void rehearse();
  testing::AssertionResult compare();
  Position near_something();
  VertexId random_node();
  Position bounded(std::int64_t x, std::int64_t y) const;

  inputs::Random random_;
  Graph graph_;
  std::unique_ptr<OwnedMesh> mesh_;
  SplitPolicy policy_ = split_default;
  Position low_;
  Position high_;
  std::uint64_t each_ = 1;
  std::uint64_t compared_ = 0;
};

}  // namespace etcm::test

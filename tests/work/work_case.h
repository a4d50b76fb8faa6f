// A mesh as few words say it, and a call of it that is to be measured against its limits.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "support/meshes.h"

namespace etcm::test {

// What is done to a mesh. The first few make nodes; nodes and features are named by how many stand
// before them, counted round and round, so that every number names one.
enum class Verb : std::uint8_t {
  node,     // x y: joins
  row,      // count x y dx dy: so many join, each that far from the one before
  ring,     // count x y scale: on one circle, exactly
  scatter,  // count x y side seed: in a square
  line,     // node node: a feature is added
  leave,    // node
  move,     // node x y
  unline,   // feature: it is removed
  canonicalize,
  optimise,  // trials, first trial
  rebuild,
  build,    // of what stands
  restore,  // the same, with its Steiner vertices
  load,     // the same, from bytes
};
inline constexpr std::size_t verb_count = 14;

struct Step {
  Verb verb = Verb::node;
  std::int32_t number[5] = {};
  friend bool operator==(const Step&, const Step&) = default;
};
std::size_t numbers_of(Verb verb);
const char* name_of(Verb verb);

// The last step is the one that is measured: a call, neither a row nor a ring nor a scatter.
struct WorkCase {
  std::vector<Step> steps;
  const Step& last() const { return steps.back(); }
  friend bool operator==(const WorkCase&, const WorkCase&) = default;
};

// As in "row 3 0 0 100 0, line 0 2, leave 1".
std::string to_text(const WorkCase& of);
std::optional<WorkCase> case_from(std::string_view text);

// A mesh that steps are done to, whose storage can be put back to what it was.
class Stage {
 public:
  Stage();
  Stage(const Stage&) = delete;
  Stage& operator=(const Stage&) = delete;

  void clear();
  void do_step(const Step& step);
  // All but the last step of the case, and what the last is to be given.
  void prepare(const WorkCase& of);

  // From here on put_back() makes it the mesh of now.
  void keep();
  void put_back();

  // The call that the step names, of the mesh that prepare() has made; build(), restore() and
  // load() of an empty one.
  Status call(const Step& step, Work limit);
  Mesh& mesh() { return mesh_; }
  // Of the mesh, for what handles and dry runs of a step ask.
  VertexId node(std::int32_t number) const;
  FeatureId feature(std::int32_t number) const;

 private:
  Status call_of_nodes(const Step& step, Work limit);
  void look();
  void join(std::int32_t x, std::int32_t y);
  void join_many(const Step& step);

  std::vector<std::uint64_t> storage_;
  std::vector<std::uint64_t> kept_;
  Mesh mesh_;
  std::vector<VertexId> nodes_;
  std::vector<FeatureId> features_;
  // What build(), restore() and load() are given.
  Graph graph_;
  std::vector<SteinerPlace> steiner_;
  std::vector<std::byte> saved_;
};

// Of so many nodes and features at most.
inline constexpr std::uint32_t stage_nodes = 1200;
inline constexpr std::uint32_t stage_features = 40;

}  // namespace etcm::test

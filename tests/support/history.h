// A mesh that lives: random joins, leaves, moves and features, each judged against a plain list of
// what stands, by brute force; some of them after a dry run, which must answer the same and leave
// no trace.
#pragma once

#include <gtest/gtest.h>

#include <cstddef>
#include <cstdint>
#include <map>
#include <optional>
#include <set>

#include "etcm/dry_run.h"
#include "etcm/mesh.h"
#include "inputs/random.h"

namespace etcm::test {

// Eventful: it begins with a build(); now and then all leave, and few or none stand for a while
// before the others return; and now and then the mesh is made anew, by build(), whole or not, by
// restore() or by rebuild().
enum class Course : std::uint8_t { steady, eventful };

class History {
 public:
  // The mesh must be empty. Nodes stand on [0, side]^2: a small side makes them meet features,
  // Steiner vertices and each other often. About `crowd` nodes stand at a time.
  History(Mesh& mesh, std::int32_t side, std::size_t crowd, std::uint64_t seed,
          Course course = Course::steady)
      : mesh_(mesh), random_(seed), side_(side), crowd_(crowd), course_(course) {}

  // From here on each change may take some random power of two of work, up to 2^`bits`.
  void limit_work(unsigned bits) noexcept { work_bits_ = bits; }

  // Makes one random change. Fails if the answer is wrong, if a refused change changed anything or
  // leaves what fails its audit, or if it took more work than it may.
  testing::AssertionResult step();

  // The nodes and features of the mesh are those of the list.
  testing::AssertionResult agrees() const;

  std::size_t refused_for_room() const noexcept { return refused_for_room_; }
  // How often an ebb has left nobody, and how often build() has left a part undone.
  std::size_t times_empty() const noexcept { return times_empty_; }
  std::size_t times_incomplete() const noexcept { return times_incomplete_; }

 private:
  struct Standing {
    std::map<VertexId, Position> nodes;
    std::map<FeatureId, FeatureEnds> features;
  };
  struct Change {
    const char* name;
    Status answer;
    std::set<Status> expected;
    bool may_lack_room = false;  // then that is a right answer too, whatever else is wrong
    bool is_new = false;         // it made another mesh, refused or not
  };

  Change join();
  Change leave();
  Change move();
  Change add_feature();
  Change remove_feature();
  Change clear_and_build();
  Change clear_and_restore();
  Change rebuild();

  Change next_change();
  Change make_anew();
  // While the tide runs out, until nobody is left.
  Change ebb();
  void turn_the_tide();

  // The limit of the change that comes next, of which ask() may make a dry run first.
  template <class Ask>
  Work limit_after(Ask ask);
  testing::AssertionResult was_foretold(Status answer) const;
  Work next_limit();
  Position random_position();
  VertexId random_node();
  bool is_taken(Position position, VertexId by_other_than) const;
  // What is wrong with features that lie so; ok where nothing is.
  static std::set<Status> faults_of(const Standing& standing);

  Mesh& mesh_;
  inputs::Random random_;
  std::int32_t side_;
  std::size_t crowd_;
  Course course_;
  bool is_begun_ = false;
  bool is_ebbing_ = false;
  std::size_t low_water_ = 0;  // so many stand, for as many steps
  std::size_t low_steps_ = 0;
  Standing standing_;
  unsigned work_bits_ = 0;  // 0: no limit
  Work limit_ = Work::unlimited();
  std::uint64_t changes_ = 0;
  std::optional<Outcome> foretold_;  // by the dry run of the change
  std::int64_t steiner_before_ = 0;
  bool left_a_trace_ = false;
  std::size_t refused_for_room_ = 0;
  std::size_t times_empty_ = 0;
  std::size_t times_incomplete_ = 0;
};

}  // namespace etcm::test

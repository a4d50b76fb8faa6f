// Changes of a mesh, as bytes say: each judged by what mesh.h promises of it.
#pragma once

#include <cstdint>

#include "etcm/dry_run.h"
#include "etcm/handles.h"
#include "etcm/mesh.h"
#include "fuzz_target.h"

namespace etcm::fuzz {

class MeshChanges {
 public:
  // Most nodes stand on multiples of `step`, not far from (0, 0): so they meet features, Steiner
  // vertices and each other. The mesh is open, and so are its handles; they must outlive this.
  MeshChanges(Mesh& mesh, Handles& handles, std::int32_t step)
      : mesh_(mesh), handles_(handles), step_(step) {}

  // Makes one change, often after a dry run of it. One that was refused has left the mesh as it
  // was, and each leaves what passes its audit.
  void make_one(Input& input);

 private:
  enum class Kind : std::uint8_t { of_all, by_parts };
  struct Made {
    Status status = Status::ok;
    Kind kind = Kind::of_all;  // by parts: a refusal may leave another mesh
  };

  Made change(Input& input);
  Made join(Input& input);
  Made leave(Input& input);
  Made move(Input& input);
  Made add_feature(Input& input);
  Made remove_feature(Input& input);
  Made clear_and_build(Input& input);
  Made clear_and_restore(Input& input);
  Made improve(Input& input);
  Made by_handle(Input& input);

  Position position(Input& input) const;
  VertexId vertex(Input& input) const;
  FeatureId feature(Input& input) const;
  template <class Ask, class Change>
  Made after_dry_run(Input& input, Ask ask, Change change);

  Mesh& mesh_;
  Handles& handles_;
  std::int32_t step_;
  Work limit_ = Work::unlimited();
  NodeHandle nodes_[4];
  FeatureHandle lines_[2];
};

// Made canonical, the mesh is the one that build() makes of what stands.
void compare_with_build(Mesh& mesh);

}  // namespace etcm::fuzz

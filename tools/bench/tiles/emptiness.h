// Where no node may stand for a triangle to be one of the mesh: its closed circumdisk, or for a
// ghost the open half-plane behind its edge, and the edge. Exact, for places in whole units.
#pragma once

#include "bench/tiles/quad_tree.h"
#include "etcm/mesh.h"

namespace etcm::bench {

class Emptiness {
 public:
  // Of a counter-clockwise triangle of places.
  static Emptiness disk(Position a, Position b, Position c) noexcept;
  // That of a triangle of nodes alone, or a ghost.
  static Emptiness of(const Mesh& mesh, const Triangle& triangle) noexcept;
  // What is left of the line a -> b, and on it from a to b.
  static Emptiness half_plane(Position a, Position b) noexcept;

  // Whether some place of the square is in it.
  bool meets(const Square& square) const noexcept;
  // Whether all of it is in the square: certain where the answer is true, soon found out.
  bool is_surely_within(const Square& square) const noexcept { return is_within(square, box_); }

 private:
  struct Box {
    double left, right, bottom, top;
  };
  static bool is_within(const Square& square, const Box& box) noexcept {
    return box.left >= square.low.x && box.right <= square.high.x && box.bottom >= square.low.y &&
           box.top <= square.high.y;
  }

  bool is_disk_ = false;
  Position a_, b_, c_;
  Position middle_;  // of the disk, to the nearest place; far off where it is not near
  Box box_{};
};

}  // namespace etcm::bench

// The calls that ask a mesh for more than room may hold: domains, connectivity, readings.
#include <limits>

#include "answer_calls.h"
#include "etcm/analysis.h"
#include "etcm/domain.h"

namespace etcm::test {
namespace {

using enum Status;

// What is asked for and is too little: less by one, and none.
std::set<std::size_t> rooms(std::size_t needed) {
  std::set<std::size_t> sizes{0, needed, needed + 3};
  if (needed != 0) sizes.insert(needed - 1);
  return sizes;
}

// Seeds in triangles, on vertices and features, outside, and where no mesh can be.
std::vector<Point> seeds() {
  std::vector<Point> all;
  for (const Position p : places()) all.push_back(to_point(p));
  all.push_back({1, 1});
  all.push_back({std::numeric_limits<std::int64_t>::max(), 0});
  return all;
}

std::vector<Question> labellings(const Mesh& mesh) {
  std::vector<Question> all;
  const std::size_t needed = mesh.triangle_count();
  for (const Exterior exterior : {Exterior::hull, Exterior::features, Exterior::automatic}) {
    for (const bool has_seeds : {false, true}) {
      for (const std::size_t regions : rooms(needed)) {
        for (const std::size_t words : rooms(needed)) {
          all.push_back({[=](Mesh& m, Work) {
            std::vector<Region> region(regions, Region::hole);
            std::vector<TriangleId> scratch(words);
            const std::vector<Point> holes = has_seeds ? seeds() : std::vector<Point>{};
            const Status status = label_domain(m, exterior, holes, region, scratch);
            EXPECT_EQ(status == ok, regions >= needed && words >= needed);
            for (IdValue i = 0; status == ok && i < needed; ++i) {
              EXPECT_TRUE(!m.triangle(TriangleId{i}).is_ghost() || region[i] == Region::outside);
            }
            return status;
          }});
        }
      }
    }
  }
  return all;
}

std::vector<Question> connections(const Mesh& mesh) {
  std::vector<Question> all;
  const std::size_t needed = mesh.vertex_id_end();
  for (const std::uint32_t range : {1u, 5u, range_max, std::numeric_limits<std::uint32_t>::max()}) {
    for (const std::size_t room : rooms(needed)) {
      all.push_back({[=](Mesh& m, Work) {
        std::vector<ConnectivityScratch> scratch(room);
        Connectivity out;
        const Status status = connectivity(m, range, scratch, out);
        EXPECT_EQ(status == ok, room >= needed);
        EXPECT_EQ(out.parts != 0, status == ok && m.node_count() != 0);
        return status;
      }});
    }
  }
  return all;
}

std::vector<Question> interpolations(const Mesh& mesh) {
  std::vector<Question> all;
  const std::size_t needed = mesh.vertex_id_end();
  for (const Point place : seeds()) {
    for (const std::size_t room : rooms(needed)) {
      all.push_back({[=](Mesh& m, Work) {
        const std::vector<std::int32_t> readings(room, 7);
        Interpolated out;
        const Status status = interpolate(m, place, readings, out);
        EXPECT_EQ(status == ok, room >= needed);
        const bool is_there = status == ok && out.type != LocateType::outside;
        EXPECT_EQ(out.value, is_there ? 7 * subunits_per_unit : 0);
        return status;
      }});
    }
  }
  return all;
}

}  // namespace

std::vector<MeshCall> calls_that_ask() {
  const Refused nothing = Refused::changes_nothing;
  const std::set<Status> promised{ok, buffer_too_small};
  return {
      {"label_domain", promised, nothing, false, false, labellings},
      {"connectivity", promised, nothing, false, false, connections},
      {"interpolate", promised, nothing, false, false, interpolations},
  };
}

}  // namespace etcm::test

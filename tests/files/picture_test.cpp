#include "etcm/files/picture.h"

#include <gmock/gmock.h>

#include <string>
#include <utility>

namespace etcm::files {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

MeshImage square(std::int64_t side) {
  MeshImage image;
  const std::int64_t far = side * subunits_per_unit;
  image.vertices = {
      {{0, 0}, false, 0}, {{far, 0}, false, 0}, {{far, far}, false, 0}, {{0, far}, false, 0}};
  image.node_count = 4;
  image.triangles = {{0, 1, 2}, {0, 2, 3}};
  image.edges = {
      {0, 1, false, 0}, {0, 2, false, 0}, {0, 3, false, 0}, {1, 2, false, 0}, {2, 3, false, 0}};
  return image;
}

TEST(Picture, ExistsForNothingAtAll) {
  EXPECT_THAT(svg_text({}, {"empty", "m"}), HasSubstr("0 nodes"));
  MeshImage one;
  one.vertices = {{{5, 5}, false, 0}};
  one.node_count = 1;
  EXPECT_THAT(svg_text(one, {"one", "m"}), HasSubstr("1 node \xC2\xB7"));
}

TEST(Picture, HasARoundScale) {
  EXPECT_THAT(svg_text(square(1000), {"", "m"}), HasSubstr(">200 m<"));
  EXPECT_THAT(svg_text(square(1), {"", "m"}), HasSubstr(">0.2 m<"));
  EXPECT_THAT(svg_text(square(position_max), {"", "m"}), HasSubstr("000 m<"));
}

TEST(Picture, CountsInMetresWhereThatIsKnown) {
  MeshImage image = square(1000);
  for (const auto& [metres, text] :
       {std::pair{0.01, ">2 m<"}, {10.0, ">2 km<"}, {0.0001, ">0.02 m<"}}) {
    image.metres_per_unit = metres;
    EXPECT_THAT(svg_text(image, {"", "units"}), HasSubstr(text));
    EXPECT_THAT(svg_text(image, {"", "units"}), Not(HasSubstr("units<")));
  }
}

TEST(Picture, HasTheNameOfTheMesh) {
  MeshImage image = square(10);
  image.name = "Tør & <west>";
  EXPECT_THAT(svg_text(image, {"mesh"}), HasSubstr("<title>Tør &amp; &lt;west&gt;</title>"));
  EXPECT_THAT(svg_text(image, {"mesh"}), Not(HasSubstr(">mesh<")));
}

TEST(Picture, EscapesWhatTheUserWrote) {
  const std::string svg = svg_text(square(1), {"a<b>&\"\x01\xff", "<m>"});
  EXPECT_THAT(svg, HasSubstr("a&lt;b&gt;&amp;&quot;??"));
  EXPECT_THAT(svg, HasSubstr("&lt;m&gt;"));
}

TEST(Picture, ShowsUnresolvedPieces) {
  MeshImage image = square(10);
  image.subsegments = {{1, 3, 0, 0, false}};
  EXPECT_THAT(svg_text(image, {}), HasSubstr("1 unresolved"));
  EXPECT_THAT(svg_text(square(10), {}), Not(HasSubstr("unresolved")));
}

TEST(Picture, DashesFeaturesWhereAsked) {
  MeshImage image = square(10);
  image.subsegments = {{0, 1, 0, 0, true}};
  image.feature_count = 1;
  EXPECT_THAT(svg_text(image, {.title = "", .are_features_dashed = true}),
              HasSubstr("stroke-dasharray"));
  EXPECT_THAT(svg_text(image, {}), Not(HasSubstr("stroke-dasharray")));
}

TEST(Picture, LeavesOutAFewFarAwayAndSaysSo) {
  MeshImage image;
  for (std::int64_t i = 0; i < 400; ++i) {
    image.vertices.push_back(
        {{(i % 20) * subunits_per_unit, (i / 20) * subunits_per_unit}, false, 0});
  }
  image.vertices.push_back({{0, 5000 * subunits_per_unit}, false, 0});
  image.node_count = 401;
  EXPECT_THAT(svg_text(image, {}), HasSubstr("1 vertex far off, not shown"));
  image.vertices.pop_back();
  EXPECT_THAT(svg_text(image, {}), Not(HasSubstr("far off")));
}

}  // namespace
}  // namespace etcm::files

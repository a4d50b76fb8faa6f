#include <gmock/gmock.h>

#include <ostream>

#include "etcm/files/constraint_graph.h"
#include "etcm/files/error.h"
#include "etcm/files/grid.h"
#include "etcm/files/record_reader.h"
#include "support/scratch_folder.h"

namespace etcm::files {
namespace {

using test::ScratchFolder;

TEST(Graph, CarriesEverything) {
  const ScratchFolder folder;
  const ConstraintGraph graph = read_graph(
      folder.write("a.poly",
                   "# head\r\n\r\n3 2 2 1 # nodes\r\n0 0 0  1.50 -2  4\r\n1 1e1 0 0 0  -3\r\n"
                   "# between\r\n  2\t5 5. +7 .5 0 # behind\r\n2 1\r\n1 0 1 8\r\n2 2 1 9\r\n"
                   "1\r\n1 0.1 0.2\r\n1\r\n1 3 4 5 0.6"));
  EXPECT_EQ(graph.index_base, 0);
  EXPECT_EQ(graph.feature_base, 1);
  ASSERT_EQ(graph.nodes.size(), 3u);
  EXPECT_EQ(graph.nodes[1].x, Decimal::of(10));
  EXPECT_EQ(graph.nodes[1].marker, -3);
  EXPECT_EQ(graph.nodes[2].line_number, 7u);
  EXPECT_EQ(graph.attributes, (std::vector<std::string>{"1.50", "-2", "0", "0", "+7", ".5"}));
  ASSERT_EQ(graph.features.size(), 2u);
  EXPECT_EQ(graph.features[1].from, 2u);
  EXPECT_EQ(graph.features[1].to, 1u);
  EXPECT_EQ(graph.features[1].marker, 9);
  EXPECT_EQ(feature_name(graph, 1), "feature 2 (2-1)");
  ASSERT_EQ(graph.holes.size(), 1u);
  EXPECT_EQ(graph.holes[0].y.to_string(), "0.2");
  ASSERT_EQ(graph.regions.size(), 1u);
  EXPECT_EQ(graph.regions[0].values, (std::vector<std::string>{"5", "0.6"}));
}

TEST(Graph, TakesNodesFromTheNodeFile) {
  const ScratchFolder folder;
  folder.write("b.node", "2 2 0 0\n1 0 0\n2 3 4\n");
  const ConstraintGraph graph = read_graph(folder.write("b.poly", "0 2 1 1\n1 0\n1 1 2\n0\n"));
  EXPECT_EQ(graph.nodes.size(), 2u);
  EXPECT_EQ(graph.features.size(), 1u);
  EXPECT_EQ(graph.attribute_count, 0u);
  EXPECT_EQ(read_graph(folder.path("b.node")).nodes.size(), 2u);
}

TEST(Graph, BeginsBehindTheMarkThatAnEditorPutBeforeIt) {
  const ScratchFolder folder;
  const ConstraintGraph graph = read_graph(folder.write("m.node",
                                                        "\xef\xbb\xbf"
                                                        "1 2\n1 3 4\n"));
  ASSERT_EQ(graph.nodes.size(), 1u);
  EXPECT_EQ(graph.nodes[0].y, Decimal::of(4));
}

TEST(Graph, OfAFileThatIsNotThereSaysWhatToDo) {
  const ScratchFolder folder;
  for (const std::string& path : {folder.path("none.poly"), folder.path("")}) {
    try {
      read_text(path);
      ADD_FAILURE() << path;
    } catch (const InputError& error) {
      EXPECT_THAT(error.what(), testing::StartsWith(path + ": cannot be "));
      EXPECT_THAT(error.what(), testing::EndsWith("; check the path"));
    }
  }
}

TEST(Graph, MayBeEmpty) {
  const ScratchFolder folder;
  folder.write("c.node", "0 2 0 0\n");
  EXPECT_EQ(read_graph(folder.write("c.poly", "0\n0\n0\n")).nodes.size(), 0u);
}

TEST(Graph, IsPlacedExactly) {
  const ScratchFolder folder;
  const ConstraintGraph graph =
      read_graph(folder.write("d.node", "2 2\n1 0.1 -0.3\n2 1677721.6 2.5e0\n"));
  const GridGraph scaled = place_on_grid(graph, {.scale = Decimal::of(10), .round = false});
  EXPECT_EQ(scaled.nodes[0], (Position{1, -3}));
  EXPECT_EQ(scaled.nodes[1], (Position{position_max, 25}));
  const GridGraph rounded = place_on_grid(graph, {.scale = {}, .round = true});
  EXPECT_EQ(rounded.nodes[1], (Position{1677722, 3}));
}

struct BadInput {
  const char* name;
  std::string text;
  const char* message;  // after the path
};
void PrintTo(const BadInput& input, std::ostream* out) { *out << input.name; }

class GraphRefusal : public ::testing::TestWithParam<BadInput> {};

TEST_P(GraphRefusal, NamesLineAndFault) {
  const ScratchFolder folder;
  const std::string path = folder.write("bad.poly", GetParam().text);
  try {
    const ConstraintGraph graph = read_graph(path);
    (void)place_on_grid(graph, {});
    FAIL() << "was accepted";
  } catch (const InputError& error) {
    const std::string text = error.what();
    EXPECT_EQ(text.find('\n'), std::string::npos);
    EXPECT_EQ(text.substr(0, path.size()), path);
    EXPECT_THAT(text.substr(path.size()), ::testing::HasSubstr(GetParam().message));
  }
}

const std::string triangle = "3 2 0 0\n1 0 0\n2 9 0\n3 0 9\n";

INSTANTIATE_TEST_SUITE_P(
    EveryFault, GraphRefusal,
    ::testing::Values(
        BadInput{"Empty", "", ":1: the file ends"},
        BadInput{"OnlyComments", "# a\n# b\n", ":2: the"},
        BadInput{"NulByte", std::string("3 2\n1 0\0 0\n", 12), ":2: contains a NUL byte"},
        BadInput{"Binary",
                 "\x7f"
                 "ELF\x02\x01",
                 ":1: the number of nodes '?ELF"},
        BadInput{"Utf16",
                 "\xff\xfe"
                 "3",
                 ":1: the number of nodes"},
        BadInput{"NotUtf8", triangle + "1 0\n1 1 \xff\n0\n", ":6: the endpoint '?' is no decimal"},
        BadInput{"NegativeCount", "-3 2 0 0\n", ":1: the number of nodes is -3; it must not"},
        BadInput{"HugeCount", "268435454 2 0 0\n1 0 0\n", ":2: the file ends before node 2 of"},
        BadInput{"AbsurdCount", "99999999999999999999 2\n", ":1: the number of nodes '9999"},
        BadInput{"CountTooHigh", "999999999999 2\n", ":1: the number of nodes is 999999999999; it"},
        BadInput{"FractionalCount", "2.5 2 0 0\n", ":1: the number of nodes '2.5' is no integer"},
        BadInput{"ThreeDimensions", "1 3 0 0\n1 0 0 0\n", ":1: the dimension is 3"},
        BadInput{"TooManyAttributes", "1 2 1001 0\n", ":1: the number of attributes is 1001"},
        BadInput{"TwoMarkers", "1 2 0 2\n1 0 0 1 1\n", ":1: the number of boundary markers is 2"},
        BadInput{"HeaderGarbage", "1 2 0 0 7\n1 0 0\n", ":1: the first line has 5 fields"},
        BadInput{"FewerNodes", "3 2\n1 0 0\n2 1 1\n", ":3: the file ends before node 3 of 3"},
        BadInput{"ShortNode", "1 2\n1 0\n", ":2: this node has 2 fields, not 3"},
        BadInput{"LongNode", "1 2\n1 0 0 0\n", ":2: this node has 4 fields, not 3"},
        BadInput{"FirstNodeIsTwo", "1 2\n2 0 0\n", ":2: the first node has number 2"},
        BadInput{"NodesOutOfOrder", "2 2\n1 0 0\n3 1 1\n", ":3: node number 3 stands where 2 must"},
        BadInput{"Words", "1 2\n1 east 0\n", ":2: x 'east' is no decimal number"},
        BadInput{"NotANumber", "1 2\n1 nan 0\n", ":2: x 'nan' is no decimal number"},
        BadInput{"Infinite", "1 2\n1 0 inf\n", ":2: y 'inf' is no decimal number"},
        BadInput{"Hexadecimal", "1 2\n1 0x10 0\n", ":2: x '0x10' is no decimal number"},
        BadInput{"DecimalComma", "1 2\n1 1,5 0\n", ":2: x '1,5' is no decimal number"},
        BadInput{"WordAttribute", "1 2 1\n1 0 0 red\n", ":2: attribute 'red' is no decimal"},
        BadInput{"HugeMarker", "1 2 0 1\n1 0 0 4294967296\n", ":2: the boundary marker 4294967296"},
        BadInput{"Fraction", "1 2\n1 0.1 0\n0\n0\n", ":2: x 0.1 is no integer; use --scale S"},
        BadInput{"OutOfRange", "1 2\n1 0 16777217\n0\n0\n", ":2: y 16777217 is out of range"},
        BadInput{"FarOutOfRange", "1 2\n1 1e300 0\n0\n0\n", ":2: x 1e300 is out of range"},
        BadInput{"NoNodeFile", "0 2 0 0\n0\n0\n", ":1: no nodes here, so they must stand in"},
        BadInput{"NoSegments", triangle, ":4: the file ends before the line that counts the seg"},
        BadInput{"FewerSegments", triangle + "2 0\n1 1 2\n", ":6: the file ends before segment 2"},
        BadInput{"ShortSegment", triangle + "1 0\n1 1\n0\n", ":6: this segment has 2 fields"},
        BadInput{"UnknownEndpoint", triangle + "1 0\n1 1 4\n0\n",
                 ":6: endpoint 4 is no node; nodes"},
        BadInput{"EndpointZero", triangle + "1 0\n1 0 2\n0\n", ":6: endpoint 0 is no node"},
        BadInput{"NegativeEndpoint", triangle + "1 0\n1 -1 2\n0\n", ":6: endpoint -1 is no node"},
        BadInput{"NoHoles", triangle + "0 0\n",
                 ":5: the file ends before the line that counts the h"},
        BadInput{"FewerHoles", triangle + "0 0\n1\n", ":6: the file ends before hole 1 of 1"},
        BadInput{"ShortHole", triangle + "0 0\n1\n1 3\n", ":7: this hole has 2 fields"},
        BadInput{"ShortRegion", triangle + "0 0\n0\n1\n1 3 3\n",
                 ":8: this regional attribute has 3"},
        BadInput{"Garbage", triangle + "0 0\n0\n0\nmore\n", ":8: 'more' stands after the end"}),
    [](const auto& row) { return row.param.name; });

TEST(Graph, SaysWhatTheSystemSays) {
  const ScratchFolder folder;
  EXPECT_THROW((void)read_graph(folder.path("missing.poly")), InputError);
  EXPECT_THROW((void)read_graph(folder.path("")), InputError);
}

}  // namespace
}  // namespace etcm::files

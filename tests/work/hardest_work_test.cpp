// Calls that came beyond their limit before they were mended, or with a fault that was planted, and
// those that a search found to come nearest to it.
#include <gtest/gtest.h>

#include <fstream>
#include <ostream>
#include <string>
#include <vector>

#include "support/emulated.h"
#include "work_judge.h"

namespace etcm::test {
namespace {

// Of small calls each limit.
constexpr std::uint64_t limits_most = is_slow ? 24 : 512;

void expect_within_limits(Stage& stage, const std::string& text) {
  const std::optional<WorkCase> of = case_from(text);
  ASSERT_TRUE(of) << text;
  for (const Way way : {Way::change, Way::dry_run}) {
    if (way == Way::dry_run && !has_dry_run(of->last().verb)) continue;
    EXPECT_EQ(judge(stage, *of, way, limits_most).fault, "")
        << (way == Way::dry_run ? "dry run: " : "") << text;
  }
}

struct Mended {
  const char* name;
  const char* text;
};
void PrintTo(const Mended& mended, std::ostream* out) { *out << mended.name; }

constexpr Mended all_mended[] = {
    {"whole_mesh_goes_back_where_some_see_a_long_row",
     "row 8 7 0 141 0, row 8 0 141 141 0, row 8 -1 282 141 0, canonicalize, row 400 0 423 141 0, "
     "row 8 -51619 282 141 0, node 13 -22, row 4 0 352 141 0, row 8 0 846 141 1916, "
     "row 8 4 987 141 0, node -838220 128582, unline 8, node 36950 -343519, node -1162 -2, "
     "line 55 7, canonicalize"},
    {"feature_beside_a_row_goes", "scatter 1 0 1 0 0, row 13 0 0 1 0, line 0 24, unline 0"},
    {"join_on_a_feature_of_a_hub", "node 0 0, ring 26 0 0 1, line 0 1, node 1 0"},
    {"second_node", "node 0 0, node -1 0"},
    {"next_of_a_row", "row 5 0 0 10 0, node 50 0"},
    {"feature_between_two_rows_goes",
     "node 0 0, node 5734 0, row 37 77 -39 155 0, row 37 51 39 155 0, node 2867 9487, line 0 1, "
     "unline 22"},
    {"feature_of_a_hub_goes",
     "node 0 0, ring 17 0 0 1, line 0 2, line 0 9, line 0 6, node 0 13, unline 0"},
    {"trial_beside_rows", "row 14 0 0 1 0, row 18 0 -1 5 0, line -1970415 0, optimise 1 0"},
    {"feature_along_two_rows_goes",
     "scatter 22 0 58 -2934 -3912, leave 6, row 100 112 -2146857 231 -7, line 0 100, "
     "row 21 -189 139 246 63, unline 0"},
    {"node_leaves_that_kept_a_feature_apart",
     "row 19 0 1 1 0, move 43 0 -17, node 1 0, line 1 5, ring 4 0 0 1, node 0 0, node 0 -8, leave "
     "0, "
     "leave 9624"},
    {"node_comes_where_a_split_goes",
     "ring 33 0 0 109, ring 26 0 3534 55, row 1 0 0 0 0, line 5 52, move 0 0 1"},
    {"move_onto_another_node",
     "node -1 0, node 0 0, node 1 0, ring 1 0 1 485, row 44 304 0 0 1, line 0 3, move 150 0 0"},
    {"node_comes_back_from_afar",
     "ring 16 0 217 1, row 61 0 0 0 -61, line 7 75, ring 2 0 -2970 2, "
     "move 72 -1 0"},
    {"rows_are_laid_again",
     "node 3559 -1380, line -1547 31, node 238 1183, unline 50, optimise 28 3559, "
     "row 13 -1 -5 196 525, line 57 85, row 47 -1612634 -63836 123 -10, rebuild"},
    {"chord_of_a_circle", "ring 18 0 0 2202, line -8012 -78"},
    {"chord_of_a_circle_goes", "ring 30 0 0 3795, line 50 12, unline 1"},
    {"end_of_chords_moves", "ring 17 0 0 493, line 14 58, line 9 23, line 84 43, move 65 0 -16"},
    {"move_beside_a_feature_that_rows_split",
     "node 0 0, node 7524 0, row 44 85 -22 171 0, row 44 52 22 171 0, node 3762 5647, line 0 1, "
     "move 33 15 5"},
    {"needless_vertex_before_a_row_comes_back",
     "node -7500 0, node 22500 0, node 7500 -3, row 100 50 4000000 100 0, "
     "row 50 10050 4000000 100 0, line 0 1, move 2 17500 -3"},
    {"needless_vertex_before_a_row_comes_back_from_the_other_side",
     "node 7500 0, node -22500 0, node -7500 -3, row 100 -50 4000000 -100 0, "
     "row 50 -10050 4000000 -100 0, line 0 1, move 2 -17500 -3"},
    {"feature_of_hundreds_of_splits",
     "scatter 47 0 0 3 4833374, row 33 -3517 19 14 -108921, line 60 34, canonicalize, line 28 60, "
     "line 43 43, line 19 16, leave 0, line 27 -47150"},
    {"trial_beside_a_node_with_many_neighbours",
     "node 83 0, node 0 0, row 49 1 -1 0 2, line 0 1, row 22 0 -165 1 2, optimise 1 0"},
    {"move_touches_a_feature_far_apart",
     "node 0 0, node 471 0, row 91 4 -1 6 0, row 92 0 1 6 0, line 0 1, move -1 1 -1"},
    {"marks_of_a_feature_through_a_ring_come_back",
     "scatter 6 0 0 4 0, move 0 0 7, node 0 0, ring 36 0 34 1, move 9 0 0, line 93 0, unline 0"},
    {"vertex_of_a_trial_comes_back_far_from_the_one_before",
     "ring 14 0 0 -2565, line 5 -5565, line -63 43583, row 222 0 0 1 0, scatter 1 0 0 0 -3, "
     "optimise -68760 4247"},
};

class MendedWork : public testing::TestWithParam<Mended> {
 public:
  static std::string name(const testing::TestParamInfo<Mended>& info) { return info.param.name; }
};

TEST_P(MendedWork, StaysWithinTheLimit) {
  Stage stage;
  expect_within_limits(stage, GetParam().text);
}

INSTANTIATE_TEST_SUITE_P(All, MendedWork, testing::ValuesIn(all_mended), MendedWork::name);

TEST(HardestWork, StaysWithinTheLimit) {
  Stage stage;
  std::ifstream file(ETCM_HARDEST_WORK);
  std::size_t count = 0;
  for (std::string text; std::getline(file, text); ++count) {
    if (count % thinning_if_slow != 0) continue;
    expect_within_limits(stage, text);
  }
  EXPECT_GT(count, 100u) << ETCM_HARDEST_WORK;
}

TEST(WorkCases, AreReadAsTheyAreWritten) {
  const std::string text = "row 3 0 0 100 -1, line 0 2, canonicalize, leave 1";
  const std::optional<WorkCase> of = case_from(text);
  ASSERT_TRUE(of);
  EXPECT_EQ(to_text(*of), text);
  EXPECT_FALSE(case_from("row 3 0, leave 1"));
  EXPECT_FALSE(case_from("stay 1"));
  EXPECT_FALSE(case_from(""));
}

}  // namespace
}  // namespace etcm::test

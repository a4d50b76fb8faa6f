// Every status has a name and a sentence of its own.
#include "etcm/status.h"

#include <gtest/gtest.h>

#include <cctype>
#include <set>
#include <string>

namespace {

constexpr auto last_status = etcm::Status::damaged;

TEST(Status, EveryCodeHasANameOfItsOwn) {
  std::set<std::string> names;
  for (int code = 0; code <= static_cast<int>(last_status); ++code) {
    const std::string name = etcm::to_string(static_cast<etcm::Status>(code));
    EXPECT_NE(name, "unknown_status") << code;
    EXPECT_TRUE(names.insert(name).second) << name << " stands twice";
  }
  EXPECT_STREQ(etcm::to_string(etcm::Status::ok), "ok");
  EXPECT_STREQ(etcm::to_string(etcm::Status::crossing_features), "crossing_features");
}

// Logs of devices in the field have them, so a new one goes behind the last.
TEST(Status, HasItsNumberForGood) {
  const char* const names[] = {"ok",
                               "bad_config",
                               "storage_too_small",
                               "bad_coordinate",
                               "duplicate_vertex",
                               "unknown_vertex",
                               "unknown_feature",
                               "stale_handle",
                               "zero_length_feature",
                               "repeated_feature",
                               "overlapping_features",
                               "crossing_features",
                               "endpoint_in_use",
                               "mesh_not_empty",
                               "mesh_unresolved",
                               "buffer_too_small",
                               "out_of_vertices",
                               "out_of_features",
                               "out_of_handles",
                               "steiner_budget",
                               "work_limit",
                               "grid_exhausted",
                               "not_a_mesh",
                               "wrong_version",
                               "wrong_byte_order",
                               "wrong_id_width",
                               "damaged"};
  int number = 0;
  for (const char* const name : names) {
    EXPECT_STREQ(etcm::to_string(static_cast<etcm::Status>(number++)), name);
  }
}

// Handles::open() asks for other storage than Mesh::open(); save(), connectivity() and others
// return no count, and to configure may be wrong for want of a policy.
TEST(Status, ExplanationsHoldForEachCallThatAnswersThem) {
  const auto says = [](etcm::Status status, const char* word) {
    return std::string(etcm::explain(status)).find(word) != std::string::npos;
  };
  EXPECT_TRUE(says(etcm::Status::storage_too_small, "Handles::words"));
  EXPECT_FALSE(says(etcm::Status::buffer_too_small, "returned"));
  EXPECT_TRUE(says(etcm::Status::bad_config, "policy"));
}

TEST(Status, EveryCodeIsExplainedInOneSentence) {
  std::set<std::string> sentences;
  for (int code = 0; code <= static_cast<int>(last_status); ++code) {
    const std::string sentence = etcm::explain(static_cast<etcm::Status>(code));
    ASSERT_GT(sentence.size(), 10U) << code;
    EXPECT_TRUE(std::isupper(static_cast<unsigned char>(sentence.front())) != 0) << sentence;
    EXPECT_EQ(sentence.back(), '.') << sentence;
    EXPECT_EQ(sentence.find(". "), std::string::npos) << "more than one sentence: " << sentence;
    EXPECT_TRUE(sentences.insert(sentence).second) << sentence;
  }
}

TEST(Status, AValueOutsideTheEnumerationIsNamedAsSuch) {
  const auto stray = static_cast<etcm::Status>(static_cast<int>(last_status) + 1);
  EXPECT_STREQ(etcm::to_string(stray), "unknown_status");
  EXPECT_NE(etcm::explain(stray), nullptr);
}

}  // namespace

// JSON files: values with their digits and lines, and what is said about what is none.
#include "etcm/files/json.h"

#include <gtest/gtest.h>

#include "support/scratch_folder.h"

namespace etcm::files {
namespace {

class Json : public testing::Test {
 protected:
  JsonValue read(const std::string& text) { return read_json(folder_.write("a.json", text)); }
  std::string error_of(const std::string& text) {
    try {
      static_cast<void>(read(text));
    } catch (const InputError& error) {
      return std::string(error.what()).substr(folder_.path("a.json").size());
    }
    return "good";
  }
  test::ScratchFolder folder_;
};

TEST_F(Json, NumbersKeepTheirDigits) {
  const JsonValue value =
      read("[0.1000000000000000000001, -3, 1E2, 123456789012345678901234567890]");
  ASSERT_EQ(value.items.size(), 4u);
  EXPECT_EQ(value.items[0].text, "0.1000000000000000000001");
  EXPECT_EQ(value.items[1].text, "-3");
  EXPECT_EQ(value.items[2].text, "1E2");
  EXPECT_EQ(value.items[3].text, "123456789012345678901234567890");
}

TEST_F(Json, EveryValueKnowsItsLine) {
  const JsonValue value = read("{\"a\":\n[1,\n2\n,\"x\"],\n\n\"b\": null}\n");
  EXPECT_EQ(value.line_number, 1u);
  const JsonValue& a = *value.find("a");
  EXPECT_EQ(a.line_number, 2u);
  EXPECT_EQ(a.items[0].line_number, 2u);
  EXPECT_EQ(a.items[1].line_number, 3u);
  EXPECT_EQ(a.items[2].line_number, 4u);
  EXPECT_EQ(value.find("b")->line_number, 6u);
  EXPECT_EQ(value.find("c"), nullptr);
}

TEST_F(Json, WhatIsNoneIsNamedWithItsLine) {
  EXPECT_EQ(error_of("{\"a\": 1,\n \"a\": 2}"), ":2: 'a' stands twice; take one out");
  for (const auto& [text, line] : {std::pair{"", 1},
                                   {"{\n\"a\" 1}", 2},
                                   {"[1,\n2", 2},
                                   {"[1]\n[2]", 2},
                                   {"[NaN]", 1},
                                   {"[\n1e999]", 2},
                                   {"[\n\n01]", 3},
                                   {"[\"\xff\"]", 1},
                                   {"[\"\n\"]", 1}}) {
    const std::string error = error_of(text);
    EXPECT_TRUE(error.starts_with(":" + std::to_string(line) + ": is no JSON: ")) << text << error;
    EXPECT_TRUE(error.ends_with("; correct it there, or export the file again")) << error;
    EXPECT_EQ(error.find('\n'), std::string::npos);
  }
}

TEST_F(Json, HostileFilesCostLittle) {
  const std::string deep(100'000, '[');
  EXPECT_NE(error_of(deep).find("nested more than 64 deep"), std::string::npos);
  std::string many = "[0";
  for (std::size_t i = 0; i < JsonBounds{}.values; ++i) many += ",0";
  EXPECT_NE(error_of(many + "]").find("more than 1000000 values"), std::string::npos);
  std::string keys = "{";
  for (int i = 0; i <= 1000; ++i) keys += "\"" + std::to_string(i) + "\":0,";
  EXPECT_NE(error_of(keys).find("more than 1000 keys"), std::string::npos);
  EXPECT_NE(error_of(std::string(json_bytes_max + 1, ' ')).find("bytes; check the path"),
            std::string::npos);
  EXPECT_THROW(static_cast<void>(read_json("/dev/zero")), InputError);
  EXPECT_THROW(static_cast<void>(read_json(folder_.path("nowhere"))), InputError);
  EXPECT_THROW(static_cast<void>(read_json("/")), InputError);
}

}  // namespace
}  // namespace etcm::files

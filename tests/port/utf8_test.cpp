// Texts are cut between characters, and what is no character is found.
#include "etcm/port/utf8.h"

#include <gtest/gtest.h>

#include <string>

#include "support/utf8_check.h"

namespace etcm::port {
namespace {

TEST(Utf8, AllThatTheCLibraryTakesIsACharacter) {
  // Each first byte, with what can change the verdict behind it.
  const unsigned char edges[] = {0x00, 0x7f, 0x80, 0x8f, 0x90, 0x9f, 0xa0, 0xbf, 0xc0, 0xff};
  for (unsigned first = 0; first < 256; ++first) {
    for (const unsigned char second : edges) {
      for (const unsigned char third : edges) {
        for (const unsigned char fourth : edges) {
          const std::string text{static_cast<char>(first), static_cast<char>(second),
                                 static_cast<char>(third), static_cast<char>(fourth)};
          std::size_t expected = 0;
          for (std::size_t size = 4; size > 0; --size) {
            if (test::is_utf8(text.substr(0, size))) expected = size;
          }
          ASSERT_EQ(utf8_character(text), expected) << first << " " << +second << " " << +third;
        }
      }
    }
  }
  EXPECT_EQ(utf8_character(""), 0u);
}

TEST(Utf8, ATextIsCutBeforeTheCharacterThatDoesNotFit) {
  const std::string text = "a\u00e4\u20ac\U0001f600";
  const std::size_t cuts[] = {0, 1, 1, 3, 3, 3, 6, 6, 6, 6, 10};
  for (std::size_t bytes = 0; bytes <= text.size(); ++bytes) {
    EXPECT_EQ(cut_utf8(text, bytes).size(), cuts[bytes]) << bytes;
  }
  EXPECT_EQ(cut_utf8(text, 99), text);
  // Of what is no text as much stays as may.
  EXPECT_EQ(cut_utf8("a\x80\x80\x80\x80\x80\x80", 5).size(), 5u);
}

TEST(Utf8, WordsStayWhole) {
  EXPECT_EQ(cut_words("see /guide now", 14), "see /guide now");
  EXPECT_EQ(cut_words("see /guide now", 11), "see /guide");
  EXPECT_EQ(cut_words("see /guide now", 10), "see /guide");
  EXPECT_EQ(cut_words("see /guide now", 9), "see");
  EXPECT_EQ(cut_words("a\u00e4\u00e4", 4), "a\u00e4") << "there is one word";
}

}  // namespace
}  // namespace etcm::port

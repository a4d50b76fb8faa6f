// Texts in UTF-8 that are cut to a size, or that come from who may not write UTF-8.
#pragma once

#include <cstddef>
#include <string_view>

namespace etcm::port {

// The bytes of the character that `text` begins with: 1 to 4, or 0 where it begins with none.
std::size_t utf8_character(std::string_view text);

// As much of `text` as fits into `bytes_max`, up to the end of a character.
std::string_view cut_utf8(std::string_view text, std::size_t bytes_max);

// The same, up to the end of a word: a name, a number or an address that is cut is another one.
// Where there are no words, up to the end of a character.
std::string_view cut_words(std::string_view text, std::size_t bytes_max);

}  // namespace etcm::port

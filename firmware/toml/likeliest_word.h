// Which word was most likely meant by one that is none of those there are.
#pragma once

#include <string_view>
#include <vector>

namespace etcm::firmware {

// Empty where none is like it. The first of those that are as likely.
std::string_view likeliest_word(const std::vector<std::string_view>& words, std::string_view typed);

}  // namespace etcm::firmware

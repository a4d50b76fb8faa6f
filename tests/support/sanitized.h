// Whether AddressSanitizer looks on: GCC and Clang say it in ways of their own.
#pragma once

namespace etcm::test {

#if defined(__SANITIZE_ADDRESS__)
inline constexpr bool is_address_sanitized = true;
#elif defined(__has_feature)
#if __has_feature(address_sanitizer)
inline constexpr bool is_address_sanitized = true;
#else
inline constexpr bool is_address_sanitized = false;
#endif
#else
inline constexpr bool is_address_sanitized = false;
#endif

}  // namespace etcm::test

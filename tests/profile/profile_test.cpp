// What a profile reads, and what a sweep says of the position.
#include <random>

#include "device.h"

namespace etcm::firmware {
namespace {

std::string with_readings(const std::string& keys, const std::vector<RegisterSpan>& spans) {
  std::string text = "[[profile]]\nname = 'p'\n" + keys + "\n";
  for (const RegisterSpan span : spans) {
    text += "[[profile.reading]]\nname = 'r" + std::to_string(span.first) +
            "'\nvalue = { register = " + std::to_string(span.first) + ", type = " +
            (span.count == 1   ? "'u16'"
             : span.count == 2 ? "'u32'"
                               : "'u64'") +
            " }\n";
  }
  return text;
}

std::vector<RegisterSpan> blocks(const std::string& keys, const std::vector<RegisterSpan>& spans) {
  return blocks_of(sound_profile(with_readings(keys, spans)));
}

TEST(ProfileBlocks, JoinNeighbours) {
  using Spans = std::vector<RegisterSpan>;
  EXPECT_EQ(blocks("", {{10, 2}, {12, 4}, {8, 2}}), (Spans{{8, 8}}));
  EXPECT_EQ(blocks("", {{10, 2}, {13, 1}}), (Spans{{10, 2}, {13, 1}}));
  EXPECT_EQ(blocks("gap_max = 1", {{10, 2}, {13, 1}}), (Spans{{10, 4}}));
  EXPECT_EQ(blocks("gap_max = 1", {{10, 2}, {14, 1}}), (Spans{{10, 2}, {14, 1}}));
  EXPECT_EQ(blocks("", {{65532, 4}, {0, 1}}), (Spans{{0, 1}, {65532, 4}}));
}

TEST(ProfileBlocks, SplitNoNumber) {
  using Spans = std::vector<RegisterSpan>;
  EXPECT_EQ(blocks("block_max = 5", {{0, 4}, {4, 2}, {6, 1}}), (Spans{{0, 4}, {4, 3}}));
  EXPECT_EQ(blocks("block_max = 4", {{0, 1}, {1, 4}, {3, 1}}), (Spans{{0, 1}, {1, 4}}));
  EXPECT_EQ(blocks("gap_max = 125", {{0, 1}, {124, 1}}), (Spans{{0, 125}}));
  EXPECT_EQ(blocks("gap_max = 125", {{0, 1}, {124, 2}}), (Spans{{0, 1}, {124, 2}}));
}

// The fewest blocks for these, by trying where each begins and ends.
std::size_t fewest(std::vector<RegisterSpan> spans, unsigned block_max, unsigned gap_max) {
  if (spans.empty()) return 0;
  std::size_t best = spans.size();
  const unsigned first = std::min_element(spans.begin(), spans.end(), [](auto a, auto b) {
                           return a.first < b.first;
                         })->first;
  for (unsigned end = first + 1; end <= first + block_max; ++end) {
    std::vector<RegisterSpan> outside;
    std::vector<bool> is_used(end - first);
    for (const RegisterSpan span : spans) {
      if (span.end() > end) {
        outside.push_back(span);
        continue;
      }
      for (unsigned at = span.first; at < span.end(); ++at) is_used[at - first] = true;
    }
    unsigned gap = 0;
    bool is_allowed = is_used.back() && outside.size() < spans.size();
    for (const bool used : is_used) {
      gap = used ? 0 : gap + 1;
      if (gap > gap_max) is_allowed = false;
    }
    if (is_allowed) best = std::min(best, 1 + fewest(outside, block_max, gap_max));
  }
  return best;
}

TEST(ProfileBlocks, AreTheFewest) {
  std::mt19937 random(20261122);
  for (int round = 0; round < 300; ++round) {
    std::vector<RegisterSpan> spans;
    for (unsigned at = 0; at < 24; ++at) {
      if (random() % 3 == 0) {
        spans.push_back(
            {static_cast<std::uint16_t>(at), static_cast<std::uint16_t>(1u << random() % 3)});
      }
    }
    if (spans.empty() || spans.size() > 8) continue;
    const unsigned block_max = 4 + random() % 8;
    const unsigned gap_max = random() % 4;
    const auto found = blocks(
        "block_max = " + std::to_string(block_max) + "\ngap_max = " + std::to_string(gap_max),
        spans);
    EXPECT_EQ(found.size(), fewest(spans, block_max, gap_max));
    for (const RegisterSpan block : found) EXPECT_LE(block.count, block_max);
    for (const RegisterSpan span : spans) {
      EXPECT_EQ(Sweep(found, std::vector<std::uint16_t>(200)).at(span).size(), span.count);
    }
  }
}

TEST(Profile, CountsAsTheManualDoes) {
  const Profile profile = sound_profile(
      "[[profile]]\nname = 'p'\ncounts_from = 40001\nserial = { register = 40001 }\n"
      "x = { register = 40003 }\ny = { register = 105536, negative_if = { register = 40004, equals "
      "= 1 "
      "} }\n");
  EXPECT_EQ(blocks_of(profile), (std::vector<RegisterSpan>{{0, 1}, {2, 2}, {65535, 1}}));
  EXPECT_EQ(profile.counts_from, 40001u);
}

Device on_earth(const std::string& keys = "") {
  return Device(sound_profile("[[profile]]\nname = 'p'\n" + keys +
                              "\nlongitude = { register = 0, type = 'i16', none = 999 }\n"
                              "latitude = { register = 1, type = 'i16' }\n"));
}

TEST(ProfilePosition, IsWithinTheEarth) {
  Device device = on_earth();
  const auto is_position = [&](int longitude, int latitude) {
    device.set(0, {word(longitude), word(latitude)});
    return device.position().is_value();
  };
  EXPECT_TRUE(is_position(180, 90));
  EXPECT_TRUE(is_position(-180, -90));
  using Told = DevicePosition::State;
  EXPECT_FALSE(is_position(181, 5));
  EXPECT_EQ(device.position().state, Told::beyond_longitude);
  EXPECT_FALSE(is_position(-181, 5));
  EXPECT_FALSE(is_position(5, 91));
  EXPECT_EQ(device.position().state, Told::beyond_latitude);
  EXPECT_FALSE(is_position(5, -91));
  EXPECT_FALSE(is_position(0, 0)) << "where receivers without a fix say that they are";
  EXPECT_EQ(device.position().state, Told::zero);
  EXPECT_TRUE(is_position(0, 1));
  EXPECT_TRUE(is_position(1, 0));
  EXPECT_FALSE(is_position(999, 1));
  EXPECT_EQ(device.position().state, DevicePosition::State::none);
}

TEST(ProfilePosition, HasItsCoordinates) {
  Device device = on_earth();
  device.set(0, {word(-7), 48});
  EXPECT_EQ(device.position().east_nano, -7'000'000'000);
  EXPECT_EQ(device.position().north_nano, 48'000'000'000);
}

TEST(ProfilePosition, IsInvalidWhereTheDeviceSaysSo) {
  Device device =
      on_earth("valid = [{ register = 5000, equals = 1 }, { register = 5001, at_least = 4 }]");
  EXPECT_EQ(device.blocks().size(), 2u);
  device.set(0, {7, 48});
  EXPECT_EQ(device.position().state, DevicePosition::State::invalid);
  device.set(5000, {1, 3});
  EXPECT_EQ(device.position().state, DevicePosition::State::invalid);
  device.set(5000, {1, 4});
  EXPECT_TRUE(device.position().is_value());
}

TEST(ProfilePosition, IsAnywhereInThePlane) {
  Device device(
      sound_profile("[[profile]]\nname = 'p'\nx = { register = 0, type = 'i32' }\n"
                    "y = { register = 2, type = 'i32', range = [-5, 5] }\n"));
  EXPECT_TRUE(device.position().is_value()) << "also at 0, 0";
  device.set(0, {0x7fff, 0xffff});
  EXPECT_EQ(device.position().east_nano, 2'147'483'647'000'000'000);
  device.set(3, {6});
  EXPECT_FALSE(device.position().is_value());
}

TEST(ProfilePosition, IsNoneWhereItWasSurveyed) {
  EXPECT_EQ(device_of("register = 0").position().state, DevicePosition::State::unknown);
}

std::vector<std::uint16_t> in_letters(std::string text, std::size_t registers) {
  text.resize(2 * registers, ' ');
  std::vector<std::uint16_t> words;
  for (std::size_t i = 0; i < registers; ++i) {
    words.push_back(static_cast<std::uint16_t>(text[2 * i] << 8 | text[2 * i + 1]));
  }
  return words;
}

TEST(ProfilePosition, IsNoneWhereALetterIsOfTheOtherAxis) {
  using Told = DevicePosition::State;
  Device device(
      sound_profile("[[profile]]\nname = 'p'\n"
                    "longitude = { register = 0, type = 'ascii', count = 6 }\n"
                    "latitude = { register = 10, type = 'ascii', count = 6 }\n"));
  const auto state = [&](const char* longitude, const char* latitude) {
    device.set(0, in_letters(longitude, 6));
    device.set(10, in_letters(latitude, 6));
    return device.position().state;
  };
  EXPECT_EQ(state("8.5417E", "47.3769N"), Told::value);
  EXPECT_EQ(state("8.5417W", "47.3769S"), Told::value);
  EXPECT_EQ(state("8.5417", "-47.3769"), Told::value);
  EXPECT_EQ(state("47.3769N", "8.5417E"), Told::north_in_longitude);
  EXPECT_EQ(state("47.3769S", "8.5417E"), Told::south_in_longitude);
  EXPECT_EQ(state("8.5417E", "8.5417E"), Told::east_in_latitude);
  EXPECT_EQ(state("8.5417E", "W8.5417"), Told::west_in_latitude);
  EXPECT_EQ(state("8.5417E", "47.3x"), Told::malformed);
}

TEST(ProfilePosition, IsNoneWhereALetterBesideItIsOfTheOtherAxis) {
  using Told = DevicePosition::State;
  for (const char* const west : {"equals = 'W'", "equals = 0x57"}) {
    Device device(
        sound_profile(std::string("[[profile]]\nname = 'p'\n") +
                      "longitude = { register = 0, negative_if = { register = 1, " + west +
                      " } }\nlatitude = { register = 2, negative_if = { register = 3, mask = "
                      "0xFF00, equals = 'S' } }\n"));
    const auto state = [&](char of_longitude, char of_latitude) {
      device.set(0, {8, word(of_longitude), 47, word(of_latitude << 8)});
      return device.position().state;
    };
    EXPECT_EQ(state('E', 'N'), Told::value);
    EXPECT_EQ(state('W', 'S'), Told::value);
    EXPECT_LT(device.position().east_nano, 0);
    EXPECT_LT(device.position().north_nano, 0);
    EXPECT_EQ(state('N', 'N'), Told::north_in_longitude);
    EXPECT_EQ(state('E', 'E'), Told::east_in_latitude);
    EXPECT_EQ(state('\0', '\0'), Told::value) << "a device that has the letter of one side only";
    EXPECT_EQ(state(' ', ' '), Told::value) << "the same, blank";
  }
}

// "NE" in one register, and a mask that leaves both: whatever stands there was in the north east.
TEST(ProfilePosition, IsNoneWhereWhatIsToBeItsLetterIsNone) {
  using Told = DevicePosition::State;
  Device device(sound_profile(
      "[[profile]]\nname = 'p'\n"
      "longitude = { register = 0, negative_if = { register = 1, equals = ['W', 'w'] } }\n"
      "latitude = { register = 2, negative_if = { register = 3, not_equals = 'N' } }\n"));
  const auto state = [&](std::uint16_t of_longitude, std::uint16_t of_latitude) {
    device.set(0, {8, of_longitude, 47, of_latitude});
    return device.position().state;
  };
  EXPECT_EQ(state('E', 'N'), Told::value);
  EXPECT_EQ(state(0x4e45, 'N'), Told::no_letter_of_longitude);
  EXPECT_EQ(state(0x5720, 'N'), Told::no_letter_of_longitude) << "a letter and a blank";
  EXPECT_EQ(state(7, 'N'), Told::no_letter_of_longitude);
  EXPECT_EQ(state('e', 'N'), Told::value) << "a test that knows small letters";
  EXPECT_EQ(state('w', 'N'), Told::value);
  EXPECT_LT(device.position().east_nano, 0);
  EXPECT_EQ(state('n', 'N'), Told::north_in_longitude);
  EXPECT_EQ(state('E', 0x5300), Told::no_letter_of_latitude);
  EXPECT_EQ(state('E', 's'), Told::no_letter_of_latitude) << "a test that knows none";
  EXPECT_EQ(state('E', 'S'), Told::value);
  EXPECT_LT(device.position().north_nano, 0);
}

TEST(ProfilePosition, EachReasonHasACure) {
  for (auto state = DevicePosition::State::value; state <= DevicePosition::State::west_in_latitude;
       state = static_cast<DevicePosition::State>(static_cast<int>(state) + 1)) {
    EXPECT_NE(std::string(explain(state).what), "");
    EXPECT_NE(std::string(explain(state).cure), "");
  }
}

TEST(ProfileSerial, IsAWholeNumber) {
  const auto serial = [](const std::string& field, const std::vector<std::uint16_t>& registers) {
    Device device(sound_profile("[[profile]]\nname = 'p'\nserial = { " + field + " }\n"));
    device.set(0, registers);
    return device.serial();
  };
  EXPECT_EQ(serial("register = 0, type = 'u32'", {0xffff, 0xfffe}), 0xfffffffeu);
  EXPECT_EQ(serial("register = 0, type = 'u32'", {0xffff, 0xffff}), std::nullopt);
  EXPECT_EQ(serial("register = 0, type = 'u32'", {0, 0}), 0u);
  EXPECT_EQ(serial("register = 0, type = 'i16'", {0xffff}), std::nullopt);
  EXPECT_EQ(serial("register = 0, scale = '1/2'", {3}), std::nullopt);
  EXPECT_EQ(serial("register = 0, type = 'bcd32'", {0x1234, 0x5678}), 12345678u);
  EXPECT_EQ(on_earth("serial = { unit = true }").serial(), std::nullopt);
}

}  // namespace
}  // namespace etcm::firmware

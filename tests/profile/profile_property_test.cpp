// Whatever a device holds: what a test writes into registers by its own arithmetic, GMP's, is what
// the profile reads out of them.
#include <gmpxx.h>

#include <algorithm>
#include <cstring>
#include <random>

#include "device.h"
#include "support/big_integer.h"
#include "support/emulated.h"

namespace etcm::firmware {
namespace {

using Random = std::mt19937_64;

constexpr int rounds = 2000 / test::thinning_if_emulated;

// The bytes of a value, the highest first.
std::vector<std::uint8_t> bytes_of(std::uint64_t value, std::size_t count) {
  std::vector<std::uint8_t> bytes(count);
  for (std::size_t i = 0; i < count; ++i) {
    bytes[i] = static_cast<std::uint8_t>(value >> 8 * (count - 1 - i));
  }
  return bytes;
}

// Where the letter says that each byte goes.
std::vector<std::uint16_t> ordered(const std::vector<std::uint8_t>& bytes,
                                   const std::string& order) {
  std::vector<std::uint16_t> words;
  for (std::size_t i = 0; i < bytes.size(); i += 2) {
    const unsigned high = bytes[static_cast<std::size_t>(order[i] - 'A')];
    const unsigned low = bytes[static_cast<std::size_t>(order[i + 1] - 'A')];
    words.push_back(static_cast<std::uint16_t>(high << 8 | low));
  }
  return words;
}

std::string any_order(Random& random, std::size_t bytes) {
  const std::vector<std::string> two{"AB", "BA"};
  const std::vector<std::string> four{"ABCD", "BADC", "CDAB", "DCBA"};
  const std::vector<std::string> eight{"ABCDEFGH", "BADCFEHG", "CDABGHEF", "DCBAHGFE",
                                       "EFGHABCD", "FEHGBADC", "GHEFCDAB", "HGFEDCBA"};
  const auto& all = bytes == 2 ? two : bytes == 4 ? four : eight;
  return all[static_cast<std::size_t>(random() % all.size())];
}

// Mostly small ones, and those at the ends.
std::uint64_t any_bits(Random& random, unsigned bits) {
  const std::uint64_t all = ~std::uint64_t{0} >> (64 - bits);
  switch (random() % 4) {
    case 0:
      return (random() % 3 - 1) & all;
    case 1:
      return ((all >> 1) + random() % 3) & all;
    case 2:
      return random() & all;
    default:
      return (random() >> random() % 64) & all;
  }
}

struct Factor {
  std::int64_t above = 1;
  std::int64_t below = 1;
};

Factor any_factor(Random& random) {
  const auto part = [&] { return static_cast<std::int64_t>(random() >> (random() % 40 + 24)) + 1; };
  Factor factor{part(), part()};
  if (random() % 4 == 0) factor.above = -factor.above;
  return factor;
}

mpz_class magnitude(std::uint64_t value) {
  return (mpz_class(static_cast<unsigned long>(value >> 32)) << 32) +
         mpz_class(static_cast<unsigned long>(value & 0xffff'ffff));
}

// The nearest integer; halves go away from zero.
mpz_class rounded(const mpq_class& value) {
  const mpz_class twice = 2 * abs(value.get_num()) + value.get_den();
  mpz_class size;
  mpz_fdiv_q(size.get_mpz_t(), twice.get_mpz_t(), mpz_class(2 * value.get_den()).get_mpz_t());
  return value < 0 ? mpz_class(-size) : size;
}

TEST(ProfileProperty, IntegersComeOutAsTheyWentIn) {
  Random random(1);
  int values = 0;
  for (int round = 0; round < rounds; ++round) {
    const unsigned bits = 16u << random() % 3;
    const bool is_signed = random() % 2 == 0;
    const std::uint64_t raw = any_bits(random, bits);
    const std::string order = any_order(random, bits / 8);
    const Factor factor = any_factor(random);
    const auto offset = static_cast<std::int64_t>(random() % 2'000'001) - 1'000'000;
    const std::string field = std::string("register = 0, type = '") + (is_signed ? "i" : "u") +
                              std::to_string(bits) + "', order = '" + order + "', scale = '" +
                              std::to_string(factor.above) + "/" + std::to_string(factor.below) +
                              "', offset = " + std::to_string(offset);
    mpz_class number = magnitude(raw);
    if (is_signed && raw >> (bits - 1) != 0) number -= mpz_class(1) << bits;
    mpq_class exact(number * test::integer(factor.above), test::integer(factor.below));
    exact.canonicalize();
    const mpz_class nano =
        rounded(exact * 1'000'000'000) + mpz_class(1'000'000'000) * test::integer(offset);
    const FieldValue found = decoded(field, ordered(bytes_of(raw, bits / 8), order));
    if (found.is_value()) {
      ++values;
      EXPECT_EQ(test::integer(found.nano), nano) << field << " of " << raw;
    } else {
      // Only what is too large, be it without the offset; an unsigned one of 64 bits may be too.
      EXPECT_EQ(found.state, FieldValue::State::out_of_range);
      const mpz_class limit = (mpz_class(1) << 63) - mpz_class("1000001000000000");
      const bool is_beyond = abs(nano) > limit || number >= mpz_class(1) << 63;
      // Nor need a factor fit that is finer than 10^-9 of the largest.
      const bool is_long = abs(test::integer(factor.above)) > 1'000'000'000;
      EXPECT_TRUE(is_beyond || is_long) << field << " of " << raw;
    }
  }
  EXPECT_GT(values, rounds / 4);
}

TEST(ProfileProperty, RealsComeOutAsTheyWentIn) {
  Random random(2);
  std::uniform_real_distribution<double> degrees(-180, 180);
  for (int round = 0; round < rounds / 4; ++round) {
    const double value = degrees(random);
    const bool is_long = random() % 2 == 0;
    std::uint64_t raw = 0;
    double held = value;
    if (is_long) {
      std::memcpy(&raw, &value, sizeof value);
    } else {
      const auto narrow = static_cast<float>(value);
      std::uint32_t bits = 0;
      std::memcpy(&bits, &narrow, sizeof narrow);
      raw = bits;
      held = static_cast<double>(narrow);
    }
    const std::size_t bytes = is_long ? 8 : 4;
    const std::string order = any_order(random, bytes);
    const FieldValue found = decoded(std::string("register = 0, type = '") +
                                         (is_long ? "f64" : "f32") + "', order = '" + order + "'",
                                     ordered(bytes_of(raw, bytes), order));
    const mpz_class nano = rounded(mpq_class(held) * 1'000'000'000);
    EXPECT_TRUE(found.is_value());
    if (is_long) {
      EXPECT_LE(abs(test::integer(found.nano) - nano), 1) << value;
    } else {
      // The decimal is a shorter one, and the same real but for what is below 10^-9.
      EXPECT_LE(std::abs(static_cast<double>(static_cast<float>(found.to_double())) - held), 1e-9)
          << value;
    }
  }
}

TEST(ProfileProperty, AnglesComeOutAsTheyWentIn) {
  Random random(3);
  for (int round = 0; round < rounds / 4; ++round) {
    // Of tenths of thousandths of a minute.
    const auto units = static_cast<std::int64_t>(random() % (180 * 600'000));
    const bool is_west = random() % 2 == 0;
    const std::int64_t degrees = units / 600'000;
    const std::int64_t minutes = units % 600'000;
    const std::int64_t nano =
        (is_west ? -1 : 1) * ((units * 10'000 + 3) / 6);  // exact to the nearest
    const auto ddmm = static_cast<std::uint32_t>(degrees * 1'000'000 + minutes);
    const std::vector<std::uint16_t> words{
        static_cast<std::uint16_t>(ddmm >> 16), static_cast<std::uint16_t>(ddmm),
        static_cast<std::uint16_t>(degrees),    static_cast<std::uint16_t>(minutes >> 16),
        static_cast<std::uint16_t>(minutes),    static_cast<std::uint16_t>(is_west ? 'W' : 'E')};
    const std::string sign = ", negative_if = { register = 5, equals = 'W' }";
    EXPECT_NEAR(
        static_cast<double>(decoded("register = 0, type = 'u32', scale = '1/10000', format = "
                                    "'ddmm.mmmm'" +
                                        sign,
                                    words)
                                .nano -
                            nano),
        0, 1);
    EXPECT_NEAR(
        static_cast<double>(decoded("parts = [{ register = 2 }, { register = 3, type = 'u32', "
                                    "scale = '1/600000' }]" +
                                        sign,
                                    words)
                                .nano -
                            nano),
        0, 1);
  }
}

// No registers make any profile do what it must not; sanitizers look on.
TEST(ProfileProperty, AnyRegistersAreReadInSomeWay) {
  Random random(4);
  std::vector<std::string> mistakes;
  std::vector<Profile> profiles = read_profiles(ETCM_PROFILES, mistakes);
  profiles.push_back(sound_profile(
      "[[profile]]\nname = 'all'\n"
      "longitude = { parts = [{ register = 0, type = 'i64' }, { register = 4, type = 'f64' }, "
      "{ register = 8, type = 'bcd32', scale = '-1e18' }], sign_of_first = true, format = "
      "'ddmmss.ss', "
      "exponent = { register = 10, type = 'i16', mask = 0x801F } }\n"
      "latitude = { register = 11, type = 'ascii', count = 4, format = 'ddmm.mmmm', negative_if = "
      "{ "
      "register = 15, type = 'f32', at_least = 0 } }\n"));
  for (const Profile& profile : profiles) {
    Device device(profile);
    for (int round = 0; round < rounds / 8; ++round) {
      for (const RegisterSpan block : device.blocks()) {
        for (unsigned at = block.first; at < block.end(); ++at) {
          const std::uint64_t bits = random();
          const auto any = static_cast<std::uint16_t>(bits >> 8);
          const std::uint16_t ends[] = {any, 0, 0xffff, 0x8000, 0x7fff, 0x3130};
          device.set(static_cast<std::uint16_t>(at), {ends[bits % std::size(ends)]});
        }
      }
      const DevicePosition position = device.position();
      if (position.is_value() && profile.positioning == Profile::Positioning::degrees) {
        EXPECT_LE(std::abs(position.east_nano), 180 * nano_per_one);
        EXPECT_LE(std::abs(position.north_nano), 90 * nano_per_one);
      }
      for (std::size_t i = 0; i < profile.readings.size(); ++i) {
        static_cast<void>(device.reading(i));
      }
      static_cast<void>(device.serial());
    }
  }
}

}  // namespace
}  // namespace etcm::firmware

// What is said of a profile with mistakes: file, line, what, and the cure; all of them at once.
#include <gmock/gmock.h>

#include <fstream>
#include <random>
#include <sstream>

#include "device.h"

namespace etcm::firmware {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::Not;
using testing::SizeIs;

std::vector<std::string> mistakes(const std::string& toml) {
  return read_profile_text(toml).mistakes;
}

// Of a profile with these keys behind its name, which is line 2.
std::vector<std::string> mistakes_in(const std::string& keys) {
  return mistakes("[[profile]]\nname = 'p'\n" + keys + "\n");
}

struct Mistake {
  const char* keys;
  const char* message;  // a part of it
};

void expect_each(const std::vector<Mistake>& cases) {
  for (const Mistake& each : cases) {
    EXPECT_THAT(mistakes_in(each.keys), ElementsAre(HasSubstr(each.message))) << each.keys;
  }
}

// In line 3, within something that can be read.
void expect_field(const std::vector<Mistake>& cases) {
  for (const Mistake& each : cases) {
    const std::string keys = "serial = { " + std::string(each.keys) + " }";
    const auto found = mistakes_in(keys);
    EXPECT_THAT(found, ElementsAre(HasSubstr(each.message))) << keys;
    EXPECT_THAT(found, testing::Each(testing::StartsWith("p.toml:3: "))) << keys;
  }
}

TEST(ProfileMistakes, OfAProfile) {
  EXPECT_THAT(mistakes("[[profile]]\nserial = { register = 0 }\n"),
              ElementsAre("p.toml:1: 'name' is missing in [[profile]]; add it, such as "
                          "name = \"my-device\""));
  expect_each({
      {"", "nothing is read"},
      {"serial = { register = 0 }\nfunction = [3, 4]",
       "'function' is a list, and a profile reads one table; give 3 or 4"},
      {"serial = { register = 0 }\nfunction = '3'",
       "'function' is a text; write the number without quotes: function = 3"},
      {"serial = { unit = true }", "nothing is read"},
      {"x = { register = 0 }", "p.toml:3: 'x' without 'y'; a position needs both"},
      {"longitude = { register = 0 }", "'longitude' without 'latitude'"},
      {"latitude = { register = 0 }", "'latitude' without 'longitude'"},
      {"x = { register = 0 }\ny = { register = 0 }\nlongitude = { register = 0 }\n"
       "latitude = { register = 0 }",
       "p.toml:5: a position in degrees beside one in the plane"},
      {"serial = { register = 0 }\nvalid = { register = 0, equals = 1 }",
       "p.toml:4: 'valid' is about the position, and there is none; take it out"},
      {"serial = { register = 0 }\nspeed_max = 3",
       "p.toml:4: 'speed_max' is about the position, and there is none; take it out"},
      {"x = { register = 0 }\ny = { register = 1 }\nspeed_max = 0",
       "p.toml:5: 'speed_max' must be a decimal above 0, in quotes; write it as speed_max = "},
      {"x = { register = 0 }\ny = { register = 1 }\nspeed_max = 'fast'", "'speed_max' must be"},
      {"x = { register = 0 }\ny = { register = 1 }\nspeed_max = 2.5", "'speed_max' must be"},
      {"serial = { register = 0 }\nfunction = 6",
       "p.toml:4: 'function' is out of range; give a whole number from 3 to 4"},
      {"serial = { register = 0 }\npause = 20", "'pause' is no duration; write it as \"500ms\""},
      {"serial = { register = 0 }\npause = '2d'", "'pause' is no duration"},
      {"serial = { register = 0 }\nblock_max = 126", "from 1 to 125"},
      {"serial = { register = 0 }\nblock_max = 0", "from 1 to 125"},
      {"serial = { register = 0 }\ngap_max = -1", "from 0 to 125"},
      {"serial = { register = 0, type = 'f64' }\nblock_max = 3",
       "p.toml:4: 'block_max' has no room for a number of 4 registers, which must come in one "
       "block; give at least 4"},
      {"serial = { register = 0 }\ncounts_from = 2", "give 0, 1, 30001, 40001, 300001 or 400001"},
      {"serial = { register = 30001 }\ncounts_from = 30001",
       "p.toml:4: 'counts_from' is of input registers, which function 4 reads, and 'function' is "
       "3; "
       "write function = 4, or number the registers from 1, with counts_from = 1"},
      {"serial = { register = 400001 }\ncounts_from = 400001\nfunction = 4",
       "p.toml:4: 'counts_from' is of holding registers, which function 3 reads"},
      {"serial = { register = 0 }\nlongitud = 1",
       "p.toml:4: 'longitud' is unknown in [[profile]]; did you mean 'longitude'? known here: "},
      {"serial = 7", "'serial' must be a table; write it as serial = { register = 200 }"},
      {"serial = { unit = false }\nx = { register = 0 }\ny = { register = 0 }",
       "'unit' can only be true"},
      {"serial = { unit = true, register = 0 }\nx = { register = 0 }\ny = { register = 0 }",
       "'register' is unknown in 'serial' of [[profile]]"},
      {"name = 'q'", "p.toml:3: "},
  });
  EXPECT_THAT(mistakes("[[profile]]\nname = \"a\\u001b[2J\"\nserial = { register = 0 }\n"),
              ElementsAre("p.toml:2: 'name' must be a text in one line; write it in quotes"));
  EXPECT_THAT(mistakes("[[profile]]\nname = ''\nserial = { register = 0 }\n"),
              ElementsAre("p.toml:2: 'name' must be a text in one line; write it in quotes"));
}

// Ten equal lines hide the one that is to be changed.
TEST(ProfileMistakes, OfWhereItsRegistersAreCountedFromAreToldOnce) {
  const std::string fields =
      "latitude = { register = 143, type = 'f32' }\nlongitude = { register = 145, type = 'f32' }\n"
      "valid = { register = 147, equals = 1 }";
  EXPECT_THAT(
      mistakes_in("counts_from = 40001\n" + fields),
      ElementsAre("p.toml:3: 'counts_from' is what the manual calls the first register, and "
                  "none of its 3 registers, such as 145, is among those from 40001 to "
                  "105536; give what the manual calls it, or take it out where the "
                  "registers are as on the wire"));
  EXPECT_THAT(mistakes_in("counts_from = 40000\n" + fields),
              ElementsAre(HasSubstr("give 0, 1, 30001, 40001, 300001 or 400001")));
  EXPECT_THAT(
      mistakes_in("x = { register = 400101 }\ny = { register = 400102 }"),
      ElementsAre("p.toml:3: none of its 2 registers, such as 400101, is among those from 0 "
                  "to 65535; add counts_from = 30001, 40001, 300001 or 400001, what the "
                  "manual calls the first register"));
  EXPECT_THAT(mistakes_in("counts_from = 40001\n" + fields +
                          "\n[[profile.reading]]\nname = 'a'\n"
                          "value = { register = 40050 }"),
              SizeIs(3))
      << "one is right, so the others are wrong each for itself";
}

TEST(ProfileMistakes, OfALetterOfTheOtherAxis) {
  const auto found = mistakes_in(
      "longitude = { register = 0, negative_if = { register = 1, equals = 'S' } }\n"
      "latitude = { register = 2, negative_if = { register = 3, equals = 0x57 } }");
  EXPECT_THAT(
      found,
      ElementsAre(HasSubstr("p.toml:3: 'longitude' is negative by the letter S, and has E "
                            "and W; write negative_if = { register = 1, equals = \"W\" }, "),
                  HasSubstr("p.toml:4: 'latitude' is negative by the letter W, and has N "
                            "and S; write negative_if = { register = 3, equals = \"S\" }, ")));
}

TEST(ProfileMistakes, OfAField) {
  expect_field({
      {"type = 'u16'",
       "'register' is missing in 'serial' of [[profile]]; add it, such as register"},
      {"register = 65536", "for a number of 1 register; give a whole number from 0 to 65535"},
      {"register = 65535, type = 'f32'", "of 2 registers; give a whole number from 0 to 65534"},
      {"register = 65533, type = 'f64'", "of 4 registers; give a whole number from 0 to 65532"},
      {"register = 65535, type = 'ascii', count = 2", "from 0 to 65534"},
      {"register = -1", "'register' is out of range"},
      {"register = '7'", "'register' is a text; write the number without quotes: register = 7"},
      {"register = 'a'", "write the number without quotes: register = 0"},
      {"register = [1, 2]", "'register' is a list; give one number"},
      {"register = 0, type = 'u8'", "'type' is unknown; write one of \"i16\", \"u16\""},
      {"register = 0, type = 16", "'type' is unknown"},
      {"register = 0, order = 'abcd'", "'order' is unknown; write one of \"ABCD\""},
      {"register = 0, type = 'u32', order = 'AB'", "'order' has fewer letters than"},
      {"register = 0, type = 'f32', order = 'GHEFCDAB'", "more letters than the type has bytes"},
      {"register = 0, format = 'dms'", "\"radians\", \"ddmm.mmmm\", \"ddmmss.ss\""},
      {"register = 0, mask = 0x10000", "'mask' has no bit, or more than its type"},
      {"register = 0, mask = 0", "'mask' has no bit"},
      {"register = 0, mask = 'FF'", "'mask' has no bit"},
      {"register = 0, type = 'f32', mask = 1", "'mask' has no meaning for f32, f64 and ascii"},
      {"register = 0, scale = 0.1",
       "'scale' is no factor; write it as 10, \"0.001\" or \"1/60000\""},
      {"register = 0, scale = 0", "'scale' is no factor"},
      {"register = 0, scale = '1/0'", "'scale' is no factor"},
      {"register = 0, scale = true", "'scale' is no factor"},
      {"register = 0, offset = 'x'", "'offset' is no number"},
      {"register = 0, offset = '1e10'", "'offset' is no number"},
      {"register = 0, type = 'u64', scale = '1/999999999999999999', format = 'radians'",
       "too many digits for radians"},
      {"register = 0, none = 65536", "'none' has a value that its type, or the mask, cannot have"},
      {"register = 0, type = 'i16', none = -32769", "'none' has a value"},
      {"register = 0, mask = 0x0FFF, none = 0x8000", "'none' has a value"},
      {"register = 0, type = 'i32', none = [1, 4294967296]", "'none' has a value"},
      {"register = 0, type = 'u32', none = '0x100000000'", "'none' has a value"},
      {"register = 0, none = 'NaN'", "'none' has a value"},
      {"register = 0, none = 1.5", "'none' has a value"},
      {"register = 0, type = 'ascii', count = 2, none = 7", "'none' has a value"},
      {"register = 0, type = 'ascii'", "'count' is missing"},
      {"register = 0, type = 'ascii', count = 17", "'count' is out of range"},
      {"register = 0, count = 2", "'count' is for ascii alone"},
      {"register = 0, range = [5, 4]", "'range' has its most before its least; exchange them"},
      {"register = 0, range = [5]", "'range' must be the least and the most"},
      {"register = 0, range = 5", "'range' must be the least and the most"},
      {"register = 0, range = [0.5, 1]",
       "'range' has a number with a point, which stands in quotes"},
      {"parts = []", "'parts' must be a list"},
      {"parts = { register = 0 }", "'parts' must be a list"},
      {"parts = [7]", "'parts' must be a table"},
      {"parts = [{ register = 0 }], scale = 2", "'scale' beside 'parts'; give it to each part"},
      {"parts = [{ register = 0, format = 'radians' }]", "'format' is unknown in 'parts' of"},
      {"register = 0, sign_of_first = true", "'sign_of_first' is true or false, and about several"},
      {"register = 0, exponent = 3", "'exponent' must be a table"},
      {"register = 0, exponent = { register = 70000 }", "'register' is out of range"},
      {"register = 0, negative_if = { register = 1 }", "a test needs one of 'equals'"},
      {"register = 0, negative_if = { register = 1, equals = 1, at_most = 2 }", "a test needs one"},
      {"register = 0, negative_if = { register = 1, equals = [] }", "'equals' is an empty list"},
      {"register = 0, negative_if = { register = 1, equals = 'AB' }", "no number and no letter"},
      {"register = 0, negative_if = { register = 1, type = 'ascii', count = 1, equals = 'A' }",
       "'equals' compares an ascii number with a text; give a number, or look at the letter"},
      {"register = 0, negative_if = { register = 1, mask = 0xFF00, equals = '1' }",
       "'equals' = \"1\" is the number, not the digit, and the bits of this test never have it; "
       "give the code of the digit, where the bits of the mask stand: 0x31 in a low byte"},
      {"register = 0, negative_if = { register = 1, equals = 70000 }",
       "registers of this test never"},
      {"register = 0, negative_if = { register = 1, equals = -1 }", "registers of this test never"},
      {"register = 0, negative_if = { register = 1, equals = '0.5' }",
       "registers of this test never"},
      {"register = 0, negative_if = { register = 1, mask = 0xFF00, equals = 0x41 }",
       "registers of this test never have (see 'type' and 'mask'); correct it"},
      {"register = 0, negative_if = { register = 1, at_least = 3, at_most = 2 }", "exchange them"},
      {"register = 0, negative_if = { register = 1, at_least = 'x' }", "'at_least' is no number"},
      {"register = 0, registr = 1", "did you mean 'register'?"},
  });
}

TEST(ProfileMistakes, OfAReading) {
  expect_each({
      {"[[profile.reading]]\nvalue = { register = 0 }",
       "p.toml:3: 'name' is missing in [[profile.reading]]; add it, such as name = \"pressure\""},
      {"serial = { register = 0 }\n[[profile.reading]]\nname = 'a'",
       "p.toml:4: 'value' is missing"},
      {"[[profile.reading]]\nname = 'a'\nvalue = { register = 0 }\nunit = 5",
       "p.toml:6: 'unit' must be a text"},
      {"[[profile.reading]]\nname = 'a'\nvalue = { register = 0 }\n[[profile.reading]]\n"
       "name = 'a'\nvalue = { register = 1 }",
       "p.toml:7: two readings are named 'a'; give one another name"},
      {"[[profile.reading]]\nname = '0123456789012345678901234567890123456789012345678'\n"
       "value = { register = 0 }",
       "p.toml:4: 'name' has 49 bytes; make it shorter, it can have 48"},
      {"[[profile.reading]]\nname = 'a'\nunit = 'ééééééééééééé'\nvalue = { register = 0 }",
       "p.toml:5: 'unit' has 26 bytes; make it shorter, it can have 24"},
      {"serial = { register = 0 }\nreading = 5", "begin each with [[profile.reading]]"},
  });
}

TEST(ProfileMistakes, AreAllToldAtOnce) {
  EXPECT_THAT(mistakes("[[profile]]\n"
                       "function = 5\n"
                       "longitude = { register = 70000, type = 'u16', scale = 0 }\n"
                       "unknown = 1\n"
                       "[[profile.reading]]\n"
                       "value = { register = 0, range = 1 }\n"
                       "[[profil]]\n"),
              SizeIs(9));
}

TEST(ProfileMistakes, OfAFile) {
  EXPECT_THAT(mistakes("[[profile]\n"), ElementsAre(testing::StartsWith("p.toml:1: ")));
  EXPECT_THAT(mistakes("profile = 3\n"), ElementsAre(HasSubstr("begin each with [[profile]]")));
  EXPECT_THAT(mistakes("[mesh]\n"), ElementsAre(HasSubstr("'mesh' is unknown")));
  EXPECT_THAT(mistakes(""), IsEmpty());
  std::vector<std::string> found;
  EXPECT_THAT(read_profiles("/no/such/file.toml", found), IsEmpty());
  EXPECT_THAT(found, ElementsAre(testing::AllOf(HasSubstr("/no/such/file.toml"),
                                                HasSubstr("check the path"))));
}

TEST(ProfileMistakes, OfOneNameTwice) {
  const std::string profile = "[[profile]]\nname = 'p'\nserial = { register = 0 }\n";
  EXPECT_THAT(mistakes(profile + profile),
              ElementsAre("p.toml:5: two profiles are named 'p'; give one another name"));
  const test::ScratchFolder folder;
  folder.write("b.toml", profile);
  folder.write("a.toml", profile);
  folder.write("c.txt", profile);
  std::vector<std::string> found;
  EXPECT_THAT(read_profiles(folder.path(""), found), SizeIs(2));
  EXPECT_THAT(found, ElementsAre(HasSubstr("b.toml:2: two profiles are named 'p'")));
}

// Whatever stands in a file, reading ends, and each mistake is one line.
TEST(ProfileMistakes, OfHostileFiles) {
  std::ifstream file(ETCM_PROFILES "/ebyte-e108.toml");
  const std::string sound(std::istreambuf_iterator<char>(file), {});
  std::mt19937 random(20261122);
  constexpr char letters[] = "[]{}=\"'\n,.#0123456789-x\0\xff\x1b";
  for (int round = 0; round < 300; ++round) {
    std::string text = sound;
    for (unsigned i = 0; i <= random() % 4; ++i) {
      const std::size_t at = random() % text.size();
      switch (random() % 3) {
        case 0:
          text[at] = letters[random() % (sizeof letters - 1)];
          break;
        case 1:
          text.erase(at, random() % 20);
          break;
        default:
          text.insert(at, text.substr(random() % text.size(), random() % 40));
      }
      if (text.empty()) text = "x";
    }
    const ReadProfiles read = read_profile_text(text);
    for (const std::string& mistake : read.mistakes) {
      EXPECT_THAT(mistake, testing::StartsWith("p.toml:"));
    }
    if (!read.mistakes.empty()) continue;
    for (const Profile& profile : read.profiles) {
      Device device(profile);
      static_cast<void>(device.position());
    }
  }
  EXPECT_THAT(mistakes("x = " + std::string(100'000, '[')), SizeIs(1));
  EXPECT_THAT(mistakes(std::string(2'000'000, '#')), SizeIs(1));
}

TEST(ProfileMistakes, EachIsOneLine) {
  EXPECT_THAT(mistakes("x = t\n]"), ElementsAre(Not(HasSubstr("\n"))));
  EXPECT_THAT(mistakes_in("\"a\\nb\" = 1"), testing::Each(Not(HasSubstr("\n"))));
}

TEST(ProfileFiles, AreSound) {
  std::vector<std::string> found;
  EXPECT_THAT(read_profiles(ETCM_PROFILES, found), SizeIs(testing::Ge(5u)));
  EXPECT_THAT(found, IsEmpty());
}

}  // namespace
}  // namespace etcm::firmware

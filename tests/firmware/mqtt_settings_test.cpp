// [mqtt]: what is good, what is said about what is not, and the files that it names.
#include <gtest/gtest.h>

#include <filesystem>

#include "firmware/config/configuration.h"
#include "firmware/config/secret_file.h"
#include "firmware/config/settings.h"
#include "support/scratch_folder.h"

namespace etcm::firmware {
namespace {

using namespace std::chrono_literals;
namespace fs = std::filesystem;

class MqttSettingsFile : public testing::Test {
 protected:
  // [mqtt] stands in line 5, behind a mesh and a bus.
  Settings read(const std::string& mqtt, const std::string& bus =
                                             "[[bus]]\nrtu = \"/dev/ttyS0\"\n"
                                             "units = \"1\"\n") {
    mistakes_.clear();
    return read_configuration(
        folder_.write("site.toml", "[mesh]\nvertices_max = 10\n" + bus + "[mqtt]\n" + mqtt),
        nullptr, mistakes_);
  }
  Settings read_good(const std::string& mqtt) {
    Settings settings = read(least + mqtt);
    EXPECT_TRUE(mistakes_.empty()) << testing::PrintToString(mistakes_);
    return settings;
  }
  std::string write_secret(const std::string& name, const std::string& text) const {
    const std::string path = folder_.write(name, text);
    fs::permissions(path, fs::perms::owner_read);
    return path;
  }
  void expect_mistake(int line, const std::string& what, const std::string& cure) const {
    ASSERT_EQ(mistakes_.size(), 1u) << testing::PrintToString(mistakes_);
    const std::string begin = folder_.path("site.toml") + ":" + std::to_string(line) + ": ";
    EXPECT_EQ(mistakes_[0].substr(0, begin.size()), begin) << mistakes_[0];
    EXPECT_NE(mistakes_[0].find(what), std::string::npos) << mistakes_[0];
    EXPECT_NE(mistakes_[0].find("; " + cure), std::string::npos) << mistakes_[0];
  }

  const std::string least = "broker = \"mqtt.example\"\nsite = \"yard\"\nname = \"north\"\n";
  test::ScratchFolder folder_;
  std::vector<std::string> mistakes_;
};

TEST_F(MqttSettingsFile, TheLeastThatWorks) {
  const MqttSettings mqtt = *read_good("").mqtt;
  EXPECT_EQ(to_string(mqtt.broker), "mqtt.example:1883");
  EXPECT_EQ(mqtt.site, "yard");
  EXPECT_EQ(mqtt.name, "north");
  EXPECT_EQ(mqtt.share, FleetShare::publish);
  EXPECT_EQ(mqtt.user, "");
  EXPECT_EQ(mqtt.keep_alive, 30s);
  EXPECT_FALSE(read("", "").mqtt && mistakes_.empty());
}

TEST_F(MqttSettingsFile, AMeshOfItsOwnIsMeantWhereItIsWritten) {
  EXPECT_FALSE(read_good("").mqtt->is_alone);
  EXPECT_FALSE(read_good("share = \"site\"\n").mqtt->is_alone);
  EXPECT_TRUE(read_good("share = \"publish\"\n").mqtt->is_alone);
}

TEST_F(MqttSettingsFile, EverythingArrives) {
  write_secret("secret", "open sesame\n");
  write_secret("key", "-");
  folder_.write("ca.pem", "-");
  folder_.write("me.pem", "-");
  const MqttSettings mqtt = *read_good(R"(share = "site"
user = "someone"
password_file = "secret"
tls_ca = "ca.pem"
tls_certificate = "me.pem"
tls_key = "key"
keep_alive = "1min"
period_min = "1s"
period_max = "1min"
)")
                                 .mqtt;
  EXPECT_EQ(to_string(mqtt.broker), "mqtt.example:8883") << "TLS has a port of its own";
  EXPECT_EQ(mqtt.share, FleetShare::site);
  EXPECT_EQ(mqtt.user, "someone");
  EXPECT_EQ(mqtt.password_file, folder_.path("secret"));
  EXPECT_EQ(mqtt.tls_ca, folder_.path("ca.pem"));
  EXPECT_EQ(mqtt.tls_certificate, folder_.path("me.pem"));
  EXPECT_EQ(mqtt.tls_key, folder_.path("key"));
  EXPECT_EQ(mqtt.keep_alive, 1min);
  EXPECT_EQ(mqtt.period_min, 1s);
  EXPECT_EQ(mqtt.period_max, 1min);
}

TEST_F(MqttSettingsFile, APasswordAloneIsThatOfTheName) {
  write_secret("secret", "x");
  EXPECT_EQ(read_good("password_file = \"secret\"\n").mqtt->user, "north");
}

TEST_F(MqttSettingsFile, APortThatIsGivenStays) {
  write_secret("key", std::string(32, 'a'));
  const std::string psk = "psk_identity = \"north\"\npsk_file = \"key\"\n";
  const std::string rest = "site = \"yard\"\nname = \"north\"\n" + psk;
  for (const char* end : {"192.0.2.5:1883", "[2001:db8::1]:7", "mqtt.example:443"}) {
    const Settings settings = read("broker = \"" + std::string(end) + "\"\n" + rest);
    ASSERT_TRUE(mistakes_.empty()) << testing::PrintToString(mistakes_);
    EXPECT_EQ(to_string(settings.mqtt->broker), end);
  }
  EXPECT_EQ(to_string(read("broker = \"2001:db8::1\"\n" + rest).mqtt->broker),
            "[2001:db8::1]:8883");
}

// The office: it has the nodes of the others, and none of its own.
TEST_F(MqttSettingsFile, WhoHasTheNodesOfOthersNeedsNoBus) {
  const Settings office = read(least + "share = \"site\"\n", "");
  EXPECT_TRUE(mistakes_.empty()) << testing::PrintToString(mistakes_);
  EXPECT_TRUE(office.buses.empty());
  EXPECT_TRUE(office.warnings.empty()) << testing::PrintToString(office.warnings);
  EXPECT_GT(office.room.units, 0u) << "a reload may add a bus";
  const Settings alone = read(least, "");
  EXPECT_TRUE(mistakes_.empty());
  EXPECT_EQ(alone.warnings.size(), 1u) << "nobody is asked";
}

TEST_F(MqttSettingsFile, AFileThatEverybodyMayReadIsWarnedOf) {
  fs::permissions(folder_.write("secret", "x"), fs::perms::owner_read | fs::perms::others_read);
  const Settings settings = read_good("password_file = \"secret\"\n");
  ASSERT_EQ(settings.warnings.size(), 1u);
  EXPECT_NE(settings.warnings[0].find(":10: everybody on this machine may read "),
            std::string::npos)
      << settings.warnings[0];
  EXPECT_NE(settings.warnings[0].find("; take that away: chmod o= "), std::string::npos);
}

// Two gateways with a converter each would call their devices by the same serial.
TEST_F(MqttSettingsFile, AMadeUpSerialInAFleetIsWarnedOf) {
  const std::string bus =
      "[[profile]]\nname = \"p\"\nx = { register = 1 }\ny = { register = 2 }\n[[bus]]\nrtu = "
      "\"/dev/ttyS0\"\nunits = \"1\"\n[[bus.device]]\nunits = \"7\"\nprofile = \"p\"\n";
  const Settings settings = read(least, bus);
  ASSERT_EQ(settings.warnings.size(), 1u) << testing::PrintToString(mistakes_);
  EXPECT_NE(settings.warnings[0].find("unit 7 of /dev/ttyS0 tells no serial"), std::string::npos)
      << settings.warnings[0];
  EXPECT_TRUE(read(least, bus + "[[node]]\nunit = 7\nserial = 70\n").warnings.empty());
}

TEST_F(MqttSettingsFile, SecretsAreInTheFirstLine) {
  std::string why;
  EXPECT_EQ(read_secret(folder_.write("a", "one two\r\nthree"), why), "one two");
  EXPECT_EQ(read_key(folder_.write("b", std::string(64, 'F') + "\n"), why), std::string(64, 'F'));
  EXPECT_EQ(why, "");
}

struct Row {
  const char* name;
  std::string lines;  // behind the three that must be there, so from line 9 on
  int line;
  const char* what;
  const char* cure;
};

class MqttMistake : public MqttSettingsFile, public testing::WithParamInterface<Row> {};

TEST_P(MqttMistake, IsNamedWithItsLineAndCure) {
  write_secret("empty", "\nsecond line");
  write_secret("short", "0123456789abcdef");
  write_secret("good", std::string(32, 'a'));
  fs::create_directory(folder_.path("folder"));
  read(least + GetParam().lines);
  expect_mistake(GetParam().line, GetParam().what, GetParam().cure);
}

INSTANTIATE_TEST_SUITE_P(
    Rows, MqttMistake,
    testing::Values(
        Row{"no_file", "password_file = \"none\"\n", 10, "there is no ", "make it, or correct"},
        Row{"a_folder", "password_file = \"folder\"\n", 10, " cannot be read", "give a file"},
        Row{"empty_password", "password_file = \"empty\"\n", 10, " has nothing in its first line",
            "write the secret there"},
        Row{"short_key", "psk_identity = \"a\"\npsk_file = \"short\"\n", 11,
            " has no key of 16 to 64 bytes", "`openssl rand -hex 32`"},
        Row{"no_ca", "tls_ca = \"none\"\n", 10, "there is no ", "make it"},
        Row{"key_without_identity", "psk_file = \"good\"\n", 10,
            "'psk_identity' and 'psk_file' go together", "add 'psk_identity'"},
        Row{"certificate_without_key", "tls_ca = \"good\"\ntls_certificate = \"good\"\n", 11,
            "'tls_certificate' and 'tls_key' go together", "add 'tls_key'"},
        Row{"certificate_without_ca", "tls_certificate = \"good\"\ntls_key = \"good\"\n", 10,
            "needs tls_ca too", "add it"},
        Row{"both_kinds", "tls_ca = \"good\"\npsk_identity = \"a\"\npsk_file = \"good\"\n", 12,
            "both by certificates and by a key", "take tls_ca or"},
        Row{"periods", "period_min = \"1min\"\nperiod_max = \"30s\"\n", 11,
            "period_min is longer than period_max", "make it shorter"},
        Row{"short_keep_alive", "keep_alive = \"4s\"\n", 10, "'keep_alive' is too short",
            "give at least \"5s\""},
        Row{"share", "share = \"all\"\n", 10, "share 'all' is unknown", "write one of"}),
    [](const auto& test) { return std::string(test.param.name); });

TEST_F(MqttSettingsFile, NamesAreLevelsOfATopic) {
  const std::string wrong[] = {"", "a/b", "a b", "+", "#", "\u00e4", std::string(300, 'x')};
  for (const std::string& name : wrong) {
    read("broker = \"a\"\nsite = \"" + name + "\"\nname = \"north\"\n");
    expect_mistake(8, "'site' must be a name of 1 to ", "write it as site = \"harbour\"");
  }
}

// By the access list it could write the site of all.
TEST_F(MqttSettingsFile, NoGatewayIsCalledSite) {
  const std::string begin = "broker = \"a\"\nsite = \"site\"\nname = ";
  read(begin + "\"site\"\n");
  expect_mistake(9, "'name' may not be \"site\"", "give it another name");
  read(begin + "\"north\"\nuser = \"site\"\n");
  expect_mistake(10, "'user' may not be \"site\"", "give it another name");
  read(begin + "\"sites\"\n");
  EXPECT_TRUE(mistakes_.empty()) << testing::PrintToString(mistakes_);
}

TEST_F(MqttSettingsFile, SparkplugAndHomeAssistantArePartsOfTopics) {
  const Settings settings =
      read_good("sparkplug = \"Plant 1 \u00e4\"\nhome_assistant = \"ha/found\"\n");
  EXPECT_EQ(settings.mqtt->sparkplug, "Plant 1 \u00e4");
  EXPECT_EQ(settings.mqtt->home_assistant, "ha/found");
  EXPECT_EQ(read_good("").mqtt->sparkplug, "");
  const std::string no_group[] = {"a/b", "a+", "#", "a\\tb", std::string(65, 'x')};
  for (const std::string& wrong : no_group) {
    read(least + "sparkplug = \"" + wrong + "\"\n");
    expect_mistake(10, "'sparkplug' is no part of a topic", "give it 1 to 64 bytes without '/'");
  }
  for (const std::string wrong : {"/a", "a/", "a//b", "a/+"}) {
    read(least + "home_assistant = \"" + wrong + "\"\n");
    expect_mistake(10, "'home_assistant' is no part of a topic", "give it 1 to 64 bytes");
  }
}

TEST_F(MqttSettingsFile, TheBrokerIsSomebodyElse) {
  const std::string rest = "site = \"yard\"\nname = \"north\"\n";
  read("broker = \"127.0.0.1:1502\"\n" + rest);
  expect_mistake(7, "127.0.0.1:1502 is where this gateway itself serves the mesh",
                 "give the address of the broker");
  read("broker = \"[::1]:8080\"\n" + rest + "[http]\nlisten = \"[::]:8080\"\n");
  expect_mistake(7, "itself shows its page", "give the address of the broker");
  for (const char* no_end : {"a:b:c", "", "mqtt.example:0", "a b"}) {
    read("broker = \"" + std::string(no_end) + "\"\n" + rest);
    expect_mistake(7, "'broker' is neither an address nor a name", "write it as \"192.0.2.5\"");
  }
}

}  // namespace
}  // namespace etcm::firmware

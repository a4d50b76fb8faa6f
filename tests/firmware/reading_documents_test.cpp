// What nodes measure, as it is shown over HTTP.
#include <gtest/gtest.h>

#include <array>
#include <limits>
#include <regex>
#include <string>

#include "firmware/status/status_page.h"
#include "measuring.h"
#include "page_reader.h"

namespace etcm::firmware {
namespace {

using namespace std::chrono_literals;

class ShownReadings : public Measuring, protected PageReader {
 protected:
  ShownReadings() : PageReader(rig_) {}
  void open(const std::string& text = measuring_settings) {
    start(text);
    make_page();
  }
  void run_page(port::Duration duration) {
    rig_.run(duration);
    page_->advance(rig_.clock.now());
  }
  // With ages as "AGE".
  std::string readings() {
    return std::regex_replace(get("/readings.json"),
                              std::regex(R"(,\d+,(true|false),null,false\])"),
                              ",AGE,$1,null,false]");
  }
  static bool has(const std::string& text, const std::string& part) {
    return text.find(part) != std::string::npos;
  }
};

TEST_F(ShownReadings, AreAListOfTheirOwn) {
  open();
  EXPECT_TRUE(has(readings(),
                  "\"quantities\":[{\"name\":\"level\",\"unit\":\"m\"},"
                  "{\"name\":\"temperature\",\"unit\":\"°C\"},"
                  "{\"name\":\"level\",\"unit\":\"cm\"}],\n\"names\":[],\n\"readings\":[]}\n"))
      << readings();
  put_tank(2, -1);
  put_tank(3, 32767);
  put_well(5, 77, 21.5f, 123'456'789);
  run_page(1s);
  const std::string text = readings();
  EXPECT_STREQ(answer_.media_type, "application/json");
  EXPECT_TRUE(
      has(text,
          "\"readings\":[[77,0,0.123456789,AGE,false,null,false],[77,1,21.5,AGE,false,null,false],"
          "[1002,0,-0.001,AGE,false,null,false],[1003,0,null,AGE,false,null,false]]}\n"))
      << text;
  EXPECT_TRUE(has(text, "\"generation\":" + std::to_string(rig_.gateway->generation()) + ","));
  EXPECT_TRUE(has(get("/status.json"), "\"quantities\":3,\"readings_sequence\":" +
                                           std::to_string(rig_.gateway->readings().sequence) +
                                           ","));
}

TEST_F(ShownReadings, OfASilentNodeAreStaleWithTheirAge) {
  put_tank(2, 1500);
  put_tank(3, 1);
  open();
  run_page(1s);
  bus_.silence(2);
  run_page(2s);
  std::smatch found;
  const std::string text = get("/readings.json");
  ASSERT_TRUE(
      std::regex_search(text, found, std::regex(R"(\[1002,0,1\.5,(\d+),true,null,false\])")))
      << text;
  EXPECT_GT(std::stoi(found[1]), 1500);
  const std::string metrics = get("/metrics");
  EXPECT_FALSE(has(metrics, "etcm_reading{name=\"level\",unit=\"m\",serial=\"1002\"}"));
  EXPECT_TRUE(has(metrics, "\netcm_reading{name=\"level\",unit=\"m\",serial=\"1003\"} 0.001\n"));
  EXPECT_TRUE(std::regex_search(
      metrics, found,
      std::regex(
          R"re(etcm_reading_age_seconds\{name="level",unit="m",serial="1002"\} ([0-9.]+)\n)re")));
  EXPECT_GT(std::stod(found[1]), 1.5);
  EXPECT_TRUE(has(get("/mesh.geojson"), ",\"stale reading level (m)\":1.5,"));
  run_page(5s);  // and missing
  EXPECT_TRUE(has(readings(), "[1002,0,1.5,AGE,true,null,false]"));
  EXPECT_TRUE(has(get("/mesh.geojson"), "\"missing\":true,\"stale reading level (m)\":1.5}}"));
}

TEST_F(ShownReadings, ArePropertiesOfNodesInTheMesh) {
  put_tank(2, 1500);
  put_well(5, 77, 21.5f, 0, false);
  put_rover(8, 0, 0, 12, false);
  open();
  run_page(1s);
  const std::string mesh = get("/mesh.geojson");
  EXPECT_TRUE(has(mesh, "\"stale\":false,\"reading level (m)\":1.5,\"neighbours\":[")) << mesh;
  EXPECT_TRUE(has(mesh,
                  "\"reading level (m)\":null,\"reading temperature (°C)\":21.5,"
                  "\"neighbours\":["))
      << mesh;
  EXPECT_TRUE(has(mesh, "\"in_mesh\":false,\"reading level (cm)\":12}}")) << mesh;
  for (const std::size_t piece : {1u, 100u, 4096u}) EXPECT_EQ(get("/mesh.geojson", piece), mesh);
}

TEST_F(ShownReadings, TheVersionOfTheMeshChangesWithValuesAndNotWithTimes) {
  put_tank(2, 1500);
  open();
  run_page(1s);
  get("/mesh.geojson");
  const std::uint64_t before = answer_.version;
  run_page(1s);
  get("/mesh.geojson");
  EXPECT_EQ(answer_.version, before);
  put_tank(2, 1501);
  run_page(1s);
  get("/mesh.geojson");
  EXPECT_NE(answer_.version, before);
}

TEST_F(ShownReadings, ASlowReaderHasOneTableToTheEnd) {
  put_tank(2, 1);
  put_tank(3, 1);
  open();
  run_page(1s);
  std::array<char, 20> out;
  page_->begin(1, "/readings.json");
  std::string slow(out.data(), page_->read(1, out));
  for (std::int16_t level = 2; level < 9; ++level) {
    put_tank(2, level);
    put_tank(3, level);
    run_page(500ms);
    const std::string value = "0.00" + std::to_string(level);
    EXPECT_TRUE(
        has(readings(), "[1002,0," + value + ",AGE,false,null,false],[1003,0," + value + ","));
  }
  slow += rest(1);
  EXPECT_TRUE(has(slow, "[1002,0,0.001,")) << slow;
  EXPECT_TRUE(has(slow, "[1003,0,0.001,")) << slow;
}

TEST_F(ShownReadings, NamesAndUnitsMayHoldAnythingAsLongAsTheyAreShort) {
  std::string text = measuring_settings;
  const std::string nasty = R"(\"\\<é>)";
  for (std::size_t at = 0; (at = text.find("\"m\"", at)) != std::string::npos; at += 3) {
    text.replace(at, 3, "\"" + nasty + "\"");
  }
  put_tank(2, 1);
  open(text);
  run_page(1s);
  EXPECT_TRUE(has(get("/readings.json"), R"({"name":"level","unit":"\"\\<é>"})"));
  EXPECT_TRUE(has(get("/mesh.geojson"), R"x("reading level (\"\\<é>)":0.001)x"));
  EXPECT_TRUE(has(get("/metrics"), R"(,unit="\"\\)"));
}

TEST_F(ShownReadings, TheLongestNamesFitAPiece) {
  std::string text = measuring_settings;
  const auto replace_all = [&](const std::string& from, const std::string& to) {
    for (std::size_t at = 0; (at = text.find(from, at)) != std::string::npos; at += to.size()) {
      text.replace(at, from.size(), to);
    }
  };
  replace_all("\"level\"", "'" + std::string(reading_name_max, '"') + "'");
  replace_all("\"m\"", "'" + std::string(reading_unit_max, '"') + "'");
  put_tank(2, 1);
  open(text);
  run_page(1s);
  std::string escaped_name, escaped_unit;
  for (std::size_t i = 0; i < reading_name_max; ++i) escaped_name += "\\\"";
  for (std::size_t i = 0; i < reading_unit_max; ++i) escaped_unit += "\\\"";
  EXPECT_TRUE(
      has(get("/mesh.geojson"), "\"reading " + escaped_name + " (" + escaped_unit + ")\":0.001,"));
  EXPECT_TRUE(has(get("/metrics"), "etcm_reading{name=\"" + escaped_name + "\",unit=\"" +
                                       escaped_unit + "\",serial=\"1002\"} 0.001\n"));
}

TEST(TextWriterNano, IsExactAndShort) {
  const auto text_of = [](std::int64_t value) {
    std::array<char, 40> room;
    TextWriter out(room);
    return std::string(out.nano(value).text());
  };
  EXPECT_EQ(text_of(0), "0");
  EXPECT_EQ(text_of(1), "0.000000001");
  EXPECT_EQ(text_of(-1), "-0.000000001");
  EXPECT_EQ(text_of(-1'500'000'000), "-1.5");
  EXPECT_EQ(text_of(20'000'000'000), "20");
  EXPECT_EQ(text_of(100'010'000), "0.10001");
  EXPECT_EQ(text_of(std::numeric_limits<std::int64_t>::max()), "9223372036.854775807");
  EXPECT_EQ(text_of(-std::numeric_limits<std::int64_t>::max()), "-9223372036.854775807");
  std::array<char, 4> room;
  TextWriter full(room);
  EXPECT_TRUE(full.nano(1'234'567'890'123).is_full());
}

}  // namespace
}  // namespace etcm::firmware

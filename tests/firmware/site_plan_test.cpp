// The plan of a site: what is said of one that is wrong, and where a right one lies.
#include "firmware/config/site_plan.h"

#include <gtest/gtest.h>

#include "firmware/config/configuration.h"
#include "support/scratch_folder.h"

namespace etcm::firmware {
namespace {

std::string big_endian(std::uint32_t value, int bytes) {
  std::string text;
  while (bytes-- > 0) text += static_cast<char>(value >> 8 * bytes & 255);
  return text;
}

std::string png_head(std::uint32_t width, std::uint32_t height) {
  return std::string("\x89PNG\r\n\x1a\n\0\0\0\rIHDR", 16) + big_endian(width, 4) +
         big_endian(height, 4) + "the rest";
}

// With a segment of another kind before the frame, as cameras write them.
std::string jpeg_head(std::uint32_t width, std::uint32_t height) {
  return std::string("\xff\xd8\xff\xe1\x00\x06 abc\xff\xc2\x00\x11\x08", 15) +
         big_endian(height, 2) + big_endian(width, 2) + std::string(20, '\0');
}

class Plan : public testing::Test {
 protected:
  Settings read(const std::string& plan, const std::string& more = "") {
    const std::string config = folder_.write(
        "site.toml", "[site]\nplan = \"" + plan + "\"\n" + more +
                         "\n[mesh]\nvertices_max = 200\n[[bus]]\ntcp = \"127.0.0.1:502\"\n"
                         "units = \"1\"\n");
    mistakes_.clear();
    return read_configuration(config, nullptr, mistakes_);
  }
  // The only mistake, without the folder.
  std::string mistake() const {
    if (mistakes_.size() != 1) return std::to_string(mistakes_.size()) + " mistakes";
    return mistakes_[0].substr(folder_.path("").size());
  }

  test::ScratchFolder folder_;
  std::vector<std::string> mistakes_;
};

TEST_F(Plan, LiesWhereItsWorldFileSays) {
  folder_.write("plan.png", png_head(200, 100));
  folder_.write("plan.pgw", "0.5\n0\n0\n-0.5\n10.25\n59.75\n");
  const Settings settings = read("plan.png", "unit = \"0.01\"\norigin = [\"10\", \"0\"]");
  ASSERT_EQ(mistakes_, std::vector<std::string>{});
  ASSERT_NE(settings.site.plan, nullptr);
  EXPECT_STREQ(settings.site.plan->media_type, "image/png");
  const auto corners = plan_corners(*settings.site.plan, settings.site.plane());
  ASSERT_TRUE(corners);
  const auto& [left, right, below] = *corners;
  EXPECT_EQ(left.x, 0);
  EXPECT_EQ(left.y, 6000);
  EXPECT_EQ(right.x, 10000);
  EXPECT_EQ(right.y, 6000);
  EXPECT_EQ(below.x, 0);
  EXPECT_EQ(below.y, 1000);
}

TEST_F(Plan, MayBeAJpegWithAnyOfTheNamesOfAWorldFile) {
  for (const char* world : {"map.jgw", "map.jpgw", "map.wld"}) {
    test::ScratchFolder folder;
    folder.write("map.jpg", jpeg_head(640, 480));
    folder.write(world, " 1 0 0\r\n-1 0.5 -0.5");
    Settings settings;
    settings.site.plan_path = folder.path("map.jpg");
    read_plan(settings, mistakes_);
    ASSERT_EQ(mistakes_, std::vector<std::string>{}) << world;
    EXPECT_EQ(settings.site.plan->width, 640u);
    EXPECT_EQ(settings.site.plan->height, 480u);
    EXPECT_STREQ(settings.site.plan->media_type, "image/jpeg");
  }
}

TEST_F(Plan, ThatIsNotThereIsNamed) {
  read("nowhere.png");
  EXPECT_EQ(mistake(), "site.toml:1: the plan " + folder_.path("nowhere.png") +
                           " is not there; correct 'plan'");
}

TEST_F(Plan, OfAnotherKindIsRefused) {
  for (const std::string& bytes :
       {std::string("GIF89a..."), std::string("\xff\xd8\xff", 3), png_head(0, 5),
        std::string("\xff\xd8 no segment at all", 20), std::string("\x89PNG")}) {
    folder_.write("plan.png", bytes);
    read("plan.png");
    EXPECT_EQ(mistake(), "plan.png: is neither a PNG nor a JPEG; save the plan as one of these");
  }
}

TEST_F(Plan, ThatIsTooLargeIsRefusedWithTheBound) {
  folder_.write("plan.png", png_head(8193, 10));
  read("plan.png");
  EXPECT_EQ(mistake(),
            "plan.png: has 8193 x 10 pixels, and a plan has 8192 at the most on each side; save it "
            "coarser");
  folder_.write("plan.png", png_head(10, 10) + std::string(plan_bytes_max, 'x'));
  read("plan.png");
  EXPECT_EQ(
      mistake(),
      "plan.png: has more than 8388608 bytes, the most for a plan; save it smaller or coarser");
}

TEST_F(Plan, WithoutASoundWorldFileIsRefused) {
  folder_.write("plan.png", png_head(10, 10));
  read("plan.png");
  EXPECT_EQ(mistake(),
            "plan.png: a world file that says where it lies is missing; put one beside it "
            "(plan.pgw, plan.pngw, plan.wld)");
  for (const char* world : {"", "1 0 0 -1 5", "1 0 0 -1 5 5 5", "1 0 0 -1 5 east", "1 0 0 nan 5 5",
                            "1 0 0 1e999 5 5", "1, 0, 0, -1, 5, 5"}) {
    folder_.write("plan.pgw", world);
    read("plan.png");
    EXPECT_EQ(mistake(),
              "plan.pgw: is no world file; it has six numbers, a line each: width of a pixel, two "
              "turns (0), height of a pixel (below 0), x and y of the middle of the upper left "
              "pixel")
        << world;
  }
  folder_.write("plan.pgw", "1 0 0 0 5 5");
  read("plan.png");
  EXPECT_EQ(mistake(),
            "plan.pgw: its pixels have no area; correct the first and the fourth number");
  folder_.write("plan.pgw", "1 0 0 -1 7034000000 5");
  read("plan.png");
  EXPECT_EQ(mistake().find("plan.png: lies beyond the plane of the mesh; "), 0u) << mistake();
}

// A plane that is degrees doubled, in metres of a thousand.
class PlanProjection final : public port::Projection {
 public:
  std::optional<port::PlanePoint> to_plane(port::EarthPoint point) const override {
    return port::PlanePoint{.x = 2000 * point.longitude, .y = 2000 * point.latitude};
  }
  std::optional<port::EarthPoint> to_earth(port::PlanePoint point) const override {
    return port::EarthPoint{.longitude = point.x / 2000, .latitude = point.y / 2000};
  }
  bool counts_in_degrees() const override { return false; }
  double metres() const override { return 1; }
};

TEST_F(Plan, LiesByDegreesOrByThePlane) {
  SitePlan plan;
  plan.width = plan.height = 100;
  plan.world = {0.01, 0, 0, -0.01, 10.005, 59.995};
  plan.is_in_degrees = true;
  SitePlane plane{.unit_length = site_nano, .projection = std::make_shared<PlanProjection>()};
  auto corners = plan_corners(plan, plane);
  ASSERT_TRUE(corners);
  EXPECT_NEAR((*corners)[0].x, 20000, 1e-3);
  EXPECT_NEAR((*corners)[0].y, 120000, 1e-3);
  EXPECT_NEAR((*corners)[1].x, 22000, 1e-3);
  EXPECT_NEAR((*corners)[2].y, 118000, 1e-3);
  plan.is_in_degrees = false;
  corners = plan_corners(plan, plane);
  ASSERT_TRUE(corners);
  EXPECT_NEAR((*corners)[0].x, 10, 1e-3);
  plan.is_in_degrees = true;
  EXPECT_FALSE(plan_corners(plan, {.unit_length = site_nano})) << "until the fleet knows";
}

class PlanFrame : public Plan {
 protected:
  PlanFrame() {
    folder_.write("plan.png", png_head(100, 100));
    settings_.site.unit_length = site_nano;
    settings_.site.plan_path = folder_.path("plan.png");
  }
  // The only mistake of a plan with this world file, or what it counts in.
  std::string frame(const char* world, PlanIn said) {
    folder_.write("plan.pgw", world);
    settings_.site.plan_in = said;
    mistakes_.clear();
    read_plan(settings_, mistakes_);
    if (!mistakes_.empty()) return mistake();
    return settings_.site.plan->is_in_degrees ? "degrees" : "plane";
  }

  static constexpr const char* small = "0.01 0 0 -0.01 10.005 59.995";
  static constexpr const char* large = "1 0 0 -1 569000.5 7033999.5";
  Settings settings_;
};

TEST_F(PlanFrame, OfASiteWithoutDegreesIsThatOfThePlane) {
  EXPECT_EQ(frame(small, PlanIn::unsaid), "plane");
  EXPECT_EQ(frame(small, PlanIn::plane), "plane");
  EXPECT_EQ(frame(large, PlanIn::unsaid), "plane");
  EXPECT_EQ(frame(small, PlanIn::degrees),
            "plan.png: its world file is said to be in degrees, and the site has none; take "
            "plan_in out of [site], or say where the site is by 'crs' or 'origin'");
}

TEST_F(PlanFrame, ThatCanBeEitherHasToBeSaid) {
  settings_.site.projection = std::make_shared<PlanProjection>();
  EXPECT_EQ(frame(small, PlanIn::unsaid),
            "plan.png: its world file can be in degrees, or in what the plane of the site counts "
            "in; say which in [site]: plan_in = \"degrees\" or plan_in = \"plane\"");
  EXPECT_EQ(frame(small, PlanIn::plane), "plane");
  EXPECT_EQ(frame(small, PlanIn::degrees), "degrees");
}

TEST_F(PlanFrame, ThatCanBeNoDegreesIsThatOfThePlane) {
  settings_.site.projection = std::make_shared<PlanProjection>();
  EXPECT_EQ(frame(large, PlanIn::unsaid), "plane");
  // One corner is enough.
  EXPECT_EQ(frame("1 0 0 -1 81.5 50", PlanIn::unsaid), "plane");
  EXPECT_EQ(frame("1 0 0 -1 10 9.4", PlanIn::unsaid), "plane");
  EXPECT_EQ(frame(large, PlanIn::degrees),
            "plan.png: its world file leads beyond the degrees of the earth; correct it, or write "
            "plan_in = \"plane\" in [site]");
}

TEST_F(PlanFrame, MayComeFromTheFleet) {
  settings_.mqtt.emplace();
  EXPECT_EQ(frame(small, PlanIn::degrees), "degrees");
  EXPECT_NE(frame(small, PlanIn::unsaid).find("say which"), std::string::npos);
  EXPECT_EQ(frame(large, PlanIn::unsaid), "plane");
}

TEST_F(Plan, SaysWhatItCountsInByAKey) {
  folder_.write("plan.png", png_head(100, 100));
  folder_.write("plan.pgw", "0.01 0 0 -0.01 10.005 59.995");
  read("plan.png", "plan_in = \"plane\"");
  EXPECT_EQ(mistakes_, std::vector<std::string>{});
  read("plan.png", "plan_in = \"metres\"");
  EXPECT_NE(mistake().find("plan_in"), std::string::npos) << mistake();
}

}  // namespace
}  // namespace etcm::firmware

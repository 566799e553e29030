// Proves: photos are counted to the shot that they are of, brackets as wholes, and what is said to take now is what is
// missing. Oracle: places and exposures that the test sets out itself; no photo is read.
#include "tools/watch/shoot.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "tests/drawn_photo.h"
#include "tools/watch/say_shoot.h"

namespace burin {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::Not;
using Kind = NextStep::Kind;

constexpr double kPaperFactor = 1.0 / 60 / 64;  // has the paper at 60 %: 1/60 s at f/8

struct ShootTest : testing::Test {
  Shoot shoot;
  int count = 0;

  ShootTest() {
    shoot.board = drawn_board();
    want("left", 500, -30, 0);
    want("middle", 500, 0, 0);
    want("far", 760, 0, 30);
  }
  void want(const std::string& name, double distance_mm, double right_deg, double up_deg, const char* light = "lamp") {
    WantedShot shot;
    shot.name = name;
    shot.place = "camera somewhere";
    shot.light = light;
    shot.lamp_place = "900 mm above";
    shot.eye_mm = looking_at_board(shoot.board, distance_mm, right_deg, up_deg).inverse().translation();
    shot.tolerance = {{15, 15}, {15, 15}, {30, 30}};  // three times that counts
    shoot.wanted.push_back(shot);
  }
  // A photo from there, so many stops above the paper's exposure; glints are `glints` times white at the paper's.
  PhotoFacts photo(double distance_mm, double right_deg, double up_deg, double stops, double glints = 10) {
    PhotoFacts f;
    f.file = "IMG_" + std::to_string(++count) + ".JPG";
    f.width = 900;
    f.height = 700;
    f.exposure_factor = kPaperFactor * std::exp2(stops);
    f.exif.exposure_s = std::exp2(stops) / 60;
    f.exif.f_number = 8;
    f.exif.iso = 100;
    for (const Tag& tag : shoot.board.tags.list) f.tags.push_back({tag.id, {}, 0, 0});
    f.tag_side_px = 60;
    f.paper = std::min(1.0, kPaperAt * std::exp2(stops));
    f.paper_clipped = f.paper >= 1 ? 1 : 0;
    f.blur_px = f.worst_blur_px = 0.8;
    f.pose = BoardPose{looking_at_board(shoot.board, distance_mm, right_deg, up_deg), 0.1};
    f.carve_seen = true;
    f.glints_bright = std::min(1.0, glints * std::exp2(stops));
    f.glints_clipped = *f.glints_bright >= 1 ? 0.05 : 0;
    return f;
  }
};

TEST_F(ShootTest, BeginsWithTheFirstShot) {
  EXPECT_EQ(next_step(shoot).kind, Kind::move);
  EXPECT_EQ(next_step(shoot).shot, 0U);
  EXPECT_THAT(next_words(shoot), AllOf(HasSubstr("shot \"left\""), HasSubstr("lamp \"lamp\" 900 mm above")));
}

TEST_F(ShootTest, BracketIsPaperAndThenGlints) {
  const JudgedPhoto first = add_photo(photo(505, -29, 1, 0), shoot);
  EXPECT_EQ(first.shot, 0U);
  EXPECT_EQ(state_of(shoot, 0), ShotState::begun);
  NextStep next = next_step(shoot);
  EXPECT_EQ(next.kind, Kind::expose);
  EXPECT_TRUE(next.for_glints);
  EXPECT_NEAR(next.factor, kPaperFactor / 8, 1e-12);
  EXPECT_THAT(next_words(shoot), HasSubstr("the same place at 1/500 s (f/8, ISO 100), 3 stops darker, for the glints"));
  add_photo(photo(505.2, -29, 1, -3), shoot);  // ten times white, three stops darker: clipped still
  EXPECT_NEAR(next_step(shoot).factor, kPaperFactor / 64, 1e-12);
  add_photo(photo(505.1, -29, 1, -6), shoot);
  EXPECT_EQ(state_of(shoot, 0), ShotState::done);
  next = next_step(shoot);
  EXPECT_EQ(next.kind, Kind::move);
  EXPECT_EQ(next.shot, 1U);
  EXPECT_THAT(next_words(shoot),
              AllOf(HasSubstr("from here 245 mm to the right"), HasSubstr("60 mm higher"), HasSubstr("at 1/60 s")));
  EXPECT_EQ(state_words(shoot), "1 of 3 shots");
}

TEST_F(ShootTest, PaperFirstWhereItIsTooBrightOrTooDark) {
  add_photo(photo(500, 0, 0, 3), shoot);
  EXPECT_NEAR(next_step(shoot).factor, kPaperFactor * 8 / 4, 1e-12) << "clipped: nothing tells by how much";
  add_photo(photo(500, 0, 0, -3, 1), shoot);
  EXPECT_EQ(next_step(shoot).kind, Kind::expose);
  EXPECT_FALSE(next_step(shoot).for_glints);
  EXPECT_NEAR(next_step(shoot).factor, kPaperFactor, 1e-12);
}

// Two halves of a bracket from two places are no bracket.
TEST_F(ShootTest, BracketStandsStill) {
  add_photo(photo(500, 0, 0, 0), shoot);
  add_photo(photo(500, 3, 0, -6), shoot);  // 26 mm aside, the same shot
  EXPECT_EQ(shoot.photos.back().shot, 1U);
  EXPECT_EQ(state_of(shoot, 1), ShotState::begun);
}

TEST_F(ShootTest, PhotoFromElsewhereIsNone) {
  const JudgedPhoto far = add_photo(photo(500, 14, 0, 0), shoot);
  EXPECT_FALSE(far.shot);
  EXPECT_EQ(far.nearest, 1U);
  EXPECT_NEAR(far.offset.sideways_mm, 500 * std::tan(14 * std::numbers::pi / 180), 1);
  EXPECT_THAT(last_photo_words(shoot), AllOf(HasSubstr("none of the planned ones; nearest is shot \"middle\""),
                                             HasSubstr("120 mm to the right, 15 mm lower")));
  EXPECT_EQ(next_step(shoot).kind, Kind::move);
}

// Where no plan names the further photos, one from anywhere else is one of them; one beside a wanted place missed it.
TEST_F(ShootTest, WithoutAPlanPhotosFromElsewhereAreFurtherOnes) {
  shoot.least_places = 8;
  add_photo(photo(500, 14, 0, 0), shoot);  // 121 mm aside where 45 count
  EXPECT_EQ(next_step(shoot).kind, Kind::move);
  EXPECT_THAT(last_photo_words(shoot), HasSubstr("none of the planned ones"));
  add_photo(photo(500, 40, 30, 0), shoot);
  EXPECT_THAT(last_photo_words(shoot), HasSubstr("a further place: 6 of 6 tags"));
  EXPECT_EQ(next_step(shoot).kind, Kind::expose);
  add_photo(photo(500, 40, 30, -6), shoot);
  EXPECT_EQ(next_step(shoot).shot, 0U);
  EXPECT_THAT(next_words(shoot), Not(HasSubstr("camera somewhere"))) << "said before";
}

TEST_F(ShootTest, FaultsAreTakenAgain) {
  add_photo(photo(500, 0, 0, 0, 0.5), shoot);
  EXPECT_EQ(state_of(shoot, 1), ShotState::done) << "glints are held at the paper's exposure: one photo is enough";
  PhotoFacts blurred = photo(500, -30, 0, 0, 0.5);
  blurred.blur_px = blurred.worst_blur_px = 3;
  add_photo(blurred, shoot);
  EXPECT_EQ(state_of(shoot, 0), ShotState::again);
  EXPECT_EQ(next_step(shoot).kind, Kind::retake);
  EXPECT_THAT(last_photo_words(shoot), AllOf(HasSubstr("error: is blurred"), HasSubstr("now: take this one again"),
                                             HasSubstr("[1 of 3 shots, 1 to take again]")));
  add_photo(photo(500, -30, 0, 0, 0.5), shoot);
  EXPECT_EQ(state_of(shoot, 0), ShotState::done);
  EXPECT_THAT(missing_words(shoot), AllOf(HasSubstr("missing"), HasSubstr("\"far\""), Not(HasSubstr("\"left\""))));
}

TEST_F(ShootTest, DeletedPhotoOpensItsShotAgain) {
  const auto file = add_photo(photo(500, 0, 0, 0, 0.5), shoot).facts.file;
  EXPECT_TRUE(remove_photo(file, shoot));
  EXPECT_EQ(state_of(shoot, 1), ShotState::open);
  EXPECT_FALSE(remove_photo(file, shoot));
}

TEST_F(ShootTest, CameraOnItsSideIsAnotherShot) {
  const Eigen::Isometry3d upright = looking_at_board(shoot.board, 500, 0, 0);
  Eigen::Isometry3d turned = upright;
  turned.prerotate(Eigen::AngleAxisd(std::numbers::pi / 2, Eigen::Vector3d::UnitZ()));
  shoot.wanted.resize(1);
  want("upright", 500, 0, 0);
  shoot.wanted.back().T_camera_board = upright;
  want("side", 500, 0, 0);
  shoot.wanted.back().T_camera_board = turned;
  EXPECT_EQ(add_photo(photo(500, 0, 0, 0, 0.5), shoot).shot, 1U);
  PhotoFacts side = photo(500, 0, 0, 0, 0.5);
  side.pose->T_camera_board = turned;
  EXPECT_EQ(add_photo(side, shoot).shot, 2U);
  side.file = "upside-down.jpg";
  side.pose->T_camera_board = turned;
  side.pose->T_camera_board.prerotate(Eigen::AngleAxisd(std::numbers::pi, Eigen::Vector3d::UnitZ()));
  EXPECT_EQ(add_photo(side, shoot).shot, 2U) << "upside down is as good";
}

// One place, two lamps: photos do not tell which was on, so the plan's order does.
TEST_F(ShootTest, LampsOfOnePlaceComeInTheirOrder) {
  shoot.wanted.clear();
  want("a", 500, 0, 0, "left lamp");
  want("b", 500, 0, 0, "right lamp");
  EXPECT_EQ(add_photo(photo(500, 0, 0, 0), shoot).shot, 0U);
  EXPECT_EQ(add_photo(photo(500, 0, 0, -6), shoot).shot, 0U);
  EXPECT_THAT(next_words(shoot), HasSubstr("lamp \"right lamp\""));
  EXPECT_EQ(add_photo(photo(500, 0, 0, 0), shoot).shot, 1U);
  EXPECT_EQ(add_photo(photo(500, 0, 0, -6), shoot).shot, 1U);
  EXPECT_EQ(next_step(shoot).kind, Kind::finished);
}

// Where it is known which was on, it counts for that one, in any order; a dark photo without tags, too.
TEST_F(ShootTest, PhotosOfKnownLampsCountForThese) {
  shoot.wanted.clear();
  want("a", 500, 0, 0, "left lamp");
  want("a", 500, 0, 0, "right lamp");
  shoot.light = "right lamp";
  EXPECT_EQ(add_photo(photo(500, 0, 0, 0), shoot).shot, 1U);
  shoot.light = "left lamp";
  PhotoFacts dark = photo(500, 0, 0, -6);
  dark.tags.clear();
  dark.pose.reset();
  dark.place_of_before = true;
  EXPECT_EQ(add_photo(dark, shoot).shot, 0U);
  EXPECT_EQ(add_photo(photo(500, 0, 0, 0), shoot).shot, 0U);
  shoot.light = "right lamp";
  EXPECT_EQ(state_of(shoot, 1), ShotState::begun) << "the glints under the other lamp are not held";
  EXPECT_EQ(add_photo(photo(500, 0, 0, -6), shoot).shot, 1U);
  EXPECT_EQ(state_of(shoot, 1), ShotState::done);
  shoot.light = "third lamp";
  EXPECT_FALSE(add_photo(photo(500, 0, 0, 0), shoot).shot);
}

TEST_F(ShootTest, WithoutAPlanItIsPlacesThatCount) {
  shoot.wanted.clear();
  shoot.least_places = 3;
  for (const double right_deg : {-30., 0., 30.}) {
    EXPECT_EQ(next_step(shoot).kind, Kind::further);
    add_photo(photo(500, right_deg, 0, 0), shoot);
    EXPECT_EQ(next_step(shoot).kind, Kind::expose);
    add_photo(photo(500, right_deg, 0, -6), shoot);
  }
  EXPECT_EQ(next_step(shoot).kind, Kind::finished);
  EXPECT_EQ(state_words(shoot), "6 photos from 3 places");
}

TEST(ShutterWords, AreThoseOfADial) {
  EXPECT_EQ(shutter_words(0.0165), "1/60 s");
  EXPECT_EQ(shutter_words(1.0 / 480), "1/500 s");
  EXPECT_EQ(shutter_words(0.52), "0.5 s");
  EXPECT_EQ(shutter_words(2.4), "2.5 s");
  EXPECT_EQ(shutter_words(1.0 / 40000), "1/40000 s");
}

}  // namespace
}  // namespace burin

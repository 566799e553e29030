// Proves how pictures are laid on the board: which corner goes where, for turned, cropped, fitted, deep, transparent
// and linear pictures; and that "viewer" makes a picture upright in the photo, checked by projecting it.
#include "burin/optimize/target.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <numbers>

#include "burin/base/error.h"
#include "burin/base/files/json_file.h"
#include "burin/optimize/design_file.h"
#include "burin/pictures/picture.h"
#include "burin/render/brdf.h"
#include "tests/temporary_folder.h"

namespace burin {
namespace {

using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

// Dark, with a bright quarter at the upper left.
Image corner_image(int w = 32, int h = 32) {
  Image image(w, h, 1, 0.2F);
  for (int y = 0; y < h / 2; ++y)
    for (int x = 0; x < w / 2; ++x) image.at(x, y) = 0.9F;
  return image;
}

TargetSpec corner_picture(int w = 32, int h = 32) {
  TargetSpec spec;
  spec.image = corner_image(w, h);
  return spec;
}

class TargetTest : public testing::Test {
 protected:
  TemporaryFolder folder_;
};

// The sRGB value as gamma 2.2 encodes the same light.
float regamma(float srgb) { return std::pow(srgb_to_linear(srgb), 1 / 2.2F); }

TEST_F(TargetTest, SameSizeIsPixelForPixel) {
  const Target t = load_target(corner_picture(), 0, {50, 50}, 32, 32);
  EXPECT_NEAR(t.picture.at(15, 15), regamma(0.9F), 0.01);
  EXPECT_NEAR(t.picture.at(16, 15), regamma(0.2F), 0.01);
  EXPECT_NEAR(t.picture.at(0, 0), regamma(0.9F), 0.01);
  EXPECT_NEAR(t.picture.at(31, 31), regamma(0.2F), 0.01);
}

TEST_F(TargetTest, TurnsCounterClockwise) {
  // Upper left goes to lower left after a quarter turn counter-clockwise.
  const Target t = load_target(corner_picture(), 90, {50, 50}, 32, 32);
  EXPECT_NEAR(t.picture.at(4, 28), regamma(0.9F), 0.01);
  EXPECT_NEAR(t.picture.at(4, 4), regamma(0.2F), 0.01);
  EXPECT_NEAR(t.picture.at(28, 28), regamma(0.2F), 0.01);
}

TEST_F(TargetTest, CoverCropsAndContainShowsAll) {
  const TargetSpec wide = corner_picture(64, 32);
  // Square area: a quarter of the width is lost on each side, so the bright part is a quarter wide, half high.
  const Target cover = load_target(wide, 0, {50, 50}, 32, 32);
  EXPECT_NEAR(cover.picture.at(15, 0), regamma(0.9F), 0.01);
  EXPECT_NEAR(cover.picture.at(17, 0), regamma(0.2F), 0.01);
  TargetSpec fit = wide;
  fit.fit = Fit::contain;
  const Target contain = load_target(fit, 0, {50, 50}, 32, 32);
  EXPECT_EQ(contain.picture.at(16, 2), 0);
  // What is lost is said: half of the width, and of an eighth turn the corners.
  EXPECT_THAT(
      cover.findings,
      ElementsAre(Field(&Finding::what, AllOf(HasSubstr("50 % of its width are cropped"), HasSubstr("contain")))));
  EXPECT_THAT(contain.findings, IsEmpty());
  EXPECT_THAT(load_target(corner_picture(), 0, {50, 50}, 32, 32).findings, IsEmpty());
  EXPECT_THAT(load_target(corner_picture(32, 40), 90, {40, 50}, 32, 40).findings,
              ElementsAre(Field(&Finding::what, HasSubstr("36 % of its height are cropped"))));
  EXPECT_NEAR(contain.picture.at(4, 12), regamma(0.9F), 0.01);
  EXPECT_NEAR(contain.picture.at(28, 12), regamma(0.2F), 0.01);
  EXPECT_EQ(contain.picture.at(16, 30), 0);
}

TEST_F(TargetTest, KeepSaysWhichEdgeStays) {
  // The bright corner is the picture's upper left quarter: all of it stays with the left edge, none with the right one.
  TargetSpec wide = corner_picture(64, 32);
  wide.keep = Keep::left;
  const Target left = load_target(wide, 0, {50, 50}, 32, 32);
  EXPECT_NEAR(left.picture.at(30, 4), regamma(0.9F), 0.01);
  EXPECT_THAT(left.findings, IsEmpty());  // it was asked for
  wide.keep = Keep::right;
  EXPECT_THAT([&] { load_target(wide, 0, {50, 50}, 32, 32); }, testing::ThrowsMessage<Error>(HasSubstr("one tone")));
  // Turned by a right angle it is still the picture's own edge.
  wide.keep = Keep::left;
  EXPECT_NEAR(load_target(wide, 90, {50, 50}, 32, 32).picture.at(4, 1), regamma(0.9F), 0.01);
  // A tall one: the bright part is as high as the area, or not there.
  TargetSpec tall = corner_picture(32, 64);
  tall.keep = Keep::top;
  EXPECT_NEAR(load_target(tall, 0, {50, 50}, 32, 32).picture.at(4, 30), regamma(0.9F), 0.01);
  tall.keep = Keep::bottom;
  EXPECT_THAT([&] { load_target(tall, 0, {50, 50}, 32, 32); }, testing::ThrowsMessage<Error>(HasSubstr("one tone")));
  const LaidPicture laid = laid_picture(300, 400, Fit::cover, Keep::top, 0, {200, 100});
  EXPECT_NEAR(laid.height_lost, 1 - 150.0 / 400, 1e-12);
  EXPECT_EQ(laid.width_lost, 0);
  EXPECT_NEAR(laid.center_px.y(), 75, 1e-9);
}

// What is nearly black, or nearly white, is said; but letters on black are just what shows best.
TEST_F(TargetTest, OnlyPicturesThatHardlyShowAreSaidTo) {
  const auto said = [](float ground, float line, int lines) {
    TargetSpec spec;
    spec.image = Image(64, 64, 1, ground);
    for (int y = 0; y < lines; ++y)
      for (int x = 8; x < 40; ++x) spec.image.at(x, 4 + 5 * y) = line;
    std::string all;
    for (const Finding& f : load_target(spec, 0, {50, 50}, 64, 64).findings) all += sentence(f);
    return all;
  };
  EXPECT_EQ(said(0, 1, 6), "") << "white letters on black";
  EXPECT_THAT(said(0.01F, 0.2F, 6), testing::HasSubstr("is nearly black"));
  EXPECT_THAT(said(0, 1, 1), testing::HasSubstr("is nearly black"));
  EXPECT_THAT(said(1, 0, 6), testing::HasSubstr("is nearly white"));
  EXPECT_EQ(said(0.5F, 0, 6), "");
}

TEST_F(TargetTest, LevelsStretch) {
  TargetSpec spec = corner_picture();
  spec.levels = std::array<double, 2>{0.3, 0.8};
  const Target t = load_target(spec, 0, {50, 50}, 32, 32);
  EXPECT_EQ(t.picture.at(0, 0), 1);
  EXPECT_EQ(t.picture.at(31, 31), 0);
}

TEST_F(TargetTest, LinearAndDeepPicturesKeepTheirLight) {
  Image image(16, 16, 1, 0.05F);
  image.at(3, 4) = 0.5F;
  write_picture(image, folder_ / "linear.exr");
  TargetSpec spec;
  spec.picture = folder_ / "linear.exr";
  EXPECT_NEAR(load_target(spec, 0, {10, 10}, 16, 16).picture.at(3, 4), std::pow(0.5, 1 / 2.2), 1e-4);
  write_picture(image, folder_ / "deep.png", 16);
  spec.picture = folder_ / "deep.png";
  EXPECT_NEAR(load_target(spec, 0, {10, 10}, 16, 16).picture.at(3, 4), regamma(0.5F), 1e-4);
}

TEST_F(TargetTest, ColorBecomesLuminance) {
  Image image(16, 16, 3, 0.0F);
  for (int i = 0; i < 128; ++i) image.data[3 * i + 1] = 1;  // upper half green
  TargetSpec spec;
  spec.image = image;
  EXPECT_NEAR(load_target(spec, 0, {10, 10}, 16, 16).picture.at(3, 2), std::pow(0.7152, 1 / 2.2), 2e-3);
}

TEST_F(TargetTest, AnImageInMemoryIsWhatItsFileWouldBe) {
  const Image mask(8, 8, 1, 1.0F);
  write_picture(corner_image(), folder_ / "corner.png", 16);
  write_picture(mask, folder_ / "mask.png", 16);
  TargetSpec file, memory;
  file.picture = folder_ / "corner.png";
  file.mask = folder_ / "mask.png";
  memory.image = corner_image();
  memory.mask_image = mask;
  const Target a = load_target(file, 30, {50, 40}, 25, 20), b = load_target(memory, 30, {50, 40}, 25, 20);
  ASSERT_EQ(a.picture.data.size(), b.picture.data.size());
  for (std::size_t i = 0; i < a.picture.data.size(); ++i) EXPECT_NEAR(a.picture.data[i], b.picture.data[i], 1e-4);
  EXPECT_EQ(a.mask.data, b.mask.data);
}

TEST_F(TargetTest, AnImageInMemoryOfTheWrongSizeIsAnError) {
  TargetSpec spec = corner_picture();
  spec.image.data.pop_back();
  EXPECT_THROW(load_target(spec, 0, {10, 10}, 16, 16), Error);
  spec.image = Image(4, 4, 2, 0.5F);
  EXPECT_THROW(load_target(spec, 0, {10, 10}, 16, 16), Error);
}

TEST_F(TargetTest, OneToneIsAnError) {
  TargetSpec spec;
  spec.image = Image(16, 16, 1, 0.5F);
  EXPECT_THROW(load_target(spec, 0, {10, 10}, 16, 16), Error);
}

TEST_F(TargetTest, ViewerRotationIsUprightInThePhoto) {
  // A camera to the right of the board (azimuth 70 degrees), looking at its middle, rolled by 10 degrees.
  const Eigen::Vector3d center(150 + 500 * std::cos(1.2), 100 + 500 * std::sin(1.2), 700), middle(150, 100, 0);
  const Eigen::Vector3d forward = (middle - center).normalized();
  const Eigen::Vector3d right = forward.cross(Eigen::Vector3d::UnitZ()).normalized();
  Eigen::Matrix3d R;
  R.row(0) = right;
  R.row(1) = forward.cross(right);
  R.row(2) = forward;
  View view;
  view.name = "v";
  view.T_camera_board.linear() = Eigen::AngleAxisd(0.17, Eigen::Vector3d::UnitZ()).toRotationMatrix() * R;
  view.T_camera_board.translation() = -view.T_camera_board.linear() * center;
  const double angle = viewer_rotation_deg(view, {150, 100}) * std::numbers::pi / 180;
  // The picture's up, turned counter-clockwise by the angle, must point straight up in the photo.
  const Eigen::Vector3d up(-std::sin(angle), std::cos(angle), 0);
  const Eigen::Vector3d a = view.T_camera_board * middle, b = view.T_camera_board * (middle + 0.01 * up);
  EXPECT_NEAR(b.x() / b.z(), a.x() / a.z(), 1e-9);
  EXPECT_LT(b.y() / b.z(), a.y() / a.z());
}

TEST_F(TargetTest, DesignFileRoundTripsAndRefuses) {
  DesignSpec spec;
  spec.board = folder_ / "board.json";
  spec.bench = folder_ / "bench.json";
  spec.scratches = 10;
  spec.views.resize(2);
  write_picture(corner_image(), folder_ / "corner.png");
  TargetSpec corner;
  corner.picture = folder_ / "corner.png";
  spec.views[0] = {"v00", "lamp", corner, 2};
  spec.views[0].target.levels = std::array<double, 2>{0.1, 0.9};
  spec.views[0].target.fit = Fit::contain;
  spec.views[1] = {"v01", "lamp", corner, 1};
  spec.views[1].target.upright_in_view = true;
  write_design(spec, folder_ / "design.json");
  const DesignSpec read = read_design(folder_ / "design.json");
  EXPECT_EQ(read.scratches, 10);
  EXPECT_EQ(read.views[0].weight, 2);
  EXPECT_EQ(read.views[0].target.fit, Fit::contain);
  EXPECT_EQ(read.views[0].target.levels, spec.views[0].target.levels);
  EXPECT_TRUE(read.views[1].target.upright_in_view);
  EXPECT_TRUE(std::filesystem::equivalent(read.views[0].target.picture, spec.views[0].target.picture));

  spec.views[1].target.image = corner_image();
  try {
    write_design(spec, folder_ / "memory.json");
    FAIL() << "a file cannot name a picture in memory";
  } catch (const Error& e) {
    EXPECT_THAT(e.what(), AllOf(HasSubstr("v01"), HasSubstr("in memory")));
  }

  const auto error_with = [&](const std::string& views) {
    write_text(R"({"format": "burin/design", "version": 1, "board": "b.json", "bench": "c.json", "scratches": 5, )" +
                   views + "}",
               folder_ / "bad.json");
    try {
      read_design(folder_ / "bad.json");
    } catch (const Error& e) {
      return std::string(e.what());
    }
    return std::string();
  };
  EXPECT_THAT(error_with(R"("views": [{"view": "a", "target": "t.png", "rotaton": 3}])"), HasSubstr("rotaton"));
  EXPECT_THAT(error_with(R"("views": [])"), HasSubstr("views"));
  EXPECT_THAT(error_with(R"("views": [{"view": "a", "target": "t.png", "rotation_deg": "me"}])"), HasSubstr("viewer"));
  EXPECT_THAT(error_with(R"("views": [{"view": "a", "target": "t.png"}, {"view": "a", "target": "u.png"}])"),
              HasSubstr("two pictures"));
}

}  // namespace
}  // namespace burin

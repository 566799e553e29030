// Proves: what goes wrong in real photos is found, named, left out or modeled, and the rest calibrates all the same.
// One clean session is photographed by the simulated camera (burin/simulate/simulated_camera.h); each test
// spoils copies of its photos, or of what is believed of the board, in one way. Bounds are on the distance to the
// truth, next to what the clean session reaches (cameras 0.1 mm RMS, lamp about 4 mm). Missing EXIF, false exposure
// times, clipped and blurred photos before any solve: folder_session_test.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>
#include <functional>
#include <nlohmann/json.hpp>
#include <numbers>
#include <opencv2/calib3d.hpp>
#include <opencv2/imgproc.hpp>

#include "burin/base/image.h"
#include "burin/calib/calibrate.h"
#include "burin/capture/photo.h"
#include "burin/pictures/picture.h"
#include "burin/simulate/simulated_camera.h"
#include "tests/capture/small_truth.h"

namespace burin {
namespace {

namespace fs = std::filesystem;
using testing::AllOf;
using testing::HasSubstr;
using testing::Not;

constexpr int kViews = 8, kWidth = 800, kHeight = 600;
constexpr double kFocal_px = 1150;
constexpr int kTag = 6;  // the one that is spoiled

Eigen::Isometry3d camera_at(int view) {
  const double azimuth = 2 * std::numbers::pi * view / kViews, tilt = 0.45 + 0.15 * (view % 3), far = 385;
  const Eigen::Vector3d target(90 + 5 * std::cos(3 * azimuth), 70 - 6 * std::sin(2 * azimuth), 0);
  const Eigen::Vector3d center = target + far * Eigen::Vector3d(std::sin(tilt) * std::cos(azimuth),
                                                                std::sin(tilt) * std::sin(azimuth), std::cos(tilt));
  const Eigen::Vector3d z = (target - center).normalized(),
                        x = Eigen::Vector3d(1, 0.2 * (view % 4), 0).cross(z).cross(z);
  Eigen::Isometry3d T = Eigen::Isometry3d::Identity();
  T.linear().row(0) = -x.normalized();
  T.linear().row(2) = z;
  T.linear().row(1) = z.cross(-x.normalized());
  T.translation() = -T.linear() * center;
  return T;
}

Json bench_truth() {
  Json json = small_truth();
  json["samples"] = 9;
  json["samples_plain"] = 9;
  auto& board = json["board"];
  board["size_mm"] = {180, 140};
  board["carve_mm"] = {{40, 40}, {140, 100}};
  board["tags"]["sigma_mm"] = 0.1;
  Json list = Json::array();
  for (int i = 0; i < 5; ++i)
    for (const double y : {14.0, 126.0})
      list.push_back({{"id", list.size()}, {"center_mm", {14 + 38 * i, y}}, {"size_mm", 15}});
  for (const double y : {51.0, 89.0})
    for (const double x : {14.0, 166.0}) list.push_back({{"id", list.size()}, {"center_mm", {x, y}}, {"size_mm", 15}});
  board["tags"]["list"] = list;
  json["scratches"]["random"]["count"] = 100;
  json["camera"] = {{"lensmodel", "LENSMODEL_PINHOLE"},
                    {"imagersize", {kWidth, kHeight}},
                    {"intrinsics", {kFocal_px, kFocal_px, 399.5, 299.5}}};
  json["sensor"]["gain"] = 60000;
  json["psf_sigma_px"] = 0.6;
  json["lights"][0]["position_mm"] = {300, -150, 450};
  json["ambient"] = {0.002, 0.002, 0.002};
  json["views"] = Json::array();
  for (int v = 0; v < kViews; ++v) {
    const Eigen::Matrix4d m = camera_at(v).matrix();
    Json rows = Json::array();
    for (int r = 0; r < 4; ++r) rows.push_back({m(r, 0), m(r, 1), m(r, 2), m(r, 3)});
    const std::string name = "v0" + std::to_string(v);
    json["views"].push_back({{"view", name},
                             {"T_camera_board", rows},
                             {"photos",
                              {{{"file", "photos/" + name + ".png"}, {"exposure_s", 0.01}, {"f_number", 8}},
                               {{"file", "photos/" + name + "_short.png"}, {"exposure_s", 0.001}, {"f_number", 8}}}}});
  }
  return json;
}

class Robust : public testing::Test {
 protected:
  static std::unique_ptr<TemporaryFolder> clean;
  Session session;
  Board board;
  TemporaryFolder folder;

  static void TearDownTestSuite() { clean.reset(); }

  void SetUp() override {
    if (!clean) {
      clean = std::make_unique<TemporaryFolder>();
      simulate(write_truth(*clean, bench_truth()), clean->path());
    }
    session = read_session(*clean / "session.json");
    board = read_board(session.board);
  }

  /// Changes all photos of a view. The picture is linear, its white level 1.
  void spoil(int view, const std::function<void(cv::Mat&)>& how) {
    for (Photo& photo : session.photos) {
      if (photo.view != "v0" + std::to_string(view)) continue;
      Image image = read_photo(photo).value;
      cv::Mat picture(image.height, image.width, CV_32F, image.data.data());
      how(picture);
      photo.file = folder / photo.file.filename().string();
      write_picture(image, photo.file, 16);
    }
  }
  void spoil_all(const std::function<void(int view, cv::Mat&)>& how) {
    for (int v = 0; v < kViews; ++v) spoil(v, [&](cv::Mat& picture) { how(v, picture); });
  }

  static cv::Point2f pixel(int view, double x, double y, double z = 0) {
    const Eigen::Vector3d p = camera_at(view) * Eigen::Vector3d(x, y, z);
    return {static_cast<float>(kFocal_px * p.x() / p.z() + 399.5),
            static_cast<float>(kFocal_px * p.y() / p.z() + 299.5)};
  }
  /// The paper of a tag in a photo, its upper side lifted by some mm.
  std::array<cv::Point2f, 4> paper(int view, int id, double lift_mm = 0) const {
    const Eigen::Vector2d c = board.tags.list[static_cast<std::size_t>(id)].center_mm;
    constexpr double kHalf = 15 * 1.25 / 2 + 0.9;  // ten cells of which eight are size_mm, and the quiet paper
    return {pixel(view, c.x() - kHalf, c.y() - kHalf), pixel(view, c.x() + kHalf, c.y() - kHalf),
            pixel(view, c.x() + kHalf, c.y() + kHalf, lift_mm), pixel(view, c.x() - kHalf, c.y() + kHalf, lift_mm)};
  }
  static void fill(cv::Mat& picture, const std::vector<cv::Point2f>& polygon, double value) {
    constexpr int kShift = 4;
    std::vector<cv::Point> fixed;
    for (const cv::Point2f& p : polygon) fixed.emplace_back(cvRound(p.x * 16), cvRound(p.y * 16));
    cv::fillConvexPoly(picture, fixed, cv::Scalar(value), cv::LINE_8, kShift);
  }
  /// Draws what `from` shows of a quadrilateral into another one.
  static void paste(const cv::Mat& from, const std::array<cv::Point2f, 4>& source, cv::Mat& picture,
                    const std::array<cv::Point2f, 4>& target) {
    cv::Mat warped, mask = cv::Mat::zeros(picture.size(), CV_32F);
    cv::warpPerspective(from, warped, cv::getPerspectiveTransform(source.data(), target.data()), picture.size());
    fill(mask, {target.begin(), target.end()}, 1);
    warped.copyTo(picture, mask > 0);
  }

  Calibration solve(bool lamps = false) const {
    CalibrateOptions options;
    options.find_lamps = lamps;
    options.check_with_mrcal = false;
    return calibrate(session, board, options);
  }
  static std::string told(const Calibration& c) {
    std::string text;
    for (const Finding& f : c.findings) text += sentence(f) + "\n";
    return text;
  }
  static Eigen::Vector3d center_error_mm(const View& view) {
    return view.T_camera_board.inverse().translation() - camera_at(view.name[2] - '0').inverse().translation();
  }
  // Of all views, but one that is named.
  static double centers_mm(const Calibration& c, const std::string& but = "") {
    double sum2 = 0;
    std::size_t count = 0;
    for (const View& view : c.bench.views) {
      if (view.name == but) continue;
      sum2 += center_error_mm(view).squaredNorm();
      ++count;
    }
    const double rms = std::sqrt(sum2 / static_cast<double>(count));
    std::printf("centers %.3f mm RMS over %zu views\n%s", rms, count, told(c).c_str());
    return rms;
  }
  static double lamp_mm(const Calibration& c) {
    const double error = (c.bench.lights.at(0).position_mm - Eigen::Vector3d(300, -150, 450)).norm();
    std::printf("lamp %.1f mm off\n", error);
    return error;
  }
  static bool has_view(const Calibration& c, const std::string& name) {
    return std::any_of(c.bench.views.begin(), c.bench.views.end(), [&](const View& v) { return v.name == name; });
  }
};
std::unique_ptr<TemporaryFolder> Robust::clean;

constexpr double kGood_mm = 0.3;

TEST_F(Robust, TheCleanSessionIsSilent) {
  const Calibration c = solve(true);
  EXPECT_LT(centers_mm(c), kGood_mm);
  EXPECT_LT(lamp_mm(c), 15);
  EXPECT_EQ(c.bench.views.size(), 8U);
  EXPECT_EQ(told(c), "");
}

TEST_F(Robust, ATagInTheWrongPlace) {
  board.tags.list[kTag].center_mm += Eigen::Vector2d(2.5, -1.5);
  const Calibration c = solve();
  EXPECT_LT(centers_mm(c), kGood_mm);
  EXPECT_THAT(told(c), AllOf(HasSubstr("tag 6 is left out"), HasSubstr("correct its center_mm by -2.")));
}

TEST_F(Robust, TagsInEachOthersPlaces) {
  std::swap(board.tags.list[3].center_mm, board.tags.list[kTag].center_mm);
  const Calibration c = solve();
  EXPECT_LT(centers_mm(c), kGood_mm);
  EXPECT_THAT(told(c), HasSubstr("tags 3 and 6 lie in each other's places"));
}

// The upper side of the paper stands 3 mm off the metal: parallax moves it differently in every photo.
TEST_F(Robust, APeelingTag) {
  spoil_all([&](int v, cv::Mat& picture) {
    const cv::Mat before = picture.clone();
    const auto flat = paper(v, kTag), lifted = paper(v, kTag, 3);
    fill(picture, {flat.begin(), flat.end()}, 0.02);
    paste(before, flat, picture, lifted);
  });
  const Calibration c = solve();
  EXPECT_LT(centers_mm(c), kGood_mm);
  EXPECT_THAT(told(c), AllOf(HasSubstr("tag 6"), HasSubstr("left out")));
}

TEST_F(Robust, AHalfCoveredTag) {
  spoil_all([&](int v, cv::Mat& picture) {
    const auto p = paper(v, kTag);
    fill(picture, {p[0], p[1], 0.5F * (p[1] + p[2]), 0.5F * (p[0] + p[3])}, 0.1);
  });
  const Calibration c = solve();
  EXPECT_LT(centers_mm(c), kGood_mm);
  EXPECT_THAT(told(c), AllOf(HasSubstr("tag 6 should be in views v00"), HasSubstr("all that hold its place"),
                             HasSubstr("covered")));
}

// A fingertip over one corner, in some photos.
TEST_F(Robust, ACoveredCorner) {
  for (const int v : {1, 4, 5})
    spoil(v, [&](cv::Mat& picture) {
      const auto p = paper(v, kTag);
      cv::circle(picture, p[2], 14, cv::Scalar(0.08), cv::FILLED);
    });
  const Calibration c = solve();
  EXPECT_LT(centers_mm(c), kGood_mm);
  EXPECT_THAT(told(c),
              AllOf(HasSubstr("tag 6 is not used in view v01"), HasSubstr("tag 6 should be in views v04, v05")));
}

// In one photo tag 2 is seen where tag 6 is: a reflection, a loose print, a false reading.
TEST_F(Robust, ATagThatIsReadFalsely) {
  spoil(3, [&](cv::Mat& picture) {
    const cv::Mat before = picture.clone();
    paste(before, paper(3, 2), picture, paper(3, kTag));
    const auto hidden = paper(3, 2);
    fill(picture, {hidden.begin(), hidden.end()}, 0.02);
  });
  const Calibration c = solve();
  EXPECT_LT(centers_mm(c), kGood_mm);
  EXPECT_THAT(told(c), AllOf(HasSubstr("tag 2 is left out in view v03"), HasSubstr("read as this tag")));
}

TEST_F(Robust, ATagThatIsSeenTwice) {
  spoil(3, [&](cv::Mat& picture) {
    const cv::Mat before = picture.clone();
    paste(before, paper(3, 2), picture, paper(3, kTag));
  });
  const Calibration c = solve();
  EXPECT_LT(centers_mm(c), kGood_mm);
  EXPECT_THAT(told(c), AllOf(HasSubstr("tag 2 is not used in view v03"), HasSubstr("seen 2 times")));
}

TEST_F(Robust, APhotoOutOfFocus) {
  spoil(5, [](cv::Mat& picture) { cv::GaussianBlur(picture, picture, {}, 2); });
  const Calibration c = solve();
  EXPECT_LT(centers_mm(c), kGood_mm);
  EXPECT_FALSE(has_view(c, "v05"));
  EXPECT_THAT(told(c), AllOf(HasSubstr("v05.png"), HasSubstr("the photo is blurred, its edges")));
}

TEST_F(Robust, APhotoFarOutOfFocus) {
  spoil(5, [](cv::Mat& picture) { cv::GaussianBlur(picture, picture, {}, 8); });
  const Calibration c = solve();
  EXPECT_LT(centers_mm(c), kGood_mm);
  EXPECT_FALSE(has_view(c, "v05"));
  EXPECT_THAT(told(c), AllOf(HasSubstr("view v05 is left out: no tag can be read"), HasSubstr("out of focus")));
}

// The camera shook by 7 pixels.
TEST_F(Robust, AMovedPhoto) {
  spoil(5, [](cv::Mat& picture) {
    cv::Mat smear = cv::Mat::zeros(7, 7, CV_32F);
    for (int i = 0; i < 7; ++i) smear.at<float>(i, i) = 1.0F / 7;
    cv::filter2D(picture, picture, -1, smear);
  });
  const Calibration c = solve();
  EXPECT_LT(centers_mm(c), kGood_mm);
  EXPECT_FALSE(has_view(c, "v05"));
  EXPECT_THAT(told(c), AllOf(HasSubstr("view v05 is left out"), HasSubstr("the photo is blurred, its edges")));
}

TEST_F(Robust, ADoubleExposedPhoto) {
  for (const auto& [view, dx, dy] : {std::tuple(5, 5.0F, -3.0F), std::tuple(2, 60.0F, 25.0F)})
    spoil(view, [dx = dx, dy = dy](cv::Mat& picture) {
      cv::Mat shifted;
      cv::warpAffine(picture, shifted, cv::Matx23f(1, 0, dx, 0, 1, dy), picture.size());
      picture = 0.5 * picture + 0.5 * shifted;
    });
  const Calibration c = solve();
  EXPECT_LT(centers_mm(c), kGood_mm);
  EXPECT_FALSE(has_view(c, "v05"));
  EXPECT_FALSE(has_view(c, "v02"));
  EXPECT_THAT(told(c), AllOf(HasSubstr("view v05 is left out"), HasSubstr("view v02 is left out"), HasSubstr("twice")));
}

class RobustZoom : public Robust, public testing::WithParamInterface<float> {};
TEST_P(RobustZoom, APhotoWithAnotherFocalLength) {
  const float zoom = GetParam();
  spoil(5, [zoom](cv::Mat& picture) {
    const cv::Mat before = picture.clone();
    cv::warpAffine(before, picture, cv::Matx23f(zoom, 0, (1 - zoom) * 399.5F, 0, zoom, (1 - zoom) * 299.5F),
                   picture.size(), cv::INTER_CUBIC);
  });
  // It is measured with a lens of its own, and does the others no harm.
  const Calibration c = solve();
  EXPECT_LT(centers_mm(c, "v05"), kGood_mm);
  const auto zoomed = std::ranges::find(c.bench.views, "v05", &View::name);
  ASSERT_NE(zoomed, c.bench.views.end());
  const Eigen::Vector3d z = center_error_mm(*zoomed).cwiseQuotient(*zoomed->center_sigma_mm);
  EXPECT_LT(z.cwiseAbs().maxCoeff(), 4);
  EXPECT_THAT(told(c), HasSubstr("view v05 has a focal length"));
}

INSTANTIATE_TEST_SUITE_P(By, RobustZoom, testing::Values(1.02F, 1.1F, 1.4F),
                         [](const auto& info) { return std::to_string(std::lround(100 * info.param)) + "Percent"; });

// Turned half way, it suits no lens, but lens, bow and cameras together take it up: no single photo stands out.
TEST_F(Robust, AZoomThatWasTurnedHalfWay) {
  for (const int view : {5, 6, 7})
    spoil(view, [](cv::Mat& picture) {
      constexpr float kZoom = 1.06F;
      const cv::Mat before = picture.clone();
      cv::warpAffine(before, picture, cv::Matx23f(kZoom, 0, (1 - kZoom) * 399.5F, 0, kZoom, (1 - kZoom) * 299.5F),
                     picture.size(), cv::INTER_CUBIC);
    });
  const Calibration c = solve();
  EXPECT_LT(centers_mm(c), kGood_mm);
  for (const char* view : {"v05", "v06", "v07"}) EXPECT_FALSE(has_view(c, view)) << view;
  const std::string text = told(c), before_ratio = "fit a focal length ";
  EXPECT_THAT(text, AllOf(HasSubstr("the zoom or focus was turned between v04_short.png and v05.png"),
                          HasSubstr("v05, v06, v07"), HasSubstr(before_ratio)));
  const std::size_t at = text.find(before_ratio);
  ASSERT_NE(at, std::string::npos);
  EXPECT_NEAR(std::stod(text.substr(at + before_ratio.size())), 1.06, 0.003);
}

// Three photos were taken after somebody had moved the lamp by 12 cm.
TEST_F(Robust, AMovedLamp) {
  Json other = bench_truth();
  other["lights"][0]["position_mm"] = {230, -50, 450};
  SimulateOptions some;
  some.views = {"v01", "v04", "v06"};
  simulate(write_truth(folder, other), folder.path(), some);
  for (Photo& photo : session.photos)
    if (photo.view == "v01" || photo.view == "v04" || photo.view == "v06")
      photo.file = folder.path() / "photos" / photo.file.filename();
  const Calibration c = solve(true);
  EXPECT_LT(centers_mm(c), kGood_mm);
  EXPECT_LT(lamp_mm(c), 15);
  EXPECT_THAT(told(c), AllOf(HasSubstr("v01, v04, v06 differently from the other photos"), HasSubstr("\"lamp-2\"")));
  EXPECT_EQ(c.bench.views.size(), 5U);

  // The remedy works: with a light of their own they serve.
  for (Photo& photo : session.photos)
    if (photo.view == "v01" || photo.view == "v04" || photo.view == "v06") photo.light = "lamp-2";
  const Calibration two = solve(true);
  ASSERT_EQ(two.bench.lights.size(), 2U) << told(two);
  EXPECT_EQ(two.bench.views.size(), 8U);
  EXPECT_LT(lamp_mm(two), 15);
}

// Paper clipped in every exposure of one view; glints clipped in all of them everywhere.
TEST_F(Robust, ClippedPaperAndGlints) {
  std::erase_if(session.photos, [](const Photo& p) { return p.exposure_s < 0.005; });  // no short exposures
  const Calibration glints = solve(true);
  EXPECT_LT(centers_mm(glints), kGood_mm);
  EXPECT_LT(lamp_mm(glints), 15);
  spoil(5, [](cv::Mat& picture) { picture = cv::min(6 * picture, 1.0); });
  const Calibration c = solve(true);
  EXPECT_LT(centers_mm(c), kGood_mm);
  EXPECT_LT(lamp_mm(c), 15);
  EXPECT_FALSE(has_view(c, "v05"));
  EXPECT_THAT(told(c), AllOf(HasSubstr("view v05 is left out"), HasSubstr("clipped: add a shorter exposure")));
}

}  // namespace
}  // namespace burin

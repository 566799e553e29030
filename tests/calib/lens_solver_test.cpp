// Lenses from real corners with published answers, and from synthetic ones within their predicted uncertainty.
// Not proved here: tags and their placement (board_solver_test).
#include "burin/calib/geometry/lens_solver.h"
#include "tests/places.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <functional>
#include <opencv2/calib3d.hpp>
#include <opencv2/core/version.hpp>
#include <opencv2/imgproc.hpp>
#if CV_VERSION_MAJOR >= 5
#include <opencv2/objdetect.hpp>  // findChessboardCorners
#endif
#include <random>

#include "burin/base/error.h"
#include "burin/base/image.h"
#include "burin/calib/geometry/chessboard.h"
#include "burin/pictures/picture.h"
#include "tests/temporary_folder.h"

namespace burin {
namespace {

namespace fs = std::filesystem;
const fs::path kData = places::data();

// Proves: OpenCV's own 13 photographs give its published calibration (left_intrinsics.yml: f 535.916 with fx = fy, RMS
// 0.3926 a point).
TEST(LensSolver, ReproducesOpenCvsChessboards) {
  const fs::path folder = kData / "photos/opencv_samples";
  std::vector<TargetView> views;
  for (int i = 1; i <= 14; ++i) {
    char name[32];
    std::snprintf(name, sizeof name, "left%02d.jpg", i);
    if (!fs::exists(folder / name)) continue;  // there is no left10
    const Image picture = read_picture(folder / name);
    cv::Mat gray(picture.height, picture.width, CV_8U);
    for (int y = 0; y < picture.height; ++y)
      for (int x = 0; x < picture.width; ++x)
        gray.at<unsigned char>(y, x) = static_cast<unsigned char>(std::lround(255 * picture.at(x, y)));
    std::vector<cv::Point2f> corners;
    ASSERT_TRUE(cv::findChessboardCorners(
        gray, {9, 6}, corners, cv::CALIB_CB_ADAPTIVE_THRESH | cv::CALIB_CB_FAST_CHECK | cv::CALIB_CB_NORMALIZE_IMAGE))
        << name;
    cv::cornerSubPix(gray, corners, {11, 11}, {-1, -1},
                     cv::TermCriteria(cv::TermCriteria::EPS + cv::TermCriteria::COUNT, 30, 0.1));
    TargetView view{name, {}, {}, {}};
    for (int k = 0; k < 54; ++k) {
      view.p_target_mm.emplace_back(25.0 * (k % 9), 25.0 * (k / 9));
      view.q_px.emplace_back(corners[k].x, corners[k].y);
    }
    views.push_back(view);
  }
  ASSERT_EQ(views.size(), 13U);
  LensSolverOptions options;
  options.model = "LENSMODEL_OPENCV5";
  const LensSolution s = solve_lens(views, 640, 480, {200, 125}, options);
  std::printf(
      "f %.3f %.3f (published 535.916), rms %.5f (0.39259); mrcal's own solver moves corners by %.5f px, cameras by "
      "%.5f mm\n",
      s.lens.intrinsics[0], s.lens.intrinsics[1], s.rms_point_px, s.check.max_shift_px, s.check.max_center_mm);
  EXPECT_NEAR(s.lens.intrinsics[0], 535.91573, 535.91573e-3);
  EXPECT_NEAR(s.lens.intrinsics[1], 535.91573, 535.91573e-3);
  EXPECT_NEAR(s.rms_point_px, 0.392591, 0.392591e-2);
  EXPECT_LT(s.check.max_shift_px, 0.01);
}

// Proves: a board in uneven light is found as in even light: the same photographs with one side, or all but the middle,
// darkened by 13 and 60 times.
TEST(Chessboards, AreFoundInUnevenLight) {
  const Chessboard board{9, 6, 25};
  const auto views_in = [&](const std::function<double(double, double)>& light) {
    const TemporaryFolder folder;
    for (const auto& entry : fs::directory_iterator(kData / "photos/opencv_samples")) {
      if (entry.path().extension() != ".jpg") continue;
      Image picture = read_picture(entry.path());
      for (int y = 0; y < picture.height; ++y)
        for (int x = 0; x < picture.width; ++x)
          for (int c = 0; c < picture.channels; ++c)
            picture.at(x, y, c) *= static_cast<float>(light((x + 0.5) / picture.width, (y + 0.5) / picture.height));
      write_picture(picture, folder / entry.path().stem().concat(".png"));
    }
    ChessboardViews found = find_chessboards(folder.path(), board);
    std::sort(found.views.begin(), found.views.end(), [](const auto& a, const auto& b) { return a.name < b.name; });
    return found.views;
  };
  const auto even = views_in([](double, double) { return 1.0; });
  ASSERT_EQ(even.size(), 13U);
  for (const double times : {13., 60.})
    for (const int way : {0, 1}) {
      const auto views = views_in([&](double u, double v) {
        return std::pow(times, way == 0 ? -u : -2 * std::min(0.5, (u - 0.5) * (u - 0.5) + (v - 0.5) * (v - 0.5)));
      });
      ASSERT_EQ(views.size(), even.size()) << times << " times, way " << way;
      double sum2 = 0;
      for (std::size_t i = 0; i < views.size(); ++i)
        for (std::size_t k = 0; k < views[i].q_px.size(); ++k)
          sum2 += (views[i].q_px[k] - even[i].q_px[k]).squaredNorm() / (2.0 * 54 * 13);
      EXPECT_LT(std::sqrt(sum2), 0.2) << times << " times, way " << way;
    }
}

// Proves: mrcal's published calibration of an ultra-wide lens (186 real photos; f 2073.873, 2077.452, RMS 0.5513 an
// axis over its inliers) from its corners, the bow of its board solved for by our own terms: without it the RMS is
// 0.82.
TEST(LensSolver, ReproducesMrcalsWideLens) {
  const fs::path model = kData / "photos/mrcal_docs/opencv8-0.cameramodel";
  const fs::path table = fs::path(testing::TempDir()) / "burin_mrcal_corners.txt";
  const std::string command = std::string("/usr/bin/python3 ") + places::source() + "/tests/calib/mrcal_corners.py " +
                              model.string() + " > " + table.string();
  if (std::system("/usr/bin/python3 -c 'import mrcal' 2>/dev/null") != 0)
    GTEST_SKIP() << "python3-mrcal is not installed";
  ASSERT_EQ(std::system(command.c_str()), 0) << command;
  std::vector<TargetView> views;
  std::ifstream stream(table);
  double view, x, y, u, v, weight;
  while (stream >> view >> x >> y >> u >> v >> weight) {
    if (views.size() <= static_cast<std::size_t>(view)) views.resize(static_cast<std::size_t>(view) + 1);
    TargetView& t = views[static_cast<std::size_t>(view)];
    t.name = "view " + std::to_string(static_cast<int>(view));
    t.p_target_mm.emplace_back(x, y);
    t.q_px.emplace_back(u, v);
    t.sigma_px.push_back(1 / weight);
  }
  fs::remove(table);
  ASSERT_EQ(views.size(), 186U);
  LensSolverOptions options;
  options.model = "LENSMODEL_OPENCV8";
  options.solve_bow = true;
  const LensSolution s = solve_lens(views, 6016, 4016, {693, 693}, options);
  std::printf(
      "f %.3f %.3f (published 2073.873 2077.452), rms %.5f (0.55128), bow %.3f %.3f %.3f mm (published 1.04, -0.52); "
      "mrcal's own "
      "solver moves corners by %.5f px\n",
      s.lens.intrinsics[0], s.lens.intrinsics[1], s.rms_px, s.bow_mm[0], s.bow_mm[1], s.bow_mm[2],
      s.check.max_shift_px);
  EXPECT_NEAR(s.lens.intrinsics[0], 2073.873, 2.073873);
  EXPECT_NEAR(s.lens.intrinsics[1], 2077.452, 2.077452);
  EXPECT_NEAR(s.rms_px, 0.5512778, 0.005512778);
  EXPECT_LT(s.check.max_shift_px, 0.05);
}

}  // namespace
}  // namespace burin

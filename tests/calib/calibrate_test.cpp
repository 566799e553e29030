// From session.json to bench.json: a photographed bench end to end, the files it leaves, and what it says when it
// cannot. Not proved here: the geometry's uncertainty (board_solver_test), the lamp (lamp_test).
#include "burin/calib/calibrate.h"
#include "tests/places.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <functional>
#include <sstream>

#include "burin/base/error.h"
#include "burin/pictures/picture.h"
#include "tests/calib/rig_truth.h"

namespace burin {
namespace {

namespace fs = std::filesystem;
using testing::AllOf;
using testing::HasSubstr;
const fs::path kRig = places::rig("b-small");

std::string error_of(const std::function<void()>& work) {
  try {
    work();
  } catch (const Error& e) {
    return e.what();
  }
  return "no error";
}

// A splined stereographic lens that projects as `lens` does: mrcal's surface of corrections (delta u) over the
// stereographic direction u, a cubic B-spline whose control points are fitted to samples by least squares.
Lens as_splined(const Lens& lens) {
  constexpr int kNx = 14, kNy = 11;
  Lens out;
  out.width = lens.width;
  out.height = lens.height;
  out.model = "LENSMODEL_SPLINED_STEREOGRAPHIC_order=3_Nx=14_Ny=11_fov_x_deg=50";
  out.intrinsics.assign(static_cast<std::size_t>(lens_parameter_count(out.model)), 0.0);
  std::copy(lens.intrinsics.begin(), lens.intrinsics.begin() + 4, out.intrinsics.begin());
  std::vector<Eigen::Vector3d> v;
  for (int y = -2; y <= 42; ++y)
    for (int x = -2; x <= 52; ++x) {
      const Eigen::Vector2d q(lens.width * x / 50.0, lens.height * y / 40.0);
      Eigen::Vector3d ray;
      unproject(lens, {&q, 1}, {&ray, 1});
      if (ray.allFinite()) v.push_back(ray);
    }
  std::vector<Eigen::Vector2d> wanted(v.size()), plain(v.size());
  project(lens, v, wanted);
  std::vector<double> by_intrinsics;
  project(out, v, plain, nullptr, &by_intrinsics);  // linear in the control points
  const auto n = static_cast<Eigen::Index>(out.intrinsics.size());
  const Eigen::Map<const Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>> J(
      by_intrinsics.data(), static_cast<Eigen::Index>(2 * v.size()), n);
  Eigen::VectorXd r(2 * static_cast<Eigen::Index>(v.size()));
  for (std::size_t i = 0; i < v.size(); ++i) r.segment<2>(2 * static_cast<Eigen::Index>(i)) = wanted[i] - plain[i];
  const Eigen::MatrixXd A = J.rightCols(2 * kNx * kNy);
  const Eigen::VectorXd x =
      (A.transpose() * A + 1e-6 * Eigen::MatrixXd::Identity(A.cols(), A.cols())).ldlt().solve(A.transpose() * r);
  for (Eigen::Index i = 0; i < x.size(); ++i) out.intrinsics[4 + static_cast<std::size_t>(i)] = x[i];
  return out;
}

// The bench `b-small`, with few photos where speed matters.
class Calibrate : public testing::Test {
 protected:
  Session session;
  Board board;
  CalibrateOptions geometry_only;
  fs::path folder = fs::path(testing::TempDir()) /
                    ("burin_calibrate_" + std::string(testing::UnitTest::GetInstance()->current_test_info()->name()));

  void SetUp() override {
    session = read_session(kRig / "session.json");
    board = read_board(session.board);
    geometry_only.find_lamps = false;
    fs::remove_all(folder);
    fs::create_directories(folder);
  }
  void TearDown() override { fs::remove_all(folder); }
  void keep_views(std::initializer_list<const char*> names) {
    std::erase_if(session.photos,
                  [&](const Photo& p) { return std::find(names.begin(), names.end(), p.view) == names.end(); });
  }
  // Gray pictures instead of photos.
  Session blank(int views, const std::function<Image(int)>& picture) const {
    Session s;
    s.file = folder / "session.json";
    for (int v = 0; v < views; ++v) {
      Photo photo;
      photo.file = folder / ("blank" + std::to_string(v) + ".png");
      photo.view = "v" + std::to_string(v);
      photo.exposure_s = 0.01;
      photo.f_number = 8;
      write_picture(picture(v), photo.file, 16);
      s.photos.push_back(photo);
    }
    return s;
  }
};

// Proves: the files of `burin calibrate` on an amateur's bench hold camera centers within 0.5 mm RMS of the truth (it
// stood 0.7 m away), in the order of views, with a lens file that reads back and a line for every corner.
TEST_F(Calibrate, AmateursBenchComesOutOfItsPhotos) {
  const Calibration c = calibrate(session, board);
  write_calibration(c, folder / "out");
  const Bench bench = read_bench(folder / "out/bench.json");
  const RigTruth truth = read_rig_truth(kRig);
  ASSERT_EQ(bench.views.size(), truth.views.size());
  double sum2 = 0;
  for (std::size_t v = 0; v < bench.views.size(); ++v) {
    EXPECT_EQ(bench.views[v].name, truth.views[v].name);
    sum2 +=
        (bench.views[v].T_camera_board.inverse().translation() - truth.views[v].T_camera_board.inverse().translation())
            .squaredNorm();
  }
  const double rms = std::sqrt(sum2 / static_cast<double>(bench.views.size()));
  std::printf("centers %.3f mm RMS, corners %.4f px RMS per axis\n", rms, c.geometry.rms_px);
  for (const Light& light : bench.lights)
    std::printf("lamp %s at %.1f %.1f %.1f (true -120.2 541.8 588.7)\n", light.id.c_str(), light.position_mm.x(),
                light.position_mm.y(), light.position_mm.z());
  EXPECT_LT(rms, 0.5);
  EXPECT_LT(c.geometry.rms_px, 0.06);
  EXPECT_EQ(bench.lights.size(), 1U);
  // The lamp's color by the tags' paper; the room's light is taken for gray, and is bluer.
  const Eigen::Vector3d color = bench.lights[0].intensity / bench.lights[0].intensity[0];
  std::printf("color %.4f %.4f (true 0.9677 0.8952)\n", color[1], color[2]);
  EXPECT_NEAR(color[1], 600. / 620., 0.05);
  EXPECT_NEAR(color[2], 555. / 620., 0.05);
  EXPECT_EQ(bench.tags.size(), board.tags.list.size());
  // Each within four of its own sigmas, which tell far more than what was believed before.
  const nlohmann::json said = nlohmann::json::parse(std::ifstream(kRig / "truth.json"));
  ASSERT_TRUE(bench.bow_sigma_mm && bench.sensor.vignette_sigma && bench.ambient_sigma);
  EXPECT_LT(bench.bow_sigma_mm->maxCoeff(), 0.2);
  for (int i = 0; i < 3; ++i) {
    EXPECT_NEAR(bench.bow_mm[i], said["board"]["bow_mm"][i].get<double>(), 4 * (*bench.bow_sigma_mm)[i]) << i;
    EXPECT_NEAR(bench.sensor.vignette[i], said["vignette"][i].get<double>(), 4 * (*bench.sensor.vignette_sigma)[i])
        << i;
  }
  for (const Tag& tag : bench.tags) {
    const auto& list = said["board"]["tags"]["list"];
    const auto known = std::find_if(list.begin(), list.end(), [&](const auto& t) { return t["id"] == tag.id; });
    ASSERT_TRUE(tag.center_sigma_mm && tag.rotation_sigma_deg) << tag.id;
    EXPECT_LT(tag.center_sigma_mm->maxCoeff(), 0.5 * board.tags.sigma_mm) << tag.id;
    for (int axis = 0; axis < 2; ++axis)
      EXPECT_NEAR(tag.center_mm[axis], (*known)["center_mm"][axis].get<double>(), 4 * (*tag.center_sigma_mm)[axis])
          << tag.id;
  }
  EXPECT_EQ(read_cameramodel(folder / "out/camera.cameramodel").intrinsics, c.bench.lens.intrinsics);
  std::ifstream table(folder / "out/residuals.vnl");
  std::string line;
  std::getline(table, line);
  EXPECT_EQ(line, "# view tag corner x_px y_px dx_px dy_px sigma_px used photo");
  std::size_t lines = 0;
  double squares = 0;
  int used_count = 0;
  while (std::getline(table, line)) {
    ++lines;
    std::istringstream words(line);
    std::string view, photo;
    double tag, corner, x, y, dx, dy, sigma, used;
    ASSERT_TRUE(words >> view >> tag >> corner >> x >> y >> dx >> dy >> sigma >> used >> photo) << line;
    if (used != 0) {
      squares += dx * dx + dy * dy;
      used_count += 2;
    }
  }
  EXPECT_EQ(lines, c.geometry.corners.size());
  EXPECT_NEAR(std::sqrt(squares / used_count), c.geometry.rms_px, 1e-4);
}

// Proves: the same photos give the same bits.
TEST_F(Calibrate, IsDeterministic) {
  keep_views({"v00", "v03", "v05", "v08"});
  const Calibration a = calibrate(session, board, geometry_only), b = calibrate(session, board, geometry_only);
  EXPECT_EQ(a.bench.lens.intrinsics, b.bench.lens.intrinsics);
  for (std::size_t v = 0; v < a.bench.views.size(); ++v)
    EXPECT_EQ(a.bench.views[v].T_camera_board.matrix(), b.bench.views[v].T_camera_board.matrix());
  EXPECT_EQ(residual_table(a), residual_table(b));
}

// Proves: a lens of one's own is held, and one view is enough then.
TEST_F(Calibrate, AGivenCameraIsHeld) {
  keep_views({"v03"});
  CalibrateOptions options = geometry_only;
  options.lens = read_rig_truth(kRig).lens;
  options.fix_lens = true;
  const Calibration c = calibrate(session, board, options);
  EXPECT_EQ(c.bench.lens.intrinsics, options.lens->intrinsics);
  const Eigen::Vector3d e = c.bench.views[0].T_camera_board.inverse().translation() -
                            read_rig_truth(kRig).views[3].T_camera_board.inverse().translation();
  EXPECT_LT(e.norm(), 0.5);
  options.lens->width = 1000;
  EXPECT_THAT(error_of([&] { calibrate(session, board, options); }), AllOf(HasSubstr("1000"), HasSubstr("1400")));
}

// Proves: a splined lens serves, fixed and through its file. It is the true lens of the bench resampled onto a spline
// (its control points are corrections to a stereographic camera), so that centers must come out as with the true one.
TEST_F(Calibrate, ASplinedCameraIsHeld) {
  keep_views({"v00", "v03", "v05", "v08"});
  const RigTruth truth = read_rig_truth(kRig);
  const Lens splined = as_splined(truth.lens);
  write_cameramodel(splined, folder / "splined.cameramodel");
  CalibrateOptions options = geometry_only;
  options.lens = read_cameramodel(folder / "splined.cameramodel");
  options.fix_lens = true;
  const Calibration c = calibrate(session, board, options);
  EXPECT_EQ(c.bench.lens.model, splined.model);
  EXPECT_EQ(c.bench.lens.intrinsics, splined.intrinsics);
  EXPECT_LT(c.geometry.rms_px, 0.06);
  ASSERT_EQ(c.bench.views.size(), 4U);
  for (const View& view : c.bench.views)
    for (const auto& real : truth.views)
      if (real.name == view.name) {
        EXPECT_LT((view.T_camera_board.inverse().translation() - real.T_camera_board.inverse().translation()).norm(),
                  0.3)
            << view.name;
      }
  write_calibration(c, folder / "out");
  EXPECT_EQ(read_cameramodel(folder / "out/camera.cameramodel").intrinsics, splined.intrinsics);
}

// Each error: one sentence with what, where and remedy.
TEST_F(Calibrate, RefusesOneView) {
  keep_views({"v03"});
  EXPECT_THAT(error_of([&] { calibrate(session, board); }),
              AllOf(HasSubstr("session.json"), HasSubstr("v03"), HasSubstr("at least three places")));
}

TEST_F(Calibrate, RefusesNoPhotos) {
  session.photos.clear();
  EXPECT_THAT(error_of([&] { calibrate(session, board); }), AllOf(HasSubstr("session.json"), HasSubstr("no photos")));
}

TEST_F(Calibrate, NamesTheFamilyThatIsThere) {
  keep_views({"v00", "v03", "v05"});
  board.tags.family = "tagStandard41h12";
  EXPECT_THAT(error_of([&] { calibrate(session, board); }),
              AllOf(HasSubstr("tagStandard41h12"), HasSubstr("tag36h11"), HasSubstr("board.json"), HasSubstr(".JPG")));
}

TEST_F(Calibrate, NamesTheTagsThatAreThere) {
  keep_views({"v00", "v03", "v05"});
  for (Tag& tag : board.tags.list) tag.id += 500;
  EXPECT_THAT(error_of([&] { calibrate(session, board); }),
              AllOf(HasSubstr("tags 20, 21"), HasSubstr("520"), HasSubstr("board.json")));
}

TEST_F(Calibrate, SaysWhenThereAreNoTags) {
  const Session empty = blank(3, [](int) { return Image(320, 240, 1, 0.3F); });
  EXPECT_THAT(error_of([&] { calibrate(empty, board); }),
              AllOf(HasSubstr("blank0.png"), HasSubstr("no tags were found")));
}

TEST_F(Calibrate, RefusesPhotosOfDifferentSizes) {
  const Session mixed = blank(3, [](int v) { return Image(320 + 16 * v, 240, 1, 0.3F); });
  EXPECT_THAT(error_of([&] { calibrate(mixed, board); }),
              AllOf(HasSubstr("blank"), HasSubstr("320"), HasSubstr("336")));
}

TEST_F(Calibrate, RefusesAPhotoThatIsMissing) {
  keep_views({"v00", "v03", "v05"});
  session.photos[1].file = folder / "gone.png";
  EXPECT_THAT(error_of([&] { calibrate(session, board); }), HasSubstr("gone.png"));
}

// Proves: an output that cannot be written is an error, and leaves nothing.
TEST_F(Calibrate, LeavesNothingWhereItCannotWrite) {
  keep_views({"v00", "v03", "v05"});
  const Calibration c = calibrate(session, board, geometry_only);
  std::ofstream(folder / "file") << "not a folder";
  EXPECT_THAT(error_of([&] { write_calibration(c, folder / "file"); }), HasSubstr("file"));
  EXPECT_TRUE(fs::is_regular_file(folder / "file"));
}

}  // namespace
}  // namespace burin

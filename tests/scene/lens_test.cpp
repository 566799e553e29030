// Proves: projection and its inverse agree, gradients are those of finite differences (mrcal's own two entry points
// disagree when asked carelessly), files go both ways between us and mrcal's Python tools.
// The models that are written out are mrcal's own, with all derivatives.
#include "burin/scene/lens.h"
#include "tests/places.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/Dense>

#include <array>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <random>

#include "burin/base/error.h"
#include "burin/scene/mrcal_lens.h"
#include "tests/temporary_folder.h"

namespace burin {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::ThrowsMessage;

Lens spline_lens() {
  Lens lens{"LENSMODEL_SPLINED_STEREOGRAPHIC_order=3_Nx=11_Ny=8_fov_x_deg=100", {900, 905, 640, 480}, 1280, 960};
  std::mt19937 random(3);
  std::uniform_real_distribution<double> knot(-0.02, 0.02);
  lens.intrinsics.resize(static_cast<std::size_t>(lens_parameter_count(lens.model)));
  for (std::size_t i = 4; i < lens.intrinsics.size(); ++i) lens.intrinsics[i] = knot(random);
  return lens;
}

std::vector<Lens> lenses() {
  return {{"LENSMODEL_PINHOLE", {1000, 1010, 640, 480}, 1280, 960},
          {"LENSMODEL_OPENCV4", {1000, 1010, 640, 480, -0.12, 0.03, 1e-3, -2e-3}, 1280, 960},
          {"LENSMODEL_OPENCV5", {1000, 1010, 640, 480, -0.12, 0.03, 1e-3, -2e-3, 0.01}, 1280, 960},
          {"LENSMODEL_OPENCV8", {1000, 1010, 640, 480, -0.12, 0.03, 1e-3, -2e-3, 0.01, 0.02, -0.01, 0.004}, 1280, 960},
          spline_lens()};
}

std::vector<Eigen::Vector3d> points(int count) {
  std::mt19937 random(7);
  std::uniform_real_distribution<double> lateral(-0.45, 0.45), depth(300, 1500);
  std::vector<Eigen::Vector3d> p;
  for (int i = 0; i < count; ++i) {
    const double z = depth(random);
    p.emplace_back(lateral(random) * z, lateral(random) * z, z);
  }
  return p;
}

TEST(Lens, PinholeIsItsFormula) {
  const Lens lens = lenses()[0];
  const auto p = points(50);
  std::vector<Eigen::Vector2d> q(p.size());
  project(lens, p, q);
  for (std::size_t i = 0; i < p.size(); ++i) {
    EXPECT_NEAR(q[i].x(), 1000 * p[i].x() / p[i].z() + 640, 1e-10);
    EXPECT_NEAR(q[i].y(), 1010 * p[i].y() / p[i].z() + 480, 1e-10);
  }
}

// What mrcal returns, and rounding, of numbers up to `largest`.
void expect_as_mrcal(double ours, double mrcals, double largest) { EXPECT_NEAR(ours, mrcals, 1e-12 * (1 + largest)); }

TEST(Lens, WrittenOutModelsAreMrcals) {
  std::mt19937 random(11);
  std::uniform_real_distribution<double> small(-0.05, 0.05);
  const auto p = points(200);
  for (const int distortions : {0, 4, 5, 8, 12}) {
    Lens lens{distortions > 0 ? "LENSMODEL_OPENCV" + std::to_string(distortions) : "LENSMODEL_PINHOLE",
              {1000, 1010, 640, 480},
              1280,
              960};
    for (int i = 0; i < distortions; ++i) lens.intrinsics.push_back(small(random));
    std::vector<Eigen::Vector2d> q(p.size()), q_mrcal(p.size());
    std::vector<PixelByPoint> by_point, by_point_mrcal(p.size());
    std::vector<double> by_lens, by_lens_mrcal(2 * p.size() * lens.intrinsics.size());
    project(lens, p, q, &by_point, &by_lens);
    try {
      mrcal_project(lens.model, lens.intrinsics, p, q_mrcal, &by_point_mrcal, &by_lens_mrcal);
    } catch (const Error& error) {
      GTEST_SKIP() << error.what();
    }
    for (std::size_t i = 0; i < p.size(); ++i) {
      expect_as_mrcal((q[i] - q_mrcal[i]).norm(), 0, q[i].norm());
      expect_as_mrcal((by_point[i] - by_point_mrcal[i]).norm(), 0, by_point[i].norm());
    }
    for (std::size_t i = 0; i < by_lens.size(); ++i)
      expect_as_mrcal(by_lens[i], by_lens_mrcal[i], std::abs(by_lens[i]));

    std::vector<Eigen::Vector3d> v(q.size());
    unproject(lens, q, v);
    for (std::size_t i = 0; i < p.size(); ++i) EXPECT_LT((v[i] - p[i].normalized()).norm(), 1e-12) << lens.model;
  }
}

TEST(Lens, ProjectionOfTheInverseIsThePixel) {
  for (const Lens& lens : lenses()) {
    std::vector<Eigen::Vector2d> q;
    for (int y = 0; y < lens.height; y += 60)
      for (int x = 0; x < lens.width; x += 60) q.emplace_back(x + 0.25, y - 0.125);
    std::vector<Eigen::Vector3d> v(q.size());
    unproject(lens, q, v);
    std::vector<Eigen::Vector2d> back(q.size());
    project(lens, v, back);
    for (std::size_t i = 0; i < q.size(); ++i) {
      EXPECT_NEAR(v[i].norm(), 1, 1e-12);
      EXPECT_GT(v[i].z(), 0);
      EXPECT_LT((back[i] - q[i]).norm(), 1e-6) << lens.model;
    }
  }
}

TEST(Lens, PixelsThatTheModelCannotReachAreNotNumbers) {
  // Barrel distortion folds back: beyond its turning point no direction reaches a pixel.
  const Lens lens{"LENSMODEL_OPENCV4", {1000, 1000, 640, 480, -0.5, 0, 0, 0}, 1280, 960};
  const std::vector<Eigen::Vector2d> q{{640, 480}, {6000, 480}};
  std::vector<Eigen::Vector3d> v(2);
  unproject(lens, q, v);
  EXPECT_TRUE(v[0].allFinite());
  EXPECT_FALSE(v[1].allFinite());
}

TEST(Lens, GradientsAreFiniteDifferences) {
  const auto p = points(40);
  for (const Lens& lens : lenses()) {
    const std::size_t n = p.size(), k = lens.intrinsics.size();
    std::vector<Eigen::Vector2d> q(n), plus(n), minus(n);
    std::vector<PixelByPoint> dq_dp, dq_dp_alone;
    std::vector<double> dq_di, dq_di_alone;
    project(lens, p, q, &dq_dp, &dq_di);
    project(lens, p, q, &dq_dp_alone);
    project(lens, p, q, nullptr, &dq_di_alone);
    // Central differences: step 1e-3 mm at some 100 mm, pixels known to 1e-12 of 1e3 give 1e-6 of the derivative's
    // scale.
    for (int c = 0; c < 3; ++c) {
      auto moved = p;
      for (auto& x : moved) x[c] += 1e-3;
      project(lens, moved, plus);
      for (auto& x : moved) x[c] -= 2e-3;
      project(lens, moved, minus);
      for (std::size_t i = 0; i < n; ++i) {
        const Eigen::Vector2d numeric = (plus[i] - minus[i]) / 2e-3;
        EXPECT_LT((dq_dp[i].col(c) - numeric).norm(), 1e-6 * (1 + dq_dp[i].norm())) << lens.model;
        EXPECT_EQ(dq_dp[i], dq_dp_alone[i]) << lens.model;
      }
    }
    for (std::size_t j = 0; j < k; ++j) {
      Lens moved = lens;
      const double step = 1e-6 * std::max(1.0, std::abs(lens.intrinsics[j]));
      moved.intrinsics[j] = lens.intrinsics[j] + step;
      project(moved, p, plus);
      moved.intrinsics[j] = lens.intrinsics[j] - step;
      project(moved, p, minus);
      for (std::size_t i = 0; i < n; ++i) {
        const Eigen::Vector2d numeric = (plus[i] - minus[i]) / (2 * step);
        const Eigen::Vector2d given(dq_di[(2 * i) * k + j], dq_di[(2 * i + 1) * k + j]);
        EXPECT_LT((given - numeric).norm(), 1e-5 * (1 + given.norm())) << lens.model << " intrinsic " << j;
      }
    }
    EXPECT_EQ(dq_di, dq_di_alone);
  }
}

TEST(Lens, ModelsThatCannotBeUsedAreNamed) {
  EXPECT_EQ(lens_parameter_count("LENSMODEL_OPENCV8"), 12);
  EXPECT_EQ(lens_parameter_count("LENSMODEL_SPLINED_STEREOGRAPHIC_order=3_Nx=16_Ny=11_fov_x_deg=120"), 4 + 2 * 16 * 11);
  EXPECT_THAT([] { lens_parameter_count("LENSMODEL_FISHEYE"); },
              ThrowsMessage<Error>(AllOf(HasSubstr("LENSMODEL_FISHEYE"), HasSubstr("LENSMODEL_OPENCV8"))));
  EXPECT_THROW(lens_parameter_count("LENSMODEL_SPLINED_STEREOGRAPHIC"), Error);
  EXPECT_THROW(lens_parameter_count("LENSMODEL_SPLINED_STEREOGRAPHIC_order=9_Nx=16_Ny=11_fov_x_deg=120"), Error);
  EXPECT_THROW(lens_parameter_count("LENSMODEL_CAHVORE_linearity=0.5"), Error);
  Lens lens = lenses()[1];
  lens.intrinsics.pop_back();
  const auto p = points(1);
  std::vector<Eigen::Vector2d> q(1);
  EXPECT_THAT([&] { project(lens, p, q); }, ThrowsMessage<Error>(AllOf(HasSubstr("7 intrinsics"), HasSubstr("8"))));
  lens.intrinsics.push_back(std::nan(""));
  EXPECT_THROW(project(lens, p, q), Error);
}

TEST(CameraModel, RoundTripToTheLastBit) {
  const TemporaryFolder folder;
  for (Lens lens : lenses()) {
    lens.intrinsics[0] = 1000.0 / 3;
    write_cameramodel(lens, folder / "x.cameramodel");
    const Lens back = read_cameramodel(folder / "x.cameramodel");
    EXPECT_EQ(back.model, lens.model);
    EXPECT_EQ(back.intrinsics, lens.intrinsics);
    EXPECT_EQ(back.width, lens.width);
    EXPECT_EQ(back.height, lens.height);
  }
}

TEST(CameraModel, BrokenFilesAreNamed) {
  const TemporaryFolder folder;
  EXPECT_THAT([&] { read_cameramodel(folder / "none.cameramodel"); },
              ThrowsMessage<Error>(AllOf(HasSubstr("none.cameramodel"), HasSubstr("does not exist"))));
  const std::string head = "{'lensmodel': 'LENSMODEL_PINHOLE', 'extrinsics': [0,0,0,0,0,0], ";
  for (const std::string& text :
       {std::string(), std::string("\x89PNG\r\n"), head, head + "'intrinsics': [1, 2, 3], 'imagersize': [10, 10]}",
        head + "'intrinsics': [1, 2, 3, nan], 'imagersize': [10, 10]}", head + "'intrinsics': [1, 2, 3, 4]}",
        head + "'intrinsics': [1, 2, 3, 4], 'imagersize': [0, 10]}",
        head + "'intrinsics': [1, 2, 3, 4], 'imagersize': [10.5, 10]}", head + "'intrinsics': [1, 2, 3, 4], 'imagers",
        head + "'intrinsics': [-1, 2, 3, 4], 'imagersize': [10, 10]}"}) {
    const auto file = folder.write("x.cameramodel", text);
    EXPECT_THAT([&] { read_cameramodel(file); }, ThrowsMessage<Error>(HasSubstr("x.cameramodel"))) << text;
  }
  Lens lens = lenses()[0];
  lens.width = 0;
  EXPECT_THROW(write_cameramodel(lens, folder / "y.cameramodel"), Error);
  EXPECT_FALSE(std::filesystem::exists(folder / "y.cameramodel"));
}

TEST(CameraModel, PublishedCalibrationsAreRead) {
  const std::filesystem::path folder = std::filesystem::path(places::data()) / "photos/mrcal_docs";
  const Lens opencv = read_cameramodel(folder / "opencv8-0.cameramodel");
  EXPECT_EQ(opencv.model, "LENSMODEL_OPENCV8");
  EXPECT_EQ(opencv.intrinsics.front(), 2073.872915);
  EXPECT_EQ(opencv.intrinsics.back(), 0.001407513313);
  EXPECT_EQ(opencv.width, 6016);
  const Lens splined = read_cameramodel(folder / "splined-0.cameramodel");
  EXPECT_EQ(splined.model, "LENSMODEL_SPLINED_STEREOGRAPHIC_order=3_Nx=30_Ny=20_fov_x_deg=170");
  EXPECT_EQ(splined.intrinsics.size(), 1204u);
  // Two models of one real lens, each in a frame of its own: the angles between pixels' rays agree.
  const std::vector<Eigen::Vector2d> q{{3000, 2000}, {2000, 1500}, {4000, 2500}, {1500, 3000}};
  std::vector<Eigen::Vector3d> a(4), b(4);
  unproject(opencv, q, a);
  unproject(splined, q, b);
  for (int i = 0; i < 4; ++i)
    for (int k = 0; k < i; ++k)
      EXPECT_NEAR(std::acos(a[i].dot(a[k])), std::acos(b[i].dot(b[k])), 1e-3) << i << " " << k;  // 2 px of 2000
}

TEST(CameraModel, MrcalsPythonOpensOurFilesAndProjectsAlike) {
  const std::string python = "/usr/bin/python3";  // Debian's, the one that python3-mrcal is installed for
  if (std::system((python + " -c 'import mrcal' 2>/dev/null").c_str()) != 0)
    GTEST_SKIP() << "python3-mrcal is not installed";
  const TemporaryFolder folder;
  for (const Lens& lens : lenses()) {
    write_cameramodel(lens, folder / "x.cameramodel");
    const std::string command = python + " -c \"import mrcal, numpy; m = mrcal.cameramodel('" +
                                (folder / "x.cameramodel").string() +
                                "'); q = mrcal.project(numpy.array((50., -80., 700.)), *m.intrinsics()); "
                                "print(m.imagersize()[0], m.imagersize()[1], repr(float(q[0])), repr(float(q[1])))\"";
    FILE* pipe = ::popen(command.c_str(), "r");
    ASSERT_NE(pipe, nullptr);
    int width = 0, height = 0;
    double u = 0, v = 0;
    const int found = std::fscanf(pipe, "%d %d %lf %lf", &width, &height, &u, &v);
    ASSERT_EQ(::pclose(pipe), 0);
    ASSERT_EQ(found, 4);
    EXPECT_EQ(width, lens.width);
    EXPECT_EQ(height, lens.height);
    const std::vector<Eigen::Vector3d> p{{50, -80, 700}};
    std::vector<Eigen::Vector2d> q(1);
    project(lens, p, q);
    EXPECT_NEAR(q[0].x(), u, 1e-9);
    EXPECT_NEAR(q[0].y(), v, 1e-9);
  }
}

}  // namespace
}  // namespace burin

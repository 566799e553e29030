// Proves: the simulated camera takes the photos that docs/model.md 5 asks for: exact values of paper, plain face and
// cloth worked by hand; a groove's light against direct quadrature of docs/model.md 5 over the groove's area; the
// benches beside the checkout down to their noise; noise of the sensor asked for; the same bits for any threads and any
// choice of views. Does not prove that dust, cloth patterns and fingerprints look like real ones.
#include "burin/simulate/simulated_camera.h"
#include "tests/places.h"

#include <gmock/gmock.h>
#include <tbb/global_control.h>

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <cstring>
#include <fstream>
#include <map>
#include <numbers>

#include "burin/base/error.h"
#include "burin/capture/photo.h"
#include "burin/render/brdf.h"
#include "burin/scene/groove.h"
#include "burin/simulate/point_sampler.h"
#include "tests/capture/small_truth.h"

namespace burin {
namespace {

namespace fs = std::filesystem;
using Eigen::Vector3d;
using testing::AllOf;
using testing::HasSubstr;

struct SimulatedCamera : testing::Test {
  TemporaryFolder folder;
  Json json = small_truth();

  BenchTruth truth() const { return read_bench_truth(write_truth(folder, json)); }

  Image radiance(const BenchTruth& t, const Scratches& designed) const {
    const PointSampler sampler(t, carved_by(t, Sent(designed)));
    return sampler.radiance(t.views[0], t.lights[0]);
  }

  std::string error_of(const SimulateOptions& options = {}) const {
    try {
      simulate(write_truth(folder, json), folder / "out", options);
    } catch (const Error& error) {
      return error.what();
    }
    return "no error";
  }

  std::string bytes(const fs::path& file) const {
    std::ifstream in(file, std::ios::binary);
    return {std::istreambuf_iterator<char>(in), {}};
  }
};

// Board point of a pixel of small_truth's camera: 0.5 mm a pixel, y turned round.
Vector3d point_of(double x_px, double y_px) { return {50 + (x_px - 159.5) / 2, 40 - (y_px - 119.5) / 2, 0}; }

TEST_F(SimulatedCamera, PaperFaceAndClothHaveTheirExactRadiance) {
  json["ambient"] = {0.01, 0.01, 0.01};
  const BenchTruth t = truth();
  const Image image = radiance(t, {});
  const Vector3d lamp(250, 40, 500), camera(50, 40, 400);
  const auto expect = [&](int x, int y, double z, const char* what, auto value) {
    Vector3d p = point_of(x, y);
    if (z != 0) p.head<2>() = camera.head<2>() + (p - camera).head<2>() * (400 - z) / 400;
    p.z() = z;
    const double expected =
        value(p, (lamp - p).normalized(), (camera - p).normalized(), 1e5 / (lamp - p).squaredNorm());
    EXPECT_NEAR(image.at(x, y, 1), expected, 2e-4 * expected) << what;
  };
  const auto lambert = [](double albedo) {
    return [albedo](const Vector3d&, const Vector3d& wi, const Vector3d&, double irradiance) {
      return albedo / std::numbers::pi * wi.z() * irradiance + 0.01 * albedo;
    };
  };
  // Tag 3 is centerd at (15, 15), 16 mm over 8 cells: 2 mm of white border, 1 mm of quiet paper, then metal.
  const auto pixel_x = [](double x_mm) { return static_cast<int>(std::lround(159.5 + 2 * (x_mm - 50))); };
  const auto pixel_y = [](double y_mm) { return static_cast<int>(std::lround(119.5 - 2 * (y_mm - 40))); };
  expect(pixel_x(5.5), pixel_y(15), 0, "quiet paper", lambert(0.8));
  expect(pixel_x(8), pixel_y(15), 0, "the tag's black border", lambert(0.04));
  expect(4, 4, -5, "cloth", lambert(0.05));
  const auto face = [](const Vector3d&, const Vector3d& wi, const Vector3d& wo, double irradiance) {
    const Vector3d h = (wi + wo).normalized();
    return ggx_D(h.z(), 0.2) * smith_G(wi.z(), wo.z(), 0.2) * schlick_F(h.dot(wo), 0.9) / (4 * wo.z()) * irradiance +
           0.01 * 0.9;
  };
  expect(pixel_x(50), pixel_y(40), 0, "plain face", face);
  expect(pixel_x(90), pixel_y(40), 0, "plain face", face);
}

// All tags stand as a person would stick them: found by looking at cells of AprilTag's own picture of tag 3.
TEST_F(SimulatedCamera, RotationTurnsTagsCounterClockwise) {
  const auto tag_cells = [&](double rotation_deg) {
    json["board"]["tags"]["list"][0]["rotation_deg"] = rotation_deg;
    const Image image = radiance(truth(), {});
    std::array<bool, 100> black{};
    for (int row = 0; row < 10; ++row)
      for (int column = 0; column < 10; ++column) {
        const double x_mm = 15 + 2 * (column - 4.5), y_mm = 15 + 2 * (4.5 - row);
        black[row * 10 + column] = image.at(static_cast<int>(std::lround(159.5 + 2 * (x_mm - 50))),
                                            static_cast<int>(std::lround(119.5 - 2 * (y_mm - 40)))) < 0.02;
      }
    return black;
  };
  const auto upright = tag_cells(0), turned = tag_cells(90);
  EXPECT_NE(upright, turned);
  for (int row = 0; row < 10; ++row)
    for (int column = 0; column < 10; ++column)
      EXPECT_EQ(turned[(9 - column) * 10 + row], upright[row * 10 + column]) << row << " " << column;
}

// One groove across a few pixels: light summed over the picture against quadrature of docs/model.md 2, 3 and 5 along
// its width and length, which knows nothing of pixels, samples or interpolation.
TEST_F(SimulatedCamera, AGroovesLightIsItsIntegral) {
  json["samples"] = 40000;
  json["machine"] = {{"affine", {{1, 0, 0}, {0, 1, 0}}}};
  const BenchTruth t = truth();
  Scratches one;
  one.x0_mm = {47.3};
  one.y0_mm = {36.1};
  one.x1_mm = {49.1};
  one.y1_mm = {42.7};
  const Image with = radiance(t, one), without = radiance(t, {});
  double sum = 0;  // of radiance over the board's area
  for (std::size_t i = 0; i < with.data.size(); i += 3) sum += (with.data[i] - without.data[i]) * 0.25;

  const Vector3d lamp(250, 40, 500), camera(50, 40, 400), p0(47.3, 36.1, 0), p1(49.1, 42.7, 0);
  const double length = (p1 - p0).norm(), w = 1e-3 * half_width_um(400.0, 14.0);
  const Vector3d along = (p1 - p0) / length, across(along.y(), -along.x(), 0), z(0, 0, 1);
  double expected = 0;
  constexpr int kAcross = 4000, kAlong = 40;
  for (int j = 0; j < kAlong; ++j)
    for (int i = 0; i < kAcross; ++i) {
      const double x = w * (2 * (i + 0.5) / kAcross - 1);
      const Vector3d p = p0 + along * (length * (j + 0.5) / kAlong) + across * x;
      const Vector3d wi = (lamp - p).normalized(), wo = (camera - p).normalized(), h = (wi + wo).normalized();
      // The slope of Eqn. 2's height, by its derivative.
      const double u = 2 * x / 0.4, slope = 2 * u / (1 - u * u);
      const Vector3d n = (z - slope * across).normalized();
      const double F = schlick_F(h.dot(wo), 0.9) / (4 * wo.z()) * 1e5 / (lamp - p).squaredNorm();
      expected += F * (ggx_D(n.dot(h), 0.08) * smith_G(wi.z(), wo.z(), 0.08) -
                       ggx_D(h.z(), 0.2) * smith_G(wi.z(), wo.z(), 0.2));
    }
  expected *= 2 * w / kAcross * length / kAlong;
  EXPECT_NEAR(sum, expected, 3e-3 * std::abs(expected));
}

TEST_F(SimulatedCamera, GroovesThatCrossAddOrTheLastRules) {
  Scratches two;
  two.x0_mm = {50, 45};  // the first glints, the second lies along the half vector's lean and does not
  two.y0_mm = {35, 40};
  two.x1_mm = {50.001, 55};
  two.y1_mm = {45, 40};
  json["samples"] = 4096;
  const auto light = [&](const char* overlap, int from, int count) {
    json["overlap"] = overlap;
    Scratches part;
    for (int i = from; i < from + count; ++i) {
      part.x0_mm.push_back(two.x0_mm[i]);
      part.y0_mm.push_back(two.y0_mm[i]);
      part.x1_mm.push_back(two.x1_mm[i]);
      part.y1_mm.push_back(two.y1_mm[i]);
    }
    const Image image = radiance(truth(), part);
    double sum = 0;
    for (const float v : image.data) sum += v;
    return sum;
  };
  const double none = light("sum", 0, 0), first = light("sum", 0, 1), second = light("sum", 1, 1);
  const double sum = light("sum", 0, 2), last = light("last", 0, 2);
  EXPECT_NEAR(sum - none, first - none + second - none, 0.01 * std::abs(first - none));
  // Where they cross, the later one takes the earlier one's light away.
  EXPECT_LT(last - none, 0.995 * (sum - none));
}

TEST_F(SimulatedCamera, NoiseClippingAndRounding) {
  const BenchTruth t = truth();
  Image flat(200, 200, 3, 1);
  Photo photo = t.views[0].photos[0].photo;
  const double scale = t.optics.gain * exposure_factor(photo);
  for (const double level : {0.01, 0.3, 0.9}) {
    for (float& v : flat.data) v = static_cast<float>(level / scale);
    EXPECT_NEAR(exposed(t, flat, photo, std::nullopt).at(3, 4), level, 1e-5);
    const Image noisy = exposed(t, flat, photo, 5);
    double sum = 0, sum2 = 0;
    for (const float v : noisy.data) {
      sum += v;
      sum2 += v * v;
    }
    const double n = static_cast<double>(noisy.data.size()), mean = sum / n, variance = sum2 / n - mean * mean;
    const double expected = level / 20000 + 25.0 / 20000 / 20000;
    EXPECT_NEAR(mean, level, 5 * std::sqrt(expected / n));
    EXPECT_NEAR(variance, expected, 5 * expected * std::sqrt(2 / n));
  }
  for (float& v : flat.data) v = static_cast<float>(3 / scale);
  EXPECT_EQ(exposed(t, flat, photo, 5).at(9, 9), 1);
  photo.iso = 400;  // a quarter of the electrons, four times the value
  for (float& v : flat.data) v = static_cast<float>(0.1 / scale);
  EXPECT_NEAR(exposed(t, flat, photo, std::nullopt).at(3, 4), 0.4, 1e-5);
}

TEST_F(SimulatedCamera, WritesASessionThatReplays) {
  const fs::path out = folder / "out";
  simulate(write_truth(folder, json), out);
  const Session session = read_session(out / "session.json");
  ASSERT_EQ(session.photos.size(), 1U);
  EXPECT_EQ(session.photos[0].exposure_s, 0.01);
  const Board board = read_board(session.board);
  EXPECT_EQ(board.tags.list.size(), 4U);
  EXPECT_EQ(read_scratches(out / "scratches.csv").size(), 60U);
  EXPECT_EQ(read_scratches(out / "carved.csv").depth_um.size(), 60U);
  const LinearPhoto photo = read_photo(session.photos[0]);
  EXPECT_NEAR(photo.stored.step, 1.0 / 4095, 1e-12) << "12 bits in the high end of 16";
}

TEST_F(SimulatedCamera, SameBitsForAnyThreadsAndAnyViews) {
  Json second = json["views"][0];
  second["view"] = "v01";
  second["photos"][0]["file"] = "photos/v01.png";
  json["views"].push_back(second);
  const fs::path file = write_truth(folder, json);
  {
    const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, 1);
    simulate(file, folder / "one");
  }
  {
    const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, 4);
    simulate(file, folder / "four");
  }
  SimulateOptions options;
  options.views = {"v01"};
  simulate(file, folder / "part", options);
  const std::string v01 = bytes(folder / "one/photos/v01.png");
  ASSERT_FALSE(v01.empty());
  EXPECT_TRUE(v01 == bytes(folder / "four/photos/v01.png"));
  EXPECT_TRUE(v01 == bytes(folder / "part/photos/v01.png"));
  EXPECT_FALSE(fs::exists(folder / "part/photos/v00.png"));
  EXPECT_FALSE(v01 == bytes(folder / "one/photos/v00.png")) << "views must not share their noise";
}

TEST_F(SimulatedCamera, CarvesTheDesignItIsGiven) {
  folder.write("design.csv", "x0_mm,y0_mm,x1_mm,y1_mm\n40,30,50,35\n");
  json["machine"] = {{"affine", {{1.01, 0, 0.5}, {0, 0.99, -0.2}}}};
  json["material"]["depth_gradient"] = {0.1, 0};
  SimulateOptions options;
  options.scratches = folder / "design.csv";
  simulate(write_truth(folder, json), folder / "out", options);
  const Scratches carved = read_scratches(folder / "out/carved.csv");
  ASSERT_EQ(carved.size(), 1U);
  EXPECT_NEAR(carved.x0_mm[0], 40.9, 1e-5);
  EXPECT_NEAR(carved.y1_mm[0], 34.45, 1e-5);
  const double u = (carved.x0_mm[0] + carved.x1_mm[0]) / 200;
  EXPECT_NEAR(carved.depth_um[0], 14 * (1 + 0.1 * (u - 0.5)), 1e-3);
}

TEST_F(SimulatedCamera, ErrorsNameFieldAndRemedy) {
  const Json good = json;
  EXPECT_THAT(error_of({.scratches = {}, .views = {"v09"}, .samples = {}}), AllOf(HasSubstr("v09"), HasSubstr("v00")));
  json["lamp"] = 1;
  EXPECT_THAT(error_of(), AllOf(HasSubstr("truth.json"), HasSubstr("lamp")));
  json = good;
  json["board"]["tags"]["family"] = "tag99";
  EXPECT_THAT(error_of(), AllOf(HasSubstr("tag99"), HasSubstr("tag36h11")));
  json = good;
  json["board"]["tags"]["list"][0]["id"] = 587;
  EXPECT_THAT(error_of(), AllOf(HasSubstr("587"), HasSubstr("586")));
  json = good;
  json["views"][0]["photos"][0]["file"] = "../v00.png";
  EXPECT_THAT(error_of(), HasSubstr("out of the output folder"));
  json = good;
  json["views"][0]["photos"][0]["light"] = "sun";
  EXPECT_THAT(error_of(), HasSubstr("sun"));
  json = good;
  json["views"][0]["photos"][0]["file"] = "photos/v00.jpg";
  EXPECT_THAT(error_of(), HasSubstr("JPEG"));
  json = good;
  json["scratches"]["random"]["length_mm"] = {90, 95};
  EXPECT_THAT(error_of(), HasSubstr("length_mm"));
  json = good;
  fs::remove_all(folder / "out");
  folder.write("out", "a file where the folder should be");
  EXPECT_THAT(error_of(), HasSubstr("out"));
}

TEST_F(SimulatedCamera, NothingOldVouchesForNewPhotos) {
  const fs::path out = folder / "out";
  simulate(write_truth(folder, json), out);
  std::map<fs::path, std::string> before;
  for (const auto& entry : fs::recursive_directory_iterator(out))
    if (entry.is_regular_file()) before[entry.path()] = file_text(entry.path());
  ASSERT_TRUE(before.contains(out / "session.json"));
  json["seed"] = 4;  // other photos, of which none takes its place before all are there
  const auto stop = [](std::string_view, double share) {
    if (share > 0.5) throw Error("stopped");
  };
  EXPECT_THROW(simulate(write_truth(folder, json), out, {}, stop), Error);
  std::map<fs::path, std::string> after;
  for (const auto& entry : fs::recursive_directory_iterator(out))
    if (entry.is_regular_file()) after[entry.path()] = file_text(entry.path());
  EXPECT_TRUE(after == before);
}

TEST_F(SimulatedCamera, StandsWhereAPersonSays) {
  // The same pose and the same lens, said in words.
  const BenchTruth by_matrix = truth();
  json["views"][0].erase("T_camera_board");
  json["views"][0]["eye_mm"] = {50, 40, 400};
  json["camera"] = {{"focal_35mm", 800 * std::hypot(36.0, 24.0) / 400}, {"pixels", {320, 240}}};
  const BenchTruth in_words = truth();
  EXPECT_LT((in_words.views[0].T_camera_board.matrix() - by_matrix.views[0].T_camera_board.matrix()).norm(), 1e-9);
  for (std::size_t k = 0; k < 4; ++k) EXPECT_NEAR(in_words.lens.intrinsics[k], by_matrix.lens.intrinsics[k], 1e-9);
  json["views"][0]["T_camera_board"] = {{1, 0, 0, -50}, {0, -1, 0, 40}, {0, 0, -1, 400}, {0, 0, 0, 1}};
  EXPECT_THAT([&] { truth(); }, testing::ThrowsMessage<Error>(HasSubstr("keep one")));
}

// A photo of rig a again, from its truth and what its machine carved. What is left must be the sensor's noise and the
// noise of two samplings: theirs, and ours, which a second run with another seed measures. Cloth is left out: its
// pattern is not ours. So are values above 0.9: choosing by the other photo's clipping would choose by its noise.
TEST(SimulatedCameraOfRigs, TakesRigAsPhotoAgain) {
  const fs::path rig = places::rig("a");
  if (!fs::exists(rig / "truth.json")) GTEST_SKIP() << "needs the photographed bench " << rig;
  BenchTruth truth = read_bench_truth(rig / "truth.json");
  const TruthView& view = truth.views[2];
  const PointSampler sampler(truth, in_metal(read_scratches(rig / "carved.csv")));
  const auto seen = [&] { return blurred(sampler.radiance(view, truth.lights[0]), truth.optics.psf_sigma_px); };
  const Image radiance = seen();
  ++truth.seed;
  const Image again = seen();

  // Pixels on the board, by projecting a fine grid of its points.
  std::vector<std::uint8_t> on_board(static_cast<std::size_t>(radiance.width) * radiance.height, 0);
  std::vector<Vector3d> points;
  for (double y = 1; y < 299; y += 0.2)
    for (double x = 1; x < 299; x += 0.2) points.push_back(view.T_camera_board * Vector3d(x, y, 0));
  std::vector<Eigen::Vector2d> q(points.size());
  project(truth.lens, points, q);
  for (const auto& p : q) {
    const int x = static_cast<int>(std::lround(p.x())), y = static_cast<int>(std::lround(p.y()));
    if (x >= 0 && y >= 0 && x < radiance.width && y < radiance.height)
      on_board[static_cast<std::size_t>(y) * radiance.width + x] = 1;
  }

  for (const TruthPhoto& photo : view.photos) {
    const Image ours = exposed(truth, radiance, photo.photo, std::nullopt);
    const Image twin = exposed(truth, again, photo.photo, std::nullopt);
    Photo stored = photo.photo;
    stored.file = rig / photo.file;
    const LinearPhoto theirs = read_photo(stored);
    const NoiseModel noise{1.0 / 18000, std::pow(9.0 / 18000, 2), 1.0 / 12};
    double all = 0, expected = 0, smooth = 0, sum_ours = 0, sum_theirs = 0;
    std::size_t n = 0, n_smooth = 0;
    for (std::size_t i = 0; i < ours.data.size(); ++i) {
      if (!on_board[i] || twin.data[i] > 0.9F) continue;  // by the twin: its noise is neither photo's
      const double variance = noise.variance(ours.data[i], theirs.stored);
      const double z2 = std::pow(theirs.value.data[i] - ours.data[i], 2) / variance;
      const double sampling = std::pow(twin.data[i] - ours.data[i], 2) / variance;  // twice one sampling's variance
      all += z2;
      expected += 1 + sampling;
      if (sampling < 1e-4) {
        smooth += z2;
        ++n_smooth;
      }
      sum_ours += ours.data[i];
      sum_theirs += theirs.value.data[i];
      ++n;
    }
    ASSERT_GT(n_smooth, 20000U) << photo.file;
    // Paper and plain face: the sensor's noise alone. Its chi-square is known to sqrt(2 / n), 1 %.
    EXPECT_NEAR(smooth / static_cast<double>(n_smooth), 1, 0.04) << photo.file;
    EXPECT_NEAR(all / expected, 1, 0.1) << photo.file << ": mean z2 " << all / static_cast<double>(n);
    EXPECT_NEAR(sum_ours / sum_theirs, 1, 1e-4) << photo.file;
  }
}

}  // namespace
}  // namespace burin

// The renderer predicts photographs that it did not make: those of tests/data/rigs (and, where they are, the full-sized
// rigs), which were rendered by brute-force sampling of grooves, from the rig's truth as input. What is left between
// photo and prediction must be the sensor's own noise (Poisson electrons, read noise, 12-bit steps) and the sampling
// noise of the rig, wherever the photo is not clipped. It proves groove, integral, BRDF, pairs and camera together. It
// proves nothing about fitting: truth is given.
#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <set>

#include "burin/base/image.h"
#include "burin/pictures/picture.h"
#include "burin/render/fast/pairs.h"
#include "burin/render/view_renderer.h"
#include "tests/places.h"

namespace burin {
namespace {

namespace fs = std::filesystem;

nlohmann::json read(const fs::path& file) { return nlohmann::json::parse(std::ifstream(file)); }

double number(const nlohmann::json& j) { return j.get<double>(); }
Eigen::Vector3d vec3(const nlohmann::json& j) { return {number(j[0]), number(j[1]), number(j[2])}; }

struct Rig {
  nlohmann::json truth;
  Board board;
  Bench bench;
  Scratches scratches;
};

Rig load_rig(const fs::path& folder) {
  Rig rig;
  rig.truth = read(folder / "truth.json");
  const auto& t = rig.truth;
  rig.board.size_mm = {number(t["board"]["size_mm"][0]), number(t["board"]["size_mm"][1])};
  rig.board.tool_width_um = t["board"]["tool"]["width_um"];
  rig.bench.bow_mm = vec3(t["board"]["bow_mm"]);
  rig.bench.lens.model = t["camera"]["lensmodel"];
  rig.bench.lens.intrinsics = t["camera"]["intrinsics"].get<std::vector<double>>();
  rig.bench.lens.width = t["camera"]["imagersize"][0];
  rig.bench.lens.height = t["camera"]["imagersize"][1];
  rig.bench.material.alpha = t["material"]["alpha"];
  rig.bench.material.depth_um = t["material"]["depth_um"];
  rig.bench.material.base_alpha = t["material"]["base_alpha"];
  rig.bench.material.f0 = vec3(t["material"]["f0"]);
  rig.bench.ambient = vec3(t["ambient"]);
  rig.scratches = read_scratches(folder / "carved.csv");
  return rig;
}

Light lamp_of(const nlohmann::json& j) {
  Light light;
  light.position_mm = vec3(j["position_mm"]);
  light.intensity = vec3(j["intensity"]);
  light.falloff_exponent = j["falloff_exponent"];
  if (j.contains("axis")) light.axis = vec3(j["axis"]);
  return light;
}

Eigen::Isometry3d pose_of(const nlohmann::json& j) {
  Eigen::Isometry3d T = Eigen::Isometry3d::Identity();
  for (int r = 0; r < 3; ++r) {
    for (int c = 0; c < 3; ++c) T.linear()(r, c) = number(j[r][c]);
    T.translation()[r] = number(j[r][3]);
  }
  return T;
}

/// Gaussian blur on the pixel grid, separable.
std::vector<double> blurred_exactly(const Image& image, double sigma_px) {
  const int reach = static_cast<int>(std::ceil(5 * sigma_px));
  std::vector<double> kernel;
  double sum = 0;
  for (int i = -reach; i <= reach; ++i) kernel.push_back(std::exp(-0.5 * i * i / (sigma_px * sigma_px)));
  for (const double k : kernel) sum += k;
  const int w = image.width, h = image.height;
  std::vector<double> in(image.data.begin(), image.data.end()), out(in.size());
  for (const int pass : {0, 1}) {
    for (int y = 0; y < h; ++y) {
      for (int x = 0; x < w; ++x) {
        double v = 0;
        for (int i = -reach; i <= reach; ++i) {
          const int xx = std::clamp(pass == 0 ? x + i : x, 0, w - 1), yy = std::clamp(pass == 0 ? y : y + i, 0, h - 1);
          v += kernel[i + reach] / sum * in[static_cast<std::size_t>(yy) * w + xx];
        }
        out[static_cast<std::size_t>(y) * w + x] = v;
      }
    }
    std::swap(in, out);
  }
  return in;
}

/// Residuals of one photo over a window, in standard deviations of the sensor's noise.
struct Residuals {
  std::size_t pixels = 0;
  double mean_sigma = 0, rms_sigma = 0, rms = 0, signal = 0;
  double gain = 0;  ///< least-squares factor from prediction to photo
};

Residuals residuals_of(const Rig& rig, const nlohmann::json& photo, const fs::path& folder, const Image& radiance,
                       const PixelWindow& window, double psf_px) {
  const Image image = read_picture(folder / photo["file"].get<std::string>());
  const auto& sensor = rig.truth["sensor"];
  const double exposure = sensor["gain"].get<double>() * photo["exposure_s"].get<double>() *
                          (photo["iso"].get<double>() / 100) / std::pow(photo["f_number"].get<double>(), 2);
  const double full_well = sensor["full_well_e"].get<double>() * 100 / photo["iso"].get<double>();
  const double read_noise = sensor["read_noise_e"].get<double>() / full_well, step = 1.0 / 4095 / std::sqrt(12.0);
  const std::vector<double> predicted = blurred_exactly(radiance, psf_px);
  Residuals r;
  double xy = 0, xx = 0;
  constexpr int kEdge = 4;  // the blur reaches over the window's edge
  for (int y = kEdge; y < window.height - kEdge; ++y) {
    for (int x = kEdge; x < window.width - kEdge; ++x) {
      const double expected = exposure * predicted[static_cast<std::size_t>(y) * window.width + x];
      const double value = image.at(window.x0 + x, window.y0 + y) * (65535.0 / 65520.0);
      if (expected > 0.9 || value > 0.97 || expected < 3 * read_noise) continue;
      const double sigma = std::sqrt(expected / full_well + read_noise * read_noise + step * step);
      const double z = (value - expected) / sigma;
      ++r.pixels;
      r.mean_sigma += z;
      r.rms_sigma += z * z;
      r.rms += (value - expected) * (value - expected);
      r.signal += expected * expected;
      xy += expected * value;
      xx += expected * expected;
    }
  }
  r.mean_sigma /= r.pixels;
  r.rms_sigma = std::sqrt(r.rms_sigma / r.pixels);
  r.rms = std::sqrt(r.rms / r.pixels);
  r.signal = std::sqrt(r.signal / r.pixels);
  r.gain = xy / xx;
  return r;
}

/// Renders what each photographed place of the camera sees of the board between `low_mm` and `high_mm`, and calls
/// use(view's truth, window, scene, radiance, milliseconds that rendering took) where that is more than a few pixels.
template <typename Use>
void each_view(const Rig& rig, const Light& lamp, const Eigen::Vector2d& low_mm, const Eigen::Vector2d& high_mm,
               int channels, const Use& use) {
  for (const auto& v : rig.truth["views"]) {
    View view;
    view.T_camera_board = pose_of(v["T_camera_board"]);
    const Surface face{rig.board.size_mm, rig.bench.bow_mm};
    const PixelWindow window = window_of(rig.bench.lens, view.T_camera_board, face, low_mm, high_mm, 0);
    if (window.width < 50 || window.height < 50) continue;
    const CameraView camera = make_camera_view(rig.bench, rig.board, view, window);
    const ViewScene scene = make_scene(rig.bench, rig.board, camera, lamp);
    ViewRenderer renderer(scene, {channels});
    Image radiance;
    const auto start = std::chrono::steady_clock::now();
    renderer.forward(in_metal(rig.scratches), radiance);
    const double ms = std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start).count();
    use(v, window, scene, radiance, ms);
  }
}

TEST(RigPrediction, CleanBenchDownToTheNoise) {
  const fs::path folder = places::rig("a");
  if (!fs::exists(folder / "truth.json")) GTEST_SKIP() << "needs the photographed bench " << folder;
  const Rig rig = load_rig(folder);
  const double psf_px = rig.truth["psf_sigma_px"];
  const Light lamp = lamp_of(rig.truth["lights"][0]);
  int photos = 0;
  // Inside the ring of tags.
  each_view(
      rig, lamp, {100, 100}, {200, 200}, 1,
      [&](const nlohmann::json& v, const PixelWindow& window, const ViewScene&, const Image& radiance, double ms) {
        for (const auto& photo : v["photos"]) {
          const Residuals r = residuals_of(rig, photo, folder, radiance, window, psf_px);
          if (r.pixels < 1000) continue;
          printf(
              "%-16s %7zu px  signal %.4f  residual %.5f = %.3f sigma, mean %+.3f sigma, photo / prediction %.5f "
              " (%.0f "
              "ms)\n",
              photo["file"].get<std::string>().c_str(), r.pixels, r.signal, r.rms, r.rms_sigma, r.mean_sigma, r.gain,
              ms);
          ++photos;
          // No bias: neither in level nor in contrast. 1e-3 is what 1024 points a pixel leave over these few
          // pixels.
          EXPECT_NEAR(r.gain, 1, 1e-3);
          EXPECT_NEAR(r.mean_sigma, 0, 0.05);
          // The sensor's noise, and on top of it the rig's sampling: the glinting part of a groove is some 0.02
          // mm of a pixel's 0.35 mm, two of the 32 strata across it, which leaves up to 4 % of a pixel's light.
          EXPECT_LT(r.rms * r.rms, std::pow(r.rms / r.rms_sigma, 2) * 1.15 + std::pow(0.06 * r.signal, 2));
        }
      });
  EXPECT_GE(photos, 20);
}

/// Pixels that see one scratch and no other, their neighbors within `reach` included.
std::vector<bool> lonely_pixels(const ViewScene& scene, const Scratches& scratches, int reach) {
  const int w = scene.grid->width(), h = scene.grid->height();
  const PixelPairs pairs =
      find_pairs(PixelIndex(*scene.grid), w, h, strips_of(scratches, scene.tool_width_um, scene.material));
  std::vector<bool> lonely(static_cast<std::size_t>(w) * h, false);
  for (int y = reach; y < h - reach; ++y) {
    for (int x = reach; x < w - reach; ++x) {
      std::set<std::uint32_t> near;
      for (int yy = y - reach; yy <= y + reach && near.size() <= 1; ++yy) {
        for (int xx = x - reach; xx <= x + reach; ++xx) {
          const std::size_t i = static_cast<std::size_t>(yy) * w + xx;
          near.insert(pairs.scratch.begin() + pairs.begin[i], pairs.scratch.begin() + pairs.begin[i + 1]);
        }
      }
      lonely[static_cast<std::size_t>(y) * w + x] = near.size() == 1;
    }
  }
  return lonely;
}

// The other rig: a bowed face, a spot lamp with color, room light, vignetting, grooves of uneven depth and roughness.
// Its scratches hide each other where they cross, which is not the model here, so only pixels are compared that see a
// single scratch. 8-bit JPEG and dust: the middle half of thousands of pixels.
class AmateurBench : public testing::TestWithParam<const char*> {};
TEST_P(AmateurBench, IsPredictedInTheMiddle) {
  const fs::path folder = places::rig(GetParam());
  if (!fs::exists(folder / "truth.json")) GTEST_SKIP() << "needs the photographed bench " << folder;
  Rig rig = load_rig(folder);
  const Light lamp = lamp_of(rig.truth["lights"][0]);
  const Eigen::Vector3d vignette = vec3(rig.truth["vignette"]);
  const auto under_shape = [&](const Eigen::Vector3d& p) {
    return std::any_of(rig.truth["shapes"].begin(), rig.truth["shapes"].end(), [&](const auto& shape) {
      const Eigen::Vector2d center(number(shape["center_mm"][0]), number(shape["center_mm"][1]));
      return (p.head<2>() - center).norm() < std::max(number(shape["half_mm"][0]), number(shape["half_mm"][1])) + 2;
    });
  };
  const double W = rig.bench.lens.width, H = rig.bench.lens.height;
  int photos = 0;
  each_view(
      rig, lamp, {40, 40}, {200, 140}, 3,
      [&](const nlohmann::json& v, const PixelWindow& window, const ViewScene& scene, const Image& radiance, double) {
        const std::vector<bool> lonely = lonely_pixels(scene, rig.scratches, 2);
        std::array<std::vector<double>, 3> predicted;
        for (int c = 0; c < 3; ++c) {
          Image channel(window.width, window.height, 1);
          for (std::size_t i = 0; i < channel.data.size(); ++i) channel.data[i] = radiance.data[3 * i + c];
          predicted[c] = blurred_exactly(channel, rig.truth["psf_sigma_px"]);
        }
        for (const auto& photo : v["photos"]) {
          const Image image = read_picture(folder / photo["file"].get<std::string>());
          const double exposure = number(rig.truth["sensor"]["gain"]) * number(photo["exposure_s"]) *
                                  (number(photo["iso"]) / 100) / std::pow(number(photo["f_number"]), 2);
          std::array<std::vector<double>, 3> ratios;
          for (int y = 4; y < window.height - 4; ++y) {
            for (int x = 4; x < window.width - 4; ++x) {
              const std::size_t i = static_cast<std::size_t>(y) * window.width + x;
              if (!lonely[i] || under_shape(scene.grid->center_mm[i])) continue;
              const double px = window.x0 + x - (W - 1) / 2, py = window.y0 + y - (H - 1) / 2;
              const double r2 = (px * px + py * py) * 4 / (W * W + H * H);
              const double gain = exposure * (1 + r2 * (vignette[0] + r2 * (vignette[1] + r2 * vignette[2])));
              for (int c = 0; c < 3; ++c) {
                const double expected = gain * predicted[c][i];
                // Chosen by what is expected alone: a choice by the photo's value would bias the ratio.
                if (expected < 0.1 || expected > 0.6) continue;
                ratios[c].push_back(srgb_to_linear(image.at(window.x0 + x, window.y0 + y, c)) / expected);
              }
            }
          }
          if (std::min({ratios[0].size(), ratios[1].size(), ratios[2].size()}) < 300) continue;
          ++photos;
          std::array<double, 3> middle{};
          for (int c = 0; c < 3; ++c) {
            std::sort(ratios[c].begin(), ratios[c].end());
            const std::size_t from = ratios[c].size() / 4, to = ratios[c].size() - from;
            for (std::size_t i = from; i < to; ++i) middle[c] += ratios[c][i] / static_cast<double>(to - from);
          }
          printf("%-20s %6zu px  photo / prediction, mean of the middle half: R %.4f G %.4f B %.4f\n",
                 photo["file"].get<std::string>().c_str(), ratios[1].size(), middle[0], middle[1], middle[2]);
          // One step of 8 bits is 2.4 % of a value of 0.1; JPEG rounds color once more.
          EXPECT_NEAR(middle[1], 1, 0.012);
          EXPECT_NEAR(middle[0], 1, 0.024);
          EXPECT_NEAR(middle[2], 1, 0.024);
        }
      });
  EXPECT_GE(photos, 6);
}
INSTANTIATE_TEST_SUITE_P(RigPrediction, AmateurBench, testing::Values("b-small", "b"), places::as_test_name);

}  // namespace
}  // namespace burin

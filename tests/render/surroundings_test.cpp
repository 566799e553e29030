// The tables of surroundings against the closed form direction by direction, and their gradients against differences;
// the sun against a disk; bad pictures. docs/model.md 10.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <random>
#include <string>
#include <vector>

#include "burin/base/error.h"
#include "burin/base/simd_width.h"
#include "burin/render/surroundings/seen_sources.h"
#include "burin/render/view_renderer.h"
#include "burin/scene/far_light.h"

namespace burin {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::ThrowsMessage;

constexpr int kWidth = 14, kHeight = 11;

// A dark room: a window of two panes, of other colors, a dim ceiling above, a bright spot beside the eye.
Image room(int width) {
  Image picture(width, width / 2, 3, 0.0F);
  const auto paint = [&](double azimuth, double half, double from, double to, const Eigen::Vector3f& color) {
    for (int y = 0; y < picture.height; ++y)
      for (int x = 0; x < picture.width; ++x) {
        const double polar = 180.0 * (y + 0.5) / picture.height, at = 360.0 * (x + 0.5) / picture.width;
        if (polar < from || polar > to || std::abs(std::remainder(at - azimuth, 360)) > half) continue;
        for (int c = 0; c < 3; ++c) picture.at(x, y, c) = color[c];
      }
  };
  paint(262, 9, 40, 62, {8, 9, 12});
  paint(285, 9, 40, 62, {9, 9, 8});
  paint(90, 40, 72, 88, {0.6F, 0.5F, 0.4F});
  return picture;
}

ViewScene scene_in(const Light& light, double alpha) {
  ViewScene scene;
  const Eigen::Vector2d size(60, 48);
  scene.grid = share(
      board_grid({20, 15}, {20 + 0.23 * kWidth, 15 + 0.23 * kHeight}, kWidth, kHeight, Surface{size, {0.1, 0, -0.1}}));
  scene.camera_center_mm = {30, 140, 420};
  scene.light = light;
  scene.material.alpha = alpha;
  scene.material.depth_um = 14;
  scene.material.base_alpha = 0.15;
  scene.material.f0 = {0.91, 0.8, 0.7};
  return scene;
}

Carved some_grooves() {
  Carved carved;
  Scratches& s = carved.scratches;
  const auto add = [&](double x, double y, double degrees, double length) {
    const double a = degrees * std::numbers::pi / 180;
    s.x0_mm.push_back(x);
    s.y0_mm.push_back(y);
    s.x1_mm.push_back(x + length * std::cos(a));
    s.y1_mm.push_back(y + length * std::sin(a));
  };
  add(20.3, 15.4, 11, 2.4);
  add(20.6, 16.6, -8, 1.9);
  add(22.9, 15.5, 107, 1.7);
  add(20.4, 17.2, -24, 2.1);
  add(21.2, 15.2, 62, 2.3);
  return carved;
}

// The same room as lamps: each lit pixel cut into `cut` x `cut` directions.
template <typename Render>
Image by_directions(const Panorama& panorama, ViewScene scene, const Render& render, int cut) {
  Image sum(kWidth, kHeight, 3);
  const Image& picture = panorama.radiance;
  for (int y = 0; y < picture.height; ++y)
    for (int x = 0; x < picture.width; ++x) {
      const Eigen::Vector3d radiance(picture.at(x, y, 0), picture.at(x, y, 1), picture.at(x, y, 2));
      if (radiance.isZero(0)) continue;
      for (int j = 0; j < cut; ++j)
        for (int i = 0; i < cut; ++i) {
          const Eigen::Vector3d to = panorama.direction(x + (i + 0.5) / cut, y + (j + 0.5) / cut);
          const double polar = std::numbers::pi * (y + (j + 0.5) / cut) / picture.height;
          const double angle = std::numbers::pi / (picture.height * cut);
          Light lamp;
          lamp.position_mm = kFar_mm * to;
          lamp.intensity = radiance * (kFar_mm * kFar_mm * angle * angle * std::sin(polar));
          scene.light = lamp;
          const Image one = render(scene);
          for (std::size_t k = 0; k < sum.data.size(); ++k) sum.data[k] += one.data[k];
        }
    }
  return sum;
}

double rms(const Image& a, const Image& b) {
  double sum = 0;
  for (std::size_t i = 0; i < a.data.size(); ++i) sum += std::pow(a.data[i] - b.data[i], 2);
  return std::sqrt(sum / static_cast<double>(a.data.size()));
}

double peak(const Image& image) { return *std::max_element(image.data.begin(), image.data.end()); }

class SurroundingsAt : public testing::TestWithParam<double> {};

// The bar of a thousandth of the peak, RMS, is the one that designs rest on.
TEST_P(SurroundingsAt, TablesAreTheClosedFormDirectionByDirection) {
  const double alpha = GetParam();
  const int width = alpha < 0.04 ? 120 : 60;
  const auto panorama = make_panorama(room(width), {}, "room");
  ViewScene scene = scene_in(surroundings_light(panorama), alpha);
  const Carved carved = some_grooves();
  ViewRenderer renderer(scene, {3});
  Image tables;
  renderer.forward(carved, tables);
  const int cut = static_cast<int>(std::ceil(std::numbers::pi / panorama->radiance.height / (0.35 * alpha)));
  const Image truth = by_directions(
      *panorama, scene, [&](const ViewScene& one) { return render_brute_force(one, carved, 3); }, std::max(2, cut));
  EXPECT_GT(peak(truth), 0);
  EXPECT_LT(rms(tables, truth), 1e-3 * peak(truth)) << "alpha " << alpha;
}

INSTANTIATE_TEST_SUITE_P(Roughness, SurroundingsAt, testing::Values(0.02, 0.06, 0.2));

// Other cross-sections, whose walls lean as they do, rougher across or along, with burrs beside them: direction by
// direction as lamps light them (docs/model.md 8.6).
TEST(Surroundings, LightGroovesOfAnyCrossSection) {
  const auto panorama = make_panorama(room(60), {}, "room");
  for (const double across : {0.7, 1.43})
    for (const double burr_um : {0.0, 4.0}) {
      ViewScene scene = scene_in(surroundings_light(panorama), 0.06);
      GrooveProfile& profile = scene.material.profile;
      profile.kind = GrooveProfile::Kind::rounded_v;
      profile.flank_deg = 16;
      profile.across = across;
      profile.burr_left_um = burr_um;
      profile.burr_right_um = 0.6 * burr_um;
      profile.burr_width_um = 40;
      const Carved carved = some_grooves();
      ViewRenderer renderer(scene, {3});
      Image tables;
      renderer.forward(carved, tables);
      const Image truth = by_directions(
          *panorama, scene,
          [&](const ViewScene& one) {
            Image image;
            ViewRenderer(one, {3}).forward(carved, image);
            return image;
          },
          4);
      const std::string what = "across " + std::to_string(across) + ", burrs " + std::to_string(burr_um);
      EXPECT_GT(peak(truth), 0);
      EXPECT_LT(rms(tables, truth), 1e-3 * peak(truth)) << what;
      // The paper's grooves would be far off.
      scene.material.profile = {};
      Image paper;
      ViewRenderer(scene, {3}).forward(carved, paper);
      EXPECT_GT(rms(paper, truth), 4e-3 * peak(truth)) << what;
    }
}

// dE/d(...) of a weighted sum of the picture's pixels against differences.
void expect_gradients_to_be_differences(const GrooveProfile& profile) {
  ViewScene scene = scene_in(surroundings_light(make_panorama(room(60), {}, "room")), 0.06);
  scene.material.profile = profile;
  const Carved carved = some_grooves();
  Image weight(kWidth, kHeight, 3);
  for (std::size_t i = 0; i < weight.data.size(); ++i) weight.data[i] = static_cast<float>(std::sin(0.7 * i) + 0.4);
  ViewRenderer renderer(scene, {3});
  Image image;
  const auto loss = [&](const Carved& c) {
    renderer.forward(c, image);
    double sum = 0;
    for (std::size_t i = 0; i < image.data.size(); ++i) sum += weight.data[i] * image.data[i];
    return sum;
  };
  renderer.forward_with_jacobian(carved, image);
  const ScratchGradients g = renderer.backward(weight);
  double scale = 0;
  for (std::size_t s = 0; s < carved.scratches.size(); ++s) scale = std::max(scale, std::abs(g.y1_mm[s]));
  const auto by_difference = [&](std::vector<double> Scratches::*field, std::size_t s, double step) {
    Carved up = carved, down = carved;
    (up.scratches.*field)[s] += step;
    (down.scratches.*field)[s] -= step;
    return (loss(up) - loss(down)) / (2 * step);
  };
  for (std::size_t s = 0; s < carved.scratches.size(); ++s) {
    EXPECT_NEAR(g.x0_mm[s], by_difference(&Scratches::x0_mm, s, 2e-3), 0.01 * scale) << s;
    EXPECT_NEAR(g.y0_mm[s], by_difference(&Scratches::y0_mm, s, 2e-3), 0.01 * scale) << s;
    EXPECT_NEAR(g.x1_mm[s], by_difference(&Scratches::x1_mm, s, 2e-3), 0.01 * scale) << s;
    EXPECT_NEAR(g.y1_mm[s], by_difference(&Scratches::y1_mm, s, 2e-3), 0.01 * scale) << s;
  }
  // Numbers that scratches carry themselves.
  Carved own = carved;
  own.scratches.width_um.assign(5, 400);
  own.scratches.depth_um.assign(5, 14);
  own.scratches.alpha.assign(5, 0.06);
  renderer.forward_with_jacobian(own, image);
  const ScratchGradients m = renderer.backward(weight);
  const auto check = [&](std::vector<double> Scratches::*field, const std::vector<double>& got, double step) {
    double largest = 0;
    for (const double v : got) largest = std::max(largest, std::abs(v));
    for (std::size_t s = 0; s < 5; ++s) {
      Carved up = own, down = own;
      (up.scratches.*field)[s] += step;
      (down.scratches.*field)[s] -= step;
      EXPECT_NEAR(got[s], (loss(up) - loss(down)) / (2 * step), 0.01 * largest) << s;
    }
  };
  check(&Scratches::width_um, m.width_um, 1);
  check(&Scratches::depth_um, m.depth_um, 0.05);
  check(&Scratches::alpha, m.alpha, 5e-4);
}

TEST(Surroundings, GradientsAreDifferences) {
  expect_gradients_to_be_differences({});
  GrooveProfile profile;
  profile.kind = GrooveProfile::Kind::rounded_v;
  profile.flank_deg = 24;
  profile.across = 1.3;
  profile.burr_left_um = 4;
  profile.burr_right_um = 2.5;
  profile.burr_width_um = 40;
  expect_gradients_to_be_differences(profile);
}

// The tiles and packets of every width against the double twin: a picture of several tiles, grooves of one shape and of
// their own, of gray and of colors. The two share facets' tables, so what differs is how these are read: within the
// thousandth of the peak that the tables are good to, and one part in a hundred of the gradients. The same bits for one
// thread and more.
TEST(Surroundings, ThePacketsAreTheTwin) {
  ViewScene scene = scene_in(surroundings_light(make_panorama(room(60), {}, "room")), 0.06);
  scene.grid = share(board_grid({5, 5}, {45, 35}, 80, 60, Surface{{60, 48}, {0.1, 0, -0.1}}));
  std::mt19937 random(5);
  std::uniform_real_distribution<double> x(3, 47), y(3, 37), turn(0, 2 * std::numbers::pi), more(0.9, 1.1);
  Carved shared, own;
  Scratches& s = shared.scratches;
  for (int i = 0; i < 60; ++i) {
    const double a = turn(random), length = 8 * more(random);
    s.x0_mm.push_back(x(random));
    s.y0_mm.push_back(y(random));
    s.x1_mm.push_back(s.x0_mm.back() + length * std::cos(a));
    s.y1_mm.push_back(s.y0_mm.back() + length * std::sin(a));
  }
  own = shared;
  for (int i = 0; i < 60; ++i) {
    own.scratches.width_um.push_back(400 * more(random));
    own.scratches.depth_um.push_back(14 * more(random));
    own.scratches.alpha.push_back(0.06 * more(random));
  }
  for (const int channels : {1, 3}) {
    Image weight(80, 60, channels);
    for (std::size_t i = 0; i < weight.data.size(); ++i) weight.data[i] = static_cast<float>(std::sin(0.7 * i) + 0.4);
    for (const Carved& carved : {shared, own}) {
      if (channels == 3 && carved.scratches.alpha.empty()) continue;
      const auto seen = [&](bool twin, SimdWidth width, Image& image) {
        ViewRenderer renderer(scene, {channels, twin, true, width});
        renderer.forward_with_jacobian(carved, image);
        return renderer.backward(weight);
      };
      Image exact;
      const ScratchGradients e = seen(true, SimdWidth::best, exact);
      const bool one_of_all = channels == 1 && !carved.scratches.alpha.empty();  // tables take their time
      for (const SimdWidth width : {SimdWidth::generic, SimdWidth::avx2, SimdWidth::avx512}) {
        if (!has_kernel(width) || (!one_of_all && width != resolved_simd(SimdWidth::best))) continue;
        Image fast, lone;
        const ScratchGradients g = seen(false, width, fast);
        EXPECT_LT(rms(fast, exact), 1e-3 * peak(exact)) << channels;
        for (const auto field :
             {&ScratchGradients::x0_mm, &ScratchGradients::y0_mm, &ScratchGradients::x1_mm, &ScratchGradients::y1_mm,
              &ScratchGradients::width_um, &ScratchGradients::depth_um, &ScratchGradients::alpha}) {
          double error = 0, size = 0;
          for (std::size_t i = 0; i < 60; ++i) {
            error += std::pow((g.*field)[i] - (e.*field)[i], 2);
            size += std::pow((e.*field)[i], 2);
          }
          EXPECT_LT(std::sqrt(error), 0.01 * std::sqrt(size)) << channels << ' ' << kernel_lanes(width);
        }
        EXPECT_NEAR(g.shared_base_alpha, e.shared_base_alpha, 1e-3 * std::abs(e.shared_base_alpha));
        if (!one_of_all) continue;
        const tbb::global_control one(tbb::global_control::max_allowed_parallelism, 1);
        const ScratchGradients alone = seen(false, width, lone);
        EXPECT_EQ(fast.data, lone.data);
        EXPECT_EQ(g.x0_mm, alone.x0_mm);
        EXPECT_EQ(g.alpha, alone.alpha);
      }
    }
  }
}

// A lamp with an area in a view that is rendered again and again goes by tables as well: against 400 points of it in
// double, and its gradient against that of the four points that stand for it elsewhere, which are good to a hundredth
// of a glint.
TEST(Surroundings, TablesOfADiskAreItsPoints) {
  Light disk;
  disk.position_mm = {20, -300, 400};
  disk.axis = -disk.position_mm.normalized();
  disk.intensity = {2e5, 2e5, 2e5};
  disk.size.disk_mm = 14;
  ViewScene scene = scene_in(disk, 0.06);
  // Of that size the lattice of places consists of pixels, as it all but does in larger pictures.
  constexpr int kColumns = 16, kRows = 13;
  scene.grid = share(board_grid({20, 15}, {20 + 0.23 * kColumns, 15 + 0.23 * kRows}, kColumns, kRows,
                                Surface{{60, 48}, {0.1, 0, -0.1}}));
  const Carved carved = some_grooves();
  ViewRenderer tables(scene, {1, false, false}, make_render_workspace()), points(scene, {1, false, false});
  Image image, other, truth(kColumns, kRows, 1);
  tables.forward_with_jacobian(carved, image);
  points.forward_with_jacobian(carved, other);
  constexpr int kPoints = 400;
  const Eigen::Vector3d u = disk.axis.unitOrthogonal(), v = disk.axis.cross(u);
  for (int k = 0; k < kPoints; ++k) {
    const double r = disk.size.disk_mm * std::sqrt((k + 0.5) / kPoints), a = 2.399963 * k;
    ViewScene one = scene;
    one.light.size = {};
    one.light.position_mm += r * (std::cos(a) * u + std::sin(a) * v);
    one.light.intensity /= kPoints;
    const Image part = render_brute_force(one, carved, 1);
    for (std::size_t i = 0; i < truth.data.size(); ++i) truth.data[i] += part.data[i];
  }
  EXPECT_LT(rms(image, truth), 1e-3 * peak(truth));
  EXPECT_GT(rms(image, other), 0) << "both went by points";
  Image weight(kColumns, kRows, 1);
  for (std::size_t i = 0; i < weight.data.size(); ++i) weight.data[i] = static_cast<float>(std::sin(0.7 * i) + 0.4);
  const ScratchGradients a = tables.backward(weight), b = points.backward(weight);
  double error = 0, size = 0;
  for (std::size_t s = 0; s < carved.size(); ++s)
    for (const auto field :
         {&ScratchGradients::x0_mm, &ScratchGradients::y0_mm, &ScratchGradients::x1_mm, &ScratchGradients::y1_mm}) {
      error += std::pow((a.*field)[s] - (b.*field)[s], 2);
      size += std::pow((b.*field)[s], 2);
    }
  EXPECT_LT(std::sqrt(error), 0.01 * std::sqrt(size));
}

// A picture from within, turned as a camera holds it, is the same room as its mirror image in the board's own frame.
TEST(Surroundings, APanoramaFromWithinIsItsMirrorImage) {
  const Image picture = room(60);
  Image mirrored = picture;
  for (int y = 0; y < picture.height; ++y)
    for (int x = 0; x < picture.width; ++x)
      for (int c = 0; c < 3; ++c) mirrored.at(x, y, c) = picture.at(picture.width - 1 - x, y, c);
  const auto board = make_panorama(picture, {}, "a");
  const auto inside = make_panorama(mirrored, {PanoramaFrame::Kind::inside}, "b");
  for (const Eigen::Vector3d& to : {Eigen::Vector3d(0.3, -0.8, 0.6), {-0.1, 0.9, 0.4}, {-0.7, 0.1, 0.2}})
    EXPECT_EQ(board->radiance.data[3 * board->pixel(to)], inside->radiance.data[3 * inside->pixel(to)]);
  EXPECT_GT(board->radiance.data[3 * board->pixel(board->direction(44.5, 8.5))], 0);
  // On a wall: the world's up is the board's y, and the middle column looks straight away from the face.
  const auto wall = make_panorama(picture, {PanoramaFrame::Kind::inside, {0, 1, 0}, {0, 0, 1}}, "c");
  EXPECT_NEAR((wall->direction(30, 15) - Eigen::Vector3d(0, 0, 1)).norm(), 0, 1e-12);
  EXPECT_NEAR((wall->direction(30, 0) - Eigen::Vector3d(0, 1, 0)).norm(), 0, 1e-12);
  EXPECT_LT(wall->direction(36, 15).x(), 0) << "who looks out of the face has x on the left";
  EXPECT_EQ(wall->pixel(wall->direction(36.5, 11.5)), 11U * 60 + 36);
}

TEST(Surroundings, SourcesBringAPlaneWhatThePicturesPixelsDo) {
  const Light light = surroundings_light(make_panorama(room(1440), {}, "room"));
  const LightSources sources = light_sources(light, 0.01);
  ASSERT_LT(8 * sources.x.size(), 1440U * 720U) << "pixels are put together";
  for (const Eigen::Vector3d& toward :
       {Eigen::Vector3d(0, 0, 1), Eigen::Vector3d(0.3, -0.6, 0.5), Eigen::Vector3d(-1, 0.2, 0.1)}) {
    const Eigen::Vector3d normal = toward.normalized();
    const Eigen::Vector3d exact = irradiance(*light.far->surroundings, normal);
    EXPECT_LT((irradiance(sources, normal) - exact).norm(), 1e-3 * exact.norm()) << normal.transpose();
  }
}

// The sun is a disk of half a degree. Widened roughness stands for it.
TEST(Surroundings, TheSunIsADisk) {
  for (const double alpha : {0.02, 0.06}) {
    const Light sun = sun_light({0.1, -0.7, 0.9}, {3, 3, 2});
    ViewScene scene = scene_in(sun, alpha);
    const Carved carved = some_grooves();
    Image seen, disk(kWidth, kHeight, 3);
    ViewRenderer(scene, {3}).forward(carved, seen);
    constexpr int kPoints = 60;
    const Eigen::Vector3d to = sun.far->direction, u = to.unitOrthogonal(), v = to.cross(u);
    for (int k = 0; k < kPoints; ++k) {
      const double r = 0.5 * 0.53 * std::numbers::pi / 180 * std::sqrt((k + 0.5) / kPoints), a = 2.399963 * k;
      Light lamp;
      lamp.position_mm = kFar_mm * (to + r * (std::cos(a) * u + std::sin(a) * v)).normalized();
      lamp.intensity = sun.intensity * (kFar_mm * kFar_mm / kPoints);
      scene.light = lamp;
      const Image one = render_brute_force(scene, carved, 3);
      for (std::size_t i = 0; i < disk.data.size(); ++i) disk.data[i] += one.data[i];
    }
    EXPECT_LT(rms(seen, disk), 1e-3 * peak(disk)) << alpha;
  }
}

// Lights at once add up, whatever their order, and so do their gradients.
TEST(Surroundings, LightsAtOnceAddUp) {
  Light lamp;
  lamp.position_mm = {20, -300, 400};
  lamp.intensity = {2e5, 1e5, 1e5};
  const Light sun = sun_light({0.3, 0.5, 0.8}, {1, 1, 2});
  const Light around = surroundings_light(make_panorama(room(60), {}, "room"));
  const Carved carved = some_grooves();
  Image weight(kWidth, kHeight, 3, 0.3F), sum(kWidth, kHeight, 3), together;
  std::vector<double> slope(5, 0.0);
  for (const Light& light : {lamp, sun, around}) {
    ViewRenderer renderer(scene_in(light, 0.06), {3});
    Image one;
    renderer.forward_with_jacobian(carved, one);
    const ScratchGradients g = renderer.backward(weight);
    for (std::size_t i = 0; i < sum.data.size(); ++i) sum.data[i] += one.data[i];
    for (std::size_t s = 0; s < 5; ++s) slope[s] += g.x1_mm[s];
  }
  Light all = around;
  all.also = {sun, lamp};
  ViewRenderer renderer(scene_in(all, 0.06), {3});
  renderer.forward_with_jacobian(carved, together);
  const ScratchGradients g = renderer.backward(weight);
  EXPECT_LT(rms(together, sum), 1e-6 * peak(sum));
  for (std::size_t s = 0; s < 5; ++s) EXPECT_NEAR(g.x1_mm[s], slope[s], 1e-4 * std::abs(slope[s]) + 1e-6);
}

// A place that a lamp does not see lies in a room all the same.
TEST(Surroundings, ShineWhereALampIsHidden) {
  const Carved carved = some_grooves();
  for (const bool use_double : {false, true}) {
    ViewScene scene = scene_in(surroundings_light(make_panorama(room(60), {}, "room")), 0.06);
    RenderOptions options{3};
    options.use_double = use_double;
    Image open, behind;
    ViewRenderer(scene, options).forward(carved, open);
    scene.hidden_from_light.assign(std::size_t{kWidth} * kHeight, 1);
    ViewRenderer(scene, options).forward(carved, behind);
    EXPECT_EQ(behind.data, open.data) << use_double;
  }
}

// A board before its first scratch, and the same renderer with scratches afterwards.
TEST(Surroundings, ABoardWithoutScratchesIsItsPlainFace) {
  const ViewScene scene = scene_in(surroundings_light(make_panorama(room(60), {}, "room")), 0.06);
  Image plain, twin, carved, again;
  ViewRenderer both(scene, {3});
  both.forward_with_jacobian(Carved{}, plain);
  EXPECT_TRUE(both.backward(Image(kWidth, kHeight, 3, 0.3F)).x1_mm.empty());
  RenderOptions in_double{3};
  in_double.use_double = true;
  ViewRenderer(scene, in_double).forward(Carved{}, twin);
  EXPECT_LT(rms(plain, twin), 1e-5 * peak(twin));
  EXPECT_GT(peak(plain), 0);
  both.forward(some_grooves(), carved);
  ViewRenderer(scene, {3}).forward(some_grooves(), again);
  EXPECT_EQ(carved.data, again.data);
  EXPECT_GT(rms(carved, plain), 1e-3 * peak(plain));
}

// What each scratch adds can be asked between a picture and its way back.
TEST(Surroundings, ContributionsLeaveTheWayBackAsItWas) {
  Light one, other;
  one.position_mm = {20, -300, 400};
  one.intensity = {2e5, 1e5, 1e5};
  other = one;
  other.position_mm = {150, 200, 500};
  one.also = {other};
  const Carved carved = some_grooves();
  const Image weight(kWidth, kHeight, 3, 0.3F);
  Image picture;
  ViewRenderer plain(scene_in(one, 0.06), {3}), asked(scene_in(one, 0.06), {3});
  plain.forward_with_jacobian(carved, picture);
  asked.forward_with_jacobian(carved, picture);
  std::vector<double> contributions(carved.scratches.size(), 0);
  asked.add_contributions(contributions);
  EXPECT_GT(contributions[0], 0);
  const std::vector<double> slope = plain.backward(weight).x1_mm;
  EXPECT_EQ(asked.backward(weight).x1_mm, slope);
  EXPECT_EQ(asked.backward(weight).x1_mm, slope) << "a second way back";
  EXPECT_EQ(plain.backward(weight).x1_mm, slope) << "a second way back";
}

TEST(Surroundings, BadPicturesAreRefusedInWords) {
  Image negative = room(60), infinite = room(60);
  negative.at(7, 3, 1) = -0.5F;
  infinite.at(9, 4, 0) = std::numeric_limits<float>::infinity();
  EXPECT_THAT([&] { make_panorama(negative, {}, "sky.exr"); },
              ThrowsMessage<Error>(AllOf(HasSubstr("sky.exr"), HasSubstr("negative"), HasSubstr("column 7, row 3"))));
  EXPECT_THAT([&] { make_panorama(infinite, {}, "sky.exr"); },
              ThrowsMessage<Error>(AllOf(HasSubstr("no finite number"), HasSubstr("column 9, row 4"))));
  EXPECT_THAT([&] { make_panorama(Image(50, 50, 3, 1), {}, "sky.exr"); },
              ThrowsMessage<Error>(HasSubstr("twice as wide as high")));
  EXPECT_THAT([&] { make_panorama(Image(60, 30, 3, 0), {}, "sky.exr"); }, ThrowsMessage<Error>(HasSubstr("black")));
  EXPECT_THAT(
      [&] {
        make_panorama(room(60), {PanoramaFrame::Kind::inside, {0, 1, 0}, {0, 2, 0}}, "sky.exr");
      },
      ThrowsMessage<Error>(HasSubstr("middle")));
}

}  // namespace
}  // namespace burin

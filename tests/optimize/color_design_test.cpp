// Proves: a channel of a view in color is that channel of its lights' picture, whatever shines; the loss over red,
// green and blue has the gradient that it claims, against differences of the loss; strokes under lamps of mixed colors
// are judged by all channels, each picture counting once; a small design in color comes far closer to a picture in
// color than the best in gray can; threads change no bit; white is what paper shows; colors that lights cannot mix are
// said, and wrong input is refused in words. Angles between lamps: lamp_places_test. Quality on photographs:
// docs/light.md.
#include "burin/optimize/design/color_views.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <array>
#include <cmath>
#include <numbers>

#include "burin/base/error.h"
#include "burin/base/files/json_file.h"
#include "burin/optimize/design.h"
#include "burin/optimize/design/design_output.h"
#include "burin/optimize/design/design_start.h"
#include "burin/optimize/design/design_views.h"
#include "burin/optimize/design/direction_light.h"
#include "burin/optimize/loss/color_metrics.h"
#include "burin/optimize/loss/picture_metrics.h"
#include "burin/pictures/picture.h"
#include "burin/scene/far_light.h"
#include "tests/optimize/color_rig.h"

namespace burin {
namespace {

using testing::AllOf;
using testing::HasSubstr;

class ColorDesign : public ColorRig {};

Scratches colored_scratches() {
  Scratches s;
  s.x0_mm = {20, 28, 36};
  s.y0_mm = {22, 40, 29};
  s.x1_mm = {33, 37, 41};
  s.y1_mm = {24.5, 31, 38};
  return s;
}

TEST_F(ColorDesign, AChannelIsThatOfTheLightsPicture) {
  mix_lamps();
  Light sun = sun_light({0.2, 0.5, 0.8}, {3e-6, 2e-6, 1e-6});
  sun.id = "sun";
  bench_.lights.push_back(sun);
  Image sky(64, 32, 3);
  for (std::size_t i = 0; i < sky.data.size(); ++i) sky.data[i] = 1e-7F * static_cast<float>(1 + i % 3 + i % 7);
  Light around = surroundings_light(make_panorama(sky, {}, "sky"), {1, 2, 3});
  around.id = "sky";
  bench_.lights.push_back(around);
  bench_.ambient = {1e-7, 2e-7, 3e-7};
  spec_.views[0].light = "red + green + blue + sun + sky";
  const auto grid = design_grid(board_, bench_, 32);
  const Eigen::Vector3d still(0, 0, 0);
  const Carved grooves = carve(Designed(colored_scratches()), bench_, board_);
  RenderOptions colors;
  colors.channels = 3;
  Image all, one;
  ViewRenderer(design_scene(spec_, 0, board_, bench_, grid, still, still), colors).forward(grooves, all);
  for (int c = 0; c < 3; ++c) {
    ViewRenderer(design_scene(spec_, 0, board_, bench_, grid, still, still, {c, 2.5, ""})).forward(grooves, one);
    double peak = 0, worst = 0;
    for (std::size_t i = 0; i < one.data.size(); ++i) {
      const double wanted = 2.5 * all.data[3 * i + static_cast<std::size_t>(c)];
      peak = std::max(peak, wanted);
      worst = std::max(worst, std::abs(one.data[i] - wanted));
    }
    EXPECT_GT(peak, 0);
    EXPECT_LT(worst, 1e-5 * peak) << "channel " << c;  // sums of floats in another order
  }
}

// A hollow sheet, whose rims hide it from low lamps: the picture of several is the sum of each one's.
TEST_F(ColorDesign, WhatHidesOneLampDoesNotHideAnother) {
  mix_lamps();
  board_.bend = Bend{-24, 0};
  const auto grid = design_grid(board_, bench_, 48);
  const Eigen::Vector3d still(0, 0, 0);
  const auto shown = [&](const std::string& only) {
    Image one;
    ViewRenderer(design_scene(spec_, 0, board_, bench_, grid, still, still, {1, 1, only}))
        .forward(carve(Designed(colored_scratches()), bench_, board_), one);
    return one;
  };
  const Image all = shown(""), red = shown("red"), green = shown("green"), blue = shown("blue");
  std::size_t of_red_alone = 0;
  const double peak = *std::max_element(all.data.begin(), all.data.end());
  for (std::size_t i = 0; i < all.data.size(); ++i) {
    EXPECT_NEAR(all.data[i], red.data[i] + green.data[i] + blue.data[i], 1e-5 * peak) << i;
    of_red_alone += (red.data[i] == 0) != (green.data[i] == 0) ? 1 : 0;
  }
  EXPECT_GT(of_red_alone, all.data.size() / 50);
}

TEST_F(ColorDesign, GradientOfTheLossOverAllChannels) {
  mix_lamps();
  options_.loss = {0.7, 0.5, 0.01};
  std::vector<WorkView> all = views();
  ASSERT_EQ(all.size(), 3U);
  const double exposure = std::exp(starting_exposures(all, 1, 0.5)[0]);
  const auto loss = [&](const Scratches& s, ScratchGradients* by) {
    const Carved grooves = carve(Designed(s), bench_, board_);
    double sum = 0;
    Image dE_dpicture, dE_dradiance;
    for (WorkView& v : all) {
      v.renderer.forward_with_jacobian(grooves, v.radiance);
      picture_from_radiance(v.radiance, exposure, v.picture);
      sum += v.loss.evaluate(v.picture, dE_dpicture).total;
      if (by == nullptr) continue;
      radiance_gradient(v.radiance, exposure, v.picture, dE_dpicture, dE_dradiance);
      v.renderer.backward(dE_dradiance, *by);
    }
    return sum;
  };
  const Scratches at = colored_scratches();
  ScratchGradients by;
  by.resize(at.size());
  loss(at, &by);
  double norm = 0;
  for (const auto* g : {&by.x0_mm, &by.y0_mm, &by.x1_mm, &by.y1_mm})
    for (const double v : *g) norm = std::max(norm, std::abs(v));
  ASSERT_GT(norm, 0);
  // mm. Slopes jump where an end passes from pixel to pixel, so the step is small: floats round them by 0.2 %.
  constexpr double kStep = 0.002;
  for (std::size_t i = 0; i < at.size(); ++i) {
    const auto slope = [&](std::vector<double> Scratches::*end) {
      Scratches more = at, less = at;
      (more.*end)[i] += kStep;
      (less.*end)[i] -= kStep;
      return (loss(more, nullptr) - loss(less, nullptr)) / (2 * kStep);
    };
    EXPECT_NEAR(slope(&Scratches::x0_mm), by.x0_mm[i], 0.005 * norm) << i;
    EXPECT_NEAR(slope(&Scratches::y0_mm), by.y0_mm[i], 0.005 * norm) << i;
    EXPECT_NEAR(slope(&Scratches::x1_mm), by.x1_mm[i], 0.005 * norm) << i;
    EXPECT_NEAR(slope(&Scratches::y1_mm), by.y1_mm[i], 0.005 * norm) << i;
  }
}

TEST_F(ColorDesign, StrokesAreJudgedByAllChannelsAndEachPictureCountsOnce) {
  mix_lamps();
  std::vector<WorkView> all = views();
  const std::vector<double> log_exposure = starting_exposures(all, 1, 0.5);
  std::vector<StrokeView> seen = stroke_views(all, log_exposure, true);
  ASSERT_EQ(seen.size(), 3U);
  for (const StrokeView& v : seen) EXPECT_EQ(v.asides.size(), 2U);  // the other two channels
  double by_channel = 0;
  for (const WorkView& v : all) {
    Image light = v.face;
    for (float& l : light.data) l *= static_cast<float>(std::exp(log_exposure[0]));
    const double off = 1 / std::pow(10, psnr_db(shown_picture(light, 1), v.target.picture) / 10);
    by_channel += off * static_cast<double>(light.data.size()) / 3;  // a third each
  }
  const double before = squared_error(seen);
  EXPECT_NEAR(before, by_channel, 2e-3 * by_channel);  // shown_light is right to 4e-5 of a value
  const CarvingLimits limits = design_limits(board_, bench_, options_);
  const StrokeRules rules = stroke_rules(limits, 4, bench_, board_, 16);
  const std::vector<Stroke> strokes = place_strokes(seen, rules, 300, 5);
  ASSERT_GT(strokes.size(), 200U);
  double gains = 0;
  std::array<int, 3> of_lamp{};
  for (const Stroke& s : strokes) {
    gains += s.gain;
    ++of_lamp[s.view];
  }
  for (const int n : of_lamp) EXPECT_GT(n, 20);
  EXPECT_NEAR(before - squared_error(seen), gains, 2e-3 * before);
  // What one lamp's strokes changed all of them see.
  for (const StrokeView& v : seen)
    for (const StrokeView& w : seen)
      for (const StrokeAside& aside : w.asides)
        if (aside.picture == v.picture) {
          EXPECT_EQ(aside.light.data, v.light.data);
        }
}

TEST_F(ColorDesign, ComesFarCloserThanAnyPictureInGray) {
  const DesignResult pure = design(spec_, board_, bench_, options_, {});
  const DesignedView& v = pure.views.at(0);
  ASSERT_EQ(v.shown.channels, 3);
  ASSERT_TRUE(v.color);
  EXPECT_GT(v.psnr_db, v.start_psnr_db);
  // The best in gray: every pixel the value that is nearest to its three.
  Image gray = v.target;
  for (std::size_t i = 0; i < gray.data.size(); i += 3) {
    const float mean = (gray.data[i] + gray.data[i + 1] + gray.data[i + 2]) / 3;
    gray.data[i] = gray.data[i + 1] = gray.data[i + 2] = mean;
  }
  const double best_gray = color_psnr_db(gray, v.target);
  EXPECT_GT(v.psnr_db, best_gray + 5);
  for (const double db : v.color->quality.channel_psnr_db) EXPECT_GT(db, best_gray + 3);
  // Lamps of mixed colors still do.
  mix_lamps();
  const DesignResult mixed = design(spec_, board_, bench_, options_, {});
  EXPECT_GT(mixed.views.at(0).psnr_db, best_gray + 3);
}

TEST_F(ColorDesign, SameSeedSameBitsForAnyNumberOfThreads) {
  mix_lamps();
  options_.iterations = 3;
  const auto with_threads = [&](int threads) {
    tbb::global_control limit(tbb::global_control::max_allowed_parallelism, threads);
    return design(spec_, board_, bench_, options_, {});
  };
  const DesignResult one = with_threads(1), two = with_threads(2);
  EXPECT_EQ(one.scratches.x0_mm, two.scratches.x0_mm);
  EXPECT_EQ(one.final_loss, two.final_loss);
}

TEST_F(ColorDesign, BesideAViewInGrayWithATolerance) {
  mix_lamps();
  DesignView gray{"front", "red", {}, 1};
  gray.target.image = channel_of(discs(64), 0);
  spec_.views.push_back(gray);
  options_.iterations = 2;
  options_.tolerance_mm = 5;
  options_.carve_curve = true;
  const DesignResult result = design(spec_, board_, bench_, options_, {});
  ASSERT_EQ(result.views.size(), 2U);
  EXPECT_EQ(result.views[1].shown.channels, 1);
  EXPECT_FALSE(result.views[1].color);
  EXPECT_EQ(result.tolerance.size(), 2U);
  EXPECT_GT(result.tolerance[0].eye.sideways.least(), 0);
  EXPECT_NEAR(result.tolerance[0].psnr_db, result.views[0].psnr_db, 0.3);  // rendered in color at once
  for (const CarvingPoint& p : result.curve) EXPECT_EQ(p.psnr_db.size(), 2U);
  write_design_result(result, spec_, board_, bench_, folder_ / "out");
  EXPECT_EQ(read_picture(folder_ / "out" / "contact-sheet.png").channels, 3);
}

TEST_F(ColorDesign, PaperIsWhiteWhereverTheLampsStand) {
  bench_.lights[1].position_mm *= 1.5;  // dimmer on the paper
  const Eigen::Vector3d gains = white_gains(spec_.views[0], board_, bench_);
  const Eigen::Vector3d paper = paper_light(find_light(bench_, spec_.views[0].light, "test"), board_);
  // As bright as in gray.
  EXPECT_NEAR(gains.cwiseProduct(paper).dot(Eigen::Vector3d(0.2126, 0.7152, 0.0722)), paper.mean(),
              1e-12 * paper.mean());
  for (int c = 1; c < 3; ++c) EXPECT_NEAR(gains[c] * paper[c], gains[0] * paper[0], 1e-12 * paper[0]);
  EXPECT_GT(gains[1], 1.5 * gains[0]);
  spec_.views[0].white = {White::Kind::light, {1, 2, 4}};
  const Eigen::Vector3d fixed = white_gains(spec_.views[0], board_, bench_);
  EXPECT_NEAR(fixed[0], 2 * fixed[1], 1e-12);
  EXPECT_NEAR(fixed[1], 2 * fixed[2], 1e-12);
  EXPECT_NEAR(fixed.cwiseProduct(paper).dot(Eigen::Vector3d(0.2126, 0.7152, 0.0722)), paper.mean(),
              1e-12 * paper.mean());
  // In memory as in a file: a white that lacks a color is none.
  for (const Eigen::Vector3d& none : {Eigen::Vector3d(1, 0, 1), Eigen::Vector3d(1, 1e-12, 1), Eigen::Vector3d(1, -1, 1),
                                      Eigen::Vector3d(1, NAN, 1)}) {
    spec_.views[0].white.rgb = none;
    EXPECT_THAT(error_of(), AllOf(HasSubstr("view front"), HasSubstr("white that lacks a color"), HasSubstr("; ")));
  }
  // A lamp seen at an angle from further away: cos / r^2.
  Light one = bench_.lights[0];
  one.position_mm = {30 + 300, 30, 400};
  EXPECT_NEAR(paper_light(one, board_)[0], 0.8 / (500.0 * 500.0), 1e-15);
}

TEST_F(ColorDesign, EachChannelMayHaveABrightnessOfItsOwn) {
  options_.iterations = 3;
  spec_.views[0].white.kind = White::Kind::each;
  const DesignResult result = design(spec_, board_, bench_, options_, {});
  const DesignedView& v = result.views.at(0);
  // What is said of gain and exposure makes the picture again.
  const auto grid = design_grid(board_, bench_, options_.pixels);
  RenderOptions colors;
  colors.channels = 3;
  Image radiance;
  ViewRenderer(design_scene(spec_, 0, board_, bench_, grid, {0, 0, 0}, {0, 0, 0}), colors)
      .forward(carve(Designed(result.scratches), bench_, board_), radiance);
  for (std::size_t i = 0; i < radiance.data.size(); ++i)
    radiance.data[i] *= static_cast<float>(v.color->white_gain[i % 3]);
  EXPECT_GT(color_psnr_db(shown_picture(radiance, v.best_exposure), v.shown), 60);
}

// A picture in yellow on black, whose blue says nothing of brightness.
TEST_F(ColorDesign, AChannelThatIsBlackIsShownAsBrightAsTheBrightest) {
  options_.iterations = 3;
  Image& picture = spec_.views[0].target.image;
  for (const float blue : {0.0F, 0.002F, 0.02F}) {  // none, hardly any, and enough to tell
    for (int y = 0; y < picture.height; ++y)
      for (int x = 0; x < picture.width; ++x) {
        const bool bright = std::hypot(x - 32, y - 32) < 20;
        picture.at(x, y, 0) = bright ? 0.8F : 0.0F;
        picture.at(x, y, 1) = bright ? 0.7F : 0.0F;
        picture.at(x, y, 2) = blue;
      }
    spec_.views[0].white.kind = White::Kind::each;
    const DesignResult result = design(spec_, board_, bench_, options_, {});
    const DesignedView& v = result.views.at(0);
    EXPECT_TRUE(std::isfinite(result.final_loss));
    EXPECT_GT(v.psnr_db, 15);
    for (const double gain : v.color->white_gain) EXPECT_GT(gain, 0);
    for (const double gain : v.color->white_gain) EXPECT_TRUE(std::isfinite(gain));
    const auto said = std::count_if(result.findings.begin(), result.findings.end(), [](const Finding& f) {
      return f.what.find("hardly any blue") != std::string::npos && f.what.find("bright as red") != std::string::npos;
    });
    EXPECT_EQ(said, blue < 0.01F ? 1 : 0);
    // So is the picture shown with one brightness for all.
    spec_.views[0].white.kind = White::Kind::paper;
    EXPECT_NEAR(design(spec_, board_, bench_, options_, {}).views.at(0).psnr_db, v.psnr_db, 2);
  }
}

// One brightness for a view in gray and two in color whose whites are said differently, under the same lamps.
TEST_F(ColorDesign, ViewsInGrayAndColorUnderTheSameLampsShareAnExposure) {
  bench_.lights[2].intensity = {0, 0, 0.2};
  options_.exposure_of = ExposureOf::light;
  options_.iterations = 0;
  DesignView camera = spec_.views[0], gray = spec_.views[0];
  camera.white = {White::Kind::light, {1, 1, 1}};
  gray.color = false;
  gray.target.image = luminance(discs(64));
  spec_.views.push_back(camera);
  spec_.views.push_back(gray);
  const std::vector<WorkView> all = views();
  ASSERT_EQ(all.size(), 7U);
  for (const WorkView& v : all) EXPECT_EQ(v.exposure_group, 0);
  // White paper is as bright in each of them.
  const Eigen::Vector3d paper = paper_light(find_light(bench_, gray.light, "test"), board_);
  for (const std::size_t k : {std::size_t{0}, std::size_t{3}}) {
    const Eigen::Vector3d shown = all[k].gains.cwiseProduct(paper);
    EXPECT_NEAR(0.2126 * shown[0] + 0.7152 * shown[1] + 0.0722 * shown[2], paper.mean(), 1e-9 * paper.mean());
  }
}

// Lamps of one view are told by their angles; a room beside them is not, and is named.
TEST(ColorDirections, LightsOfOneViewAreNamedWhereTheyCollide) {
  const auto seen_under = [](const std::string& light, int best, bool told) {
    DirectionLight d;
    for (int k = 0; k < 90; ++k) d.light.push_back(std::exp(-0.1 * std::pow(k - best, 2)));
    d.best = 1;
    return MeasuredView{"front", light, d, told};
  };
  const std::vector<Finding> said = check_directions({seen_under("red", 20, true), seen_under("green", 22, true),
                                                      seen_under("room", 60, false), seen_under("blue", 61, true)});
  std::vector<std::string> collisions;
  for (const Finding& f : said)
    if (f.what.find("collide") != std::string::npos) {
      collisions.push_back(f.what);
      EXPECT_THAT(f.remedy, HasSubstr("one of these lights"));
    }
  ASSERT_EQ(collisions.size(), 2U);
  EXPECT_THAT(collisions[0], HasSubstr("views front under room and front under blue: collide"));
  EXPECT_THAT(collisions[1], HasSubstr("views front under blue and front under room: collide"));
}

TEST_F(ColorDesign, NearestMixIsTheNearest) {
  const LampColors colors{{1, 0.2, 0.1}, {0.3, 2, 0.4}, {0, 0, 0}};  // a dark one counts for nothing
  Image red(4, 1, 1), green(4, 1, 1), blue(4, 1, 1);
  const auto encoded = [](double light) { return static_cast<float>(std::pow(light, 1 / 2.2)); };
  const std::vector<Eigen::Vector3d> wanted{
      0.3 * colors[0] + 0.2 * colors[1], {0.1, 0.1, 0.7}, {0.6, 0.05, 0.05}, {0, 0, 0}};
  for (int i = 0; i < 4; ++i) {
    red.at(i, 0) = encoded(wanted[static_cast<std::size_t>(i)][0]);
    green.at(i, 0) = encoded(wanted[static_cast<std::size_t>(i)][1]);
    blue.at(i, 0) = encoded(wanted[static_cast<std::size_t>(i)][2]);
  }
  const std::vector<Image> near = nearest_mixed({&red, &green, &blue}, colors);
  for (int i = 0; i < 4; ++i) {
    Eigen::Vector3d light;
    for (std::size_t c = 0; c < 3; ++c) light[static_cast<Eigen::Index>(c)] = std::pow(near[c].at(i, 0), 2.2);
    const Eigen::Vector3d rest = wanted[static_cast<std::size_t>(i)] - light;
    if (i == 0 || i == 3) {
      EXPECT_LT(rest.norm(), 1e-4) << i;
    }
    // No color would bring it nearer, and it stands at right angles to what is missing.
    for (const Eigen::Vector3d& color : colors) EXPECT_LT(rest.dot(color), 1e-3) << i;
    EXPECT_NEAR(rest.dot(light), 0, 1e-3) << i;
  }
}

TEST_F(ColorDesign, ColorsThatNoLampHas) {
  bench_.lights[2].intensity = {0, 0.4, 0};
  EXPECT_THAT(error_of(), AllOf(HasSubstr("view front"), HasSubstr("red + green + blue"), HasSubstr("any blue"),
                                HasSubstr("; "), HasSubstr("leave out \"color\"")));
  bench_.lights[2].intensity = {0, 0, 1};
  spec_.views[0].light = "red";
  EXPECT_THAT(error_of(), HasSubstr("any green"));
  for (Light& light : bench_.lights) light.intensity = {2, 1, 0.5};
  EXPECT_THAT(error_of(), HasSubstr("has one light alone (red)"));
  spec_.views[0].light = "red + green + blue";
  EXPECT_THAT(error_of(), HasSubstr("are of one color"));
  lamp("off", {60, 500, 300}, {0, 0, 0});
  spec_.views[0].light = "red + green + blue + off";
  EXPECT_THAT(error_of(), AllOf(HasSubstr("view front"), HasSubstr("light off, which has no light"), HasSubstr("; ")));
  spec_.views[0].light = "red + violet";
  EXPECT_THAT(error_of(), HasSubstr("violet"));
}

TEST_F(ColorDesign, ColorsThatLightsCannotMixAreSaid) {
  bench_.lights[0].intensity = {1, 0.9, 0.8};
  bench_.lights[1].intensity = {0.8, 0.9, 1};
  bench_.lights[2].intensity = {1, 1, 1};
  options_.iterations = 0;
  options_.start_sweeps = 0;
  bool said = false;
  options_.found = [&](const std::vector<Finding>& findings) {
    for (const Finding& f : findings) said = said || f.what.find("cannot mix all colors") != std::string::npos;
  };
  const DesignResult result = design(spec_, board_, bench_, options_, {});
  EXPECT_TRUE(said);
  EXPECT_LT(result.views[0].achievable_psnr_db, 20);
}

TEST_F(ColorDesign, LightsOfManyColorsInGrayAreANote) {
  spec_.views[0].color = false;
  options_.iterations = 0;
  options_.start_sweeps = 0;
  const DesignResult result = design(spec_, board_, bench_, options_, {});
  EXPECT_TRUE(std::any_of(result.findings.begin(), result.findings.end(), [](const Finding& f) {
    return f.severity == Finding::Severity::note && f.what.find("shown in gray") != std::string::npos;
  }));
}

TEST_F(ColorDesign, FilesSayIt) {
  spec_.board = folder_ / "board.json";
  spec_.bench = folder_ / "bench.json";
  spec_.views[0].target = {};
  spec_.views[0].target.picture = folder_ / "a.png";
  const auto again = [&] {
    write_design(spec_, folder_ / "design.json");
    return read_design(folder_ / "design.json").views.at(0);
  };
  EXPECT_TRUE(again().color);
  EXPECT_EQ(again().white.kind, White::Kind::paper);
  spec_.views[0].white.kind = White::Kind::each;
  EXPECT_EQ(again().white.kind, White::Kind::each);
  spec_.views[0].white = {White::Kind::light, {1, 0.5, 0.25}};
  EXPECT_EQ(again().white.rgb, Eigen::Vector3d(1, 0.5, 0.25));
  const auto refused = [&](const std::string& keys) {
    write_text(
        "{\"format\": \"burin/design\", \"version\": 1, \"board\": \"b\", \"bench\": \"c\", \"scratches\": 9, "
        "\"views\": [{\"view\": \"front\", \"target\": \"a.png\", " +
            keys + "}]}",
        folder_ / "wrong.json");
    try {
      read_design(folder_ / "wrong.json");
    } catch (const Error& e) {
      return std::string(e.what());
    }
    return std::string();
  };
  EXPECT_THAT(refused("\"color\": \"yes\""), HasSubstr("color"));
  EXPECT_THAT(refused("\"white\": \"paper\""), HasSubstr("a picture in gray"));
  EXPECT_THAT(refused("\"color\": true, \"white\": \"snow\""), AllOf(HasSubstr("snow"), HasSubstr("\"each\"")));
  EXPECT_THAT(refused("\"color\": true, \"white\": [1, 0, 1]"), HasSubstr("no light of three colors"));
  EXPECT_THAT(refused("\"color\": true, \"white\": [1, 1]"), HasSubstr("white"));
  EXPECT_THAT(refused("\"color\": true, \"white\": [1, 1e-12, 1]"),
              AllOf(HasSubstr("wrong.json"), HasSubstr("a thousand times less")));
}

TEST(ColorMetrics, AreTheOnesOfTheChannels) {
  Image target(16, 16, 3, 0.5F), picture = target;
  for (std::size_t i = 0; i < picture.data.size(); i += 3) picture.data[i] += 0.1F;  // red is off
  EXPECT_NEAR(color_psnr_db(picture, target), 20 + 10 * std::log10(3.0), 1e-4);
  const ColorQuality q = color_quality(picture, target);
  EXPECT_NEAR(q.channel_psnr_db[0], 20, 1e-4);
  EXPECT_EQ(q.channel_psnr_db[1], 99);
  // 0.2126 of the light is 0.6^2.2 instead of 0.5^2.2.
  const double light = 0.2126 * std::pow(0.6, 2.2) + 0.7874 * std::pow(0.5, 2.2);
  EXPECT_NEAR(q.luminance_psnr_db, -20 * std::log10(std::pow(light, 1 / 2.2) - 0.5), 1e-3);
  Image mask(16, 16, 1, 0.0F);
  mask.at(3, 3) = 1;
  picture.at(3, 3, 0) = 0.5F;
  EXPECT_EQ(color_psnr_db(picture, target, mask), 99);
}

}  // namespace
}  // namespace burin

// Proves: bench.json and its .cameramodel go out and in again whole, to the last bit; each wrong value is named.
#include "burin/scene/bench.h"
#include "tests/places.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "burin/base/error.h"
#include "burin/base/files/json_file.h"
#include "burin/pictures/picture.h"
#include "burin/scene/bench_of_board.h"
#include "burin/scene/far_light.h"
#include "burin/scene/groove.h"
#include "tests/temporary_folder.h"

namespace burin {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::ThrowsMessage;

Lens some_lens() {
  return {"LENSMODEL_OPENCV4", {1000.25, 1001, 639.5, 1.0 / 3 + 479, -0.1, 0.02, 1e-4, -1.0 / 3e4}, 1280, 960};
}

/// A bench in which every field differs from its default.
Bench full_bench(const TemporaryFolder& folder) {
  Bench bench;
  bench.lens_scatter = {4.5, 0.01};
  bench.lens = some_lens();
  bench.camera = folder / "lens.cameramodel";
  View view;
  view.name = "v00";
  view.T_camera_board.linear() = Eigen::AngleAxisd(2.9, Eigen::Vector3d(1, 0.2, -0.1).normalized()).toRotationMatrix();
  view.T_camera_board.translation() = Eigen::Vector3d(-100, 50.125, 800.0 / 3);
  bench.views.push_back(view);
  view.name = "v01";
  view.center_sigma_mm = Eigen::Vector3d(0.1, 0.2, 0.3);
  view.reprojection_rms_px = 0.0213;
  view.own_lens = {{5.25, -3.5}, 1.0125};
  view.own_lens_sigma = {{0.25, 0.125}, 0.0003};
  view.tags = 28;
  bench.views.push_back(view);
  Light light;
  light.id = "spot";
  light.position_mm = {150, -500, 900.0 / 7};
  light.position_sigma_mm = Eigen::Vector3d(1, 2, 3);
  light.intensity = {1e6, 2e6, 3e6};
  light.intensity_sigma = Eigen::Vector3d(1e3, 2e3, 3e3);
  light.axis = Eigen::Vector3d(0.1, 0.5, -0.87).normalized();
  light.falloff_exponent = 2.5;
  light.falloff_exponent_sigma = 0.1;
  bench.lights = {light, Light()};
  bench.material = {0.061, 14.2, 0.17, {0.9, 0.8, 0.7}};
  bench.material_sigma.alpha = 0.001;
  bench.material_sigma.depth_um = 0.4;
  bench.material_sigma.base_alpha = 0.004;
  bench.depth_field = {{0.07, -0.04, 0.01, 0.02, -0.03, 0.05},
                       std::array<double, 6>{1e-3, 2e-3, 3e-3, 4e-3, 5e-3, 6e-3}};
  bench.alpha_field.terms[5] = -0.02;
  bench.sensor.gain = 3.5;
  bench.sensor.vignette = {-0.1, 0.02, -0.003};
  bench.sensor.psf_sigma_px = 0.6;
  bench.sensor.green_sites = GreenSites::odd;
  bench.ambient = {0.01, 0.02, 0.03};
  bench.bow_mm = {0.1, -0.02, 0.03};
  bench.paper = {0.04, 0.31};
  Light& stray = bench.stray.emplace();
  stray.id = "stray";
  stray.position_mm = {-200, 300, 500};
  stray.position_sigma_mm = Eigen::Vector3d(3, 4, 5);
  stray.intensity.setConstant(9e4);
  stray.size.disk_mm = 20;
  bench.tags = {{0, {15.02, 14.97}, 0, 0}, {4, {100, 14.5}, 16.01, 90.5}};
  bench.machine_affine << 1.001, 0.002, -0.3, -0.0015, 0.999, 0.4;
  bench.machine_affine_sigma = Affine2::Constant(1e-5);
  bench.verdict["depth_um"].causes = {{Cause::Kind::cutoff_not_seen, {12, 0}}};
  bench.verdict["light.spot.position_mm"] = given_verdict();
  bench.verdict["alpha"] = {
      Source::measured,
      Degree::weakly,
      30.5,
      Unit::percent,
      {{Cause::Kind::halves_of_photos, {0.75, 2.5, 6, 1.5}}, {Cause::Kind::above_noise, {3}}},
      NextPhoto{NextPhoto::Kind::at_place, "camera 620 mm above the lower left corner", 4.25, {}}};
  return bench;
}

TEST(Bench, RoundTripKeepsEveryFieldToTheLastBit) {
  const TemporaryFolder folder;
  const Bench bench = full_bench(folder);
  write_bench(bench, 400, folder / "bench.json");
  const Bench back = read_bench(folder / "bench.json");
  EXPECT_EQ(back.camera, bench.camera);
  EXPECT_EQ(back.lens.model, bench.lens.model);
  EXPECT_EQ(back.lens.intrinsics, bench.lens.intrinsics);
  EXPECT_EQ(back.lens.width, 1280);
  EXPECT_EQ(back.lens.height, 960);
  ASSERT_EQ(back.views.size(), 2u);
  EXPECT_EQ(back.views[0].T_camera_board.matrix(), bench.views[0].T_camera_board.matrix());
  EXPECT_FALSE(back.views[0].center_sigma_mm || back.views[0].reprojection_rms_px || back.views[0].tags);
  EXPECT_EQ(back.views[1].name, "v01");
  EXPECT_EQ(back.views[1].center_sigma_mm, bench.views[1].center_sigma_mm);
  EXPECT_EQ(back.views[1].reprojection_rms_px, 0.0213);
  ASSERT_TRUE(back.views[1].own_lens && back.views[1].own_lens_sigma && back.lens_scatter);
  EXPECT_EQ(back.views[1].own_lens->shift_px, Eigen::Vector2d(5.25, -3.5));
  EXPECT_EQ(back.views[1].own_lens->focal_ratio, 1.0125);
  EXPECT_EQ(back.views[1].own_lens_sigma->shift_px, Eigen::Vector2d(0.25, 0.125));
  EXPECT_EQ(back.views[1].own_lens_sigma->focal_ratio, 0.0003);
  EXPECT_EQ(back.lens_scatter->shift_px, 4.5);
  EXPECT_EQ(back.lens_scatter->focal, 0.01);
  EXPECT_FALSE(back.views[0].own_lens);
  EXPECT_EQ(lens_of(back, back.views[0]).intrinsics, back.lens.intrinsics);
  EXPECT_NEAR(lens_of(back, back.views[1]).intrinsics[0], 1.0125 * back.lens.intrinsics[0], 1e-9);
  EXPECT_NEAR(lens_of(back, back.views[1]).intrinsics[3], back.lens.intrinsics[3] - 3.5, 1e-9);
  EXPECT_EQ(back.views[1].tags, 28);
  ASSERT_EQ(back.lights.size(), 2u);
  const Light& light = back.lights[0];
  EXPECT_EQ(light.id, "spot");
  EXPECT_EQ(light.position_mm, bench.lights[0].position_mm);
  EXPECT_EQ(light.position_sigma_mm, bench.lights[0].position_sigma_mm);
  EXPECT_EQ(light.intensity, bench.lights[0].intensity);
  EXPECT_EQ(light.intensity_sigma, bench.lights[0].intensity_sigma);
  EXPECT_EQ(light.axis, bench.lights[0].axis);
  EXPECT_EQ(light.falloff_exponent, 2.5);
  EXPECT_EQ(light.falloff_exponent_sigma, 0.1);
  EXPECT_EQ(back.material.alpha, 0.061);
  EXPECT_EQ(back.material.depth_um, 14.2);
  EXPECT_EQ(back.material.base_alpha, 0.17);
  EXPECT_EQ(back.material.f0, bench.material.f0);
  EXPECT_EQ(back.material_sigma.alpha, 0.001);
  EXPECT_EQ(back.material_sigma.depth_um, 0.4);
  EXPECT_EQ(back.material_sigma.base_alpha, 0.004);
  EXPECT_EQ(back.depth_field.terms, bench.depth_field.terms);
  EXPECT_EQ(back.depth_field.sigma, bench.depth_field.sigma);
  EXPECT_EQ(back.alpha_field.terms, bench.alpha_field.terms);
  EXPECT_FALSE(back.alpha_field.sigma.has_value());
  EXPECT_EQ(back.sensor.gain, 3.5);
  EXPECT_EQ(back.sensor.vignette, bench.sensor.vignette);
  EXPECT_EQ(back.sensor.psf_sigma_px, 0.6);
  EXPECT_EQ(back.sensor.green_sites, GreenSites::odd);
  EXPECT_EQ(back.ambient, bench.ambient);
  EXPECT_EQ(back.bow_mm, bench.bow_mm);
  EXPECT_EQ(back.paper.f0, 0.04);
  EXPECT_EQ(back.paper.alpha, 0.31);
  ASSERT_TRUE(back.stray && back.stray->position_sigma_mm);
  EXPECT_EQ(back.stray->position_mm, bench.stray->position_mm);
  EXPECT_EQ(*back.stray->position_sigma_mm, *bench.stray->position_sigma_mm);
  EXPECT_EQ(back.stray->intensity, bench.stray->intensity);
  EXPECT_EQ(back.stray->size.disk_mm, 20);
  ASSERT_EQ(back.tags.size(), 2u);
  EXPECT_EQ(back.tags[0].center_mm, bench.tags[0].center_mm);
  EXPECT_EQ(back.tags[1].size_mm, 16.01);
  EXPECT_EQ(back.tags[1].rotation_deg, 90.5);
  EXPECT_EQ(back.machine_affine, bench.machine_affine);
  EXPECT_EQ(back.machine_affine_sigma, bench.machine_affine_sigma);
  ASSERT_EQ(back.verdict.size(), 3u);
  const Verdict& alpha = back.verdict.at("alpha");
  EXPECT_EQ(alpha.source, Source::measured);
  EXPECT_EQ(alpha.degree, Degree::weakly);
  EXPECT_EQ(alpha.sigma, 30.5);
  EXPECT_EQ(alpha.unit, Unit::percent);
  ASSERT_EQ(alpha.causes.size(), 2u);
  EXPECT_EQ(alpha.causes[0].kind, Cause::Kind::halves_of_photos);
  EXPECT_EQ(alpha.causes[0].numbers, (std::array<double, 4>{0.75, 2.5, 6, 1.5}));
  ASSERT_TRUE(alpha.next_photo.has_value());
  EXPECT_EQ(alpha.next_photo->place, "camera 620 mm above the lower left corner");
  EXPECT_EQ(alpha.next_photo->sigma, 4.25);
  EXPECT_FALSE(back.verdict.at("depth_um").known());
  EXPECT_FALSE(back.verdict.at("depth_um").sigma.has_value());
  EXPECT_TRUE(rests_on(back.verdict.at("depth_um"), Cause::Kind::cutoff_not_seen));
  EXPECT_EQ(back.verdict.at("light.spot.position_mm").source, Source::given);
  EXPECT_TRUE(back.findings.empty());

  write_bench(back, 400, folder / "again.json");
  EXPECT_EQ(file_text(folder / "again.json"), file_text(folder / "bench.json"));
}

// What photos under a lamp alone showed beside it; a room that was photographed whole has it already.
TEST(Bench, ALightThatNobodyNamedShinesBesideNearLampsAlone) {
  const TemporaryFolder folder;
  Bench bench = full_bench(folder);
  bench.lights.resize(2);
  bench.lights[0].id = "lamp";
  bench.lights[1].id = "room";
  bench.lights[1].far = std::make_shared<FarLight>();
  EXPECT_TRUE(find_light(bench, "lamp", "test").also.empty());
  const Light lit = find_lit(bench, "lamp", "test");
  ASSERT_EQ(lit.also.size(), 1u);
  EXPECT_EQ(lit.also[0].position_mm, bench.stray->position_mm);
  EXPECT_TRUE(find_lit(bench, "room", "test").also.empty());
  EXPECT_EQ(find_lit(bench, "lamp + room", "test").also.size(), 1u);
}

TEST(Bench, SurroundingsKeepTheirScaleAndItsSigma) {
  const TemporaryFolder folder;
  Image room(8, 4, 3);
  std::fill(room.data.begin(), room.data.end(), 0.5F);
  write_picture(room, folder / "room.exr");
  Bench bench = full_bench(folder);
  Light light = surroundings_light(make_panorama(room, {}, "room"), {1.3, 1.2, 1.1});
  light.id = "room";
  auto far = std::make_shared<FarLight>(*light.far);
  far->picture = folder / "room.exr";
  light.far = far;
  light.intensity_sigma = Eigen::Vector3d(0.01, 0.02, 0.03);
  bench.lights.push_back(light);
  write_bench(bench, 400, folder / "bench.json");
  const Light room_again = read_bench(folder / "bench.json").lights.back();
  EXPECT_FALSE(room_again.is_near());
  EXPECT_EQ(room_again.intensity, Eigen::Vector3d(1.3, 1.2, 1.1));
  ASSERT_TRUE(room_again.intensity_sigma);
  EXPECT_EQ(*room_again.intensity_sigma, Eigen::Vector3d(0.01, 0.02, 0.03));
}

TEST(Bench, HalfWidthIsDerivedFromTheToolAndTheCameraIsWrittenBesideOnly) {
  const TemporaryFolder folder;
  Bench bench = full_bench(folder);
  bench.camera.clear();
  write_bench(bench, 400, folder / "bench.json");
  EXPECT_TRUE(std::filesystem::exists(folder / "camera.cameramodel"));
  const Json json = Json::parse(file_text(folder / "bench.json"));
  EXPECT_DOUBLE_EQ(json["material"]["half_width_um"].get<double>(), half_width_um(400.0, 14.2));
  EXPECT_EQ(json["camera"], "camera.cameramodel");

  // A lens that is kept elsewhere is named, not overwritten.
  std::filesystem::create_directories(folder / "round-01");
  bench.camera = folder / "camera.cameramodel";
  bench.lens.intrinsics[0] = 5;
  write_bench(bench, 400, folder / "round-01/bench.json");
  EXPECT_EQ(Json::parse(file_text(folder / "round-01/bench.json"))["camera"], "../camera.cameramodel");
  EXPECT_EQ(read_bench(folder / "round-01/bench.json").lens.intrinsics[0], 1000.25);
}

class BenchErrors : public ::testing::Test {
 protected:
  BenchErrors() { write_cameramodel(some_lens(), folder_ / "camera.cameramodel"); }

  /// Reads a bench that has `fields` beside format, version and camera.
  Bench read(const std::string& fields) {
    return read_bench(folder_.write("bench.json", R"({"format": "burin/bench", "version": )" +
                                                      std::to_string(version_) + R"(, "camera": "camera.cameramodel")" +
                                                      (fields.empty() ? "" : ", " + fields) + "}"));
  }
  void expect(const std::string& fields, const std::string& field, const std::string& what) {
    EXPECT_THAT([&] { read(fields); }, ThrowsMessage<Error>(AllOf(HasSubstr("bench.json: " + field), HasSubstr(what))))
        << fields;
  }

  TemporaryFolder folder_;
  int version_ = 2;
};

// Version 1 had one sentence and two flags for a verdict, and no word of crossings.
TEST_F(BenchErrors, VersionOneIsReadAndSaysWhatItLacks) {
  version_ = 1;
  const std::string verdicts = R"("verdict": {
      "lens": {"determined": true, "reason": "given, and held fixed"},
      "alpha": {"determined": false, "weakly": true, "sigma": 30.5, "unit": "%", "reason": "rests on one photo",
                "next_photo": "camera 620 mm above the lower left corner"}})";
  const Bench believed = read(verdicts);
  EXPECT_EQ(believed.verdict.at("lens").source, Source::given);
  EXPECT_TRUE(believed.verdict.at("lens").determined());
  const Verdict& alpha = believed.verdict.at("alpha");
  EXPECT_EQ(alpha.degree, Degree::weakly);
  EXPECT_EQ(alpha.sigma, 30.5);
  EXPECT_EQ(alpha.unit, Unit::percent);
  EXPECT_EQ(sentence(alpha), "rests on one photo");
  EXPECT_EQ(sentence(*alpha.next_photo, alpha.unit), "camera 620 mm above the lower left corner");
  EXPECT_TRUE(believed.findings.empty());
  const Bench measured = read(R"("material": {"alpha": 0.06, "alpha_sigma": 0.001})");
  ASSERT_EQ(measured.findings.size(), 1u);
  EXPECT_THAT(sentence(measured.findings[0]), AllOf(HasSubstr("version 1"), HasSubstr("burin refine")));
  expect(R"("verdict": {"depth_um": {"determined": "yes"}})", "verdict.depth_um.determined", "true or false");
}

TEST_F(BenchErrors, WrongValuesAreNamed) {
  expect(R"("views": [{"view": "a", "T_camera_board": [[1,0,0,0],[0,1,0,0],[0,0,2,800],[0,0,0,1]]}])",
         "views[0].T_camera_board", "rigid motion");
  expect(R"("views": [{"view": "a", "T_camera_board": [[1,0,0,0],[0,1,0,0],[0,0,-1,800],[0,0,0,1]]}])",
         "views[0].T_camera_board", "rigid motion");
  expect(R"("views": [{"view": "a", "T_camera_board": [[1,0,0,0],[0,1,0,0],[0,0,1,800],[0,0,0,2]]}])",
         "views[0].T_camera_board", "last row");
  expect(R"("views": [{"view": "a", "T_camera_board": [[1,0,0],[0,1,0],[0,0,1]]}])", "views[0].T_camera_board",
         "4 rows");
  const std::string view = R"({"view": "a", "T_camera_board": [[1,0,0,0],[0,1,0,0],[0,0,1,800],[0,0,0,1]])";
  expect("\"views\": [" + view + "}, " + view + "}]", "views", "\"a\" is listed twice");
  expect("\"views\": [" + view + R"(, "center_sigma_mm": [1, -1, 1]}])", "views[0].center_sigma_mm", "0 or greater");
  expect("\"views\": [" + view + R"(, "tag": 4}])", "views[0].tag", "did you mean \"tags\"?");
  expect(R"("lights": [{"id": "lamp"}])", "lights[0].position_mm", "is missing");
  expect(R"("lights": [{"position_mm": [0, 0, 1], "intensity": [1, -1, 1]}])", "lights[0].intensity", "0 or greater");
  expect(R"("lights": [{"position_mm": [0, 0, 1], "axis": [0, 0, 0]}])", "lights[0].axis", "direction");
  expect(R"("lights": [{"position_mm": [0, 0, 1], "falloff_exponent": -1}])", "lights[0].falloff_exponent", "negative");
  expect(R"("material": {"alpha": 2})", "material.alpha", "roughness");
  expect(R"("material": {"alpha_sigma": -2})", "material.alpha_sigma", "0 or greater");
  expect(R"("sensor": {"gain": 0})", "sensor.gain", "greater than 0");
  expect(R"("sensor": {"psf_sigma_px": -1})", "sensor.psf_sigma_px", "negative");
  expect(R"("sensor": {"green_sites": "both"})", "sensor.green_sites", "even");
  expect(R"("ambient": [0, 0, -1])", "ambient", "0 or greater");
  expect(R"("machine": {"affine": [[1, 2, 0], [2, 4, 0]]})", "machine.affine", "determinant is 0");
  expect(R"("machine": {"affine": [[1, 2], [2, 4]]})", "machine.affine[0]", "rows of 3");
  expect(R"("board": {"paper": {"f0": 4}})", "board.paper.f0", "it must be above 0 and at most 1");
  expect(R"("stray_light": {"position_mm": [0, 0, 500], "disk_mm": 600})", "stray_light.disk_mm", "");
  expect(R"("stray_light": {"sun": {"direction": [0, 0, 1], "irradiance": [1, 1, 1]}})", "stray_light", "no near lamp");
  expect(R"("board": {"bow": [0, 0, 0]})", "board.bow", "did you mean \"bow_mm\"?");
  expect(R"("verdict": {"depth_um": {"source": "measured", "degree": "certainly"}})", "verdict.depth_um.degree",
         "\"weakly\"");
  expect(R"("verdict": {"depth_um": {"source": "measured", "degree": "weakly", "causes": [{"cause": "above_noise"}]}})",
         "verdict.depth_um.causes[0].times", "is missing");
  expect(R"("lamps": [])", "lamps", "unknown key");
}

TEST_F(BenchErrors, ANominalBenchOfAFewLinesIsEnough) {
  const Bench bench = read(R"("lights": [{"position_mm": [150, -500, 900], "axis": [0, 1, -1]}])");
  EXPECT_NEAR(bench.lights[0].axis.norm(), 1, 1e-15);
  EXPECT_EQ(bench.lights[0].id, "lamp");
  EXPECT_EQ(bench.material.alpha, Material().alpha);
  EXPECT_EQ(bench.sensor.gain, 1);
  EXPECT_EQ(bench.machine_affine.leftCols<2>(), Eigen::Matrix2d::Identity());
}

TEST_F(BenchErrors, TheCameraModelThatIsMissingIsNamed) {
  const auto file =
      folder_.write("bench.json", R"({"format": "burin/bench", "version": 1, "camera": "other.cameramodel"})");
  EXPECT_THAT([&] { read_bench(file); },
              ThrowsMessage<Error>(AllOf(HasSubstr("other.cameramodel"), HasSubstr("does not exist"))));
}

TEST_F(BenchErrors, ViewsAndLampsAreFoundByName) {
  const Bench bench = full_bench(folder_);
  EXPECT_EQ(&find_view(bench, "v01", "design.json"), &bench.views[1]);
  EXPECT_EQ(find_light(bench, "spot", "design.json").position_mm, bench.lights[0].position_mm);
  EXPECT_THAT([&] { find_view(bench, "v07", "design.json: views[0].view"); },
              ThrowsMessage<Error>(
                  AllOf(HasSubstr("design.json: views[0].view"), HasSubstr("\"v07\""), HasSubstr("v00, v01"))));
  EXPECT_THAT([&] { find_light(Bench(), "lamp", "x"); }, ThrowsMessage<Error>(HasSubstr("none at all")));
}

TEST(Bench, TheNominalBenchOfTheLoopRigIsRead) {
  const std::filesystem::path file = std::filesystem::path(places::rig("bench-loop")) / "bench.json";
  const Bench bench = read_bench(file);
  EXPECT_EQ(bench.views.size(), 3u);
  EXPECT_EQ(bench.lens.intrinsics.size(), 12u);
  EXPECT_EQ(bench.lens.width, 800);
}

/// A bench.json of these views, read for a board of 200 x 150 mm.
Bench bench_of_views(const TemporaryFolder& folder, const std::string& views) {
  folder.write("bench.json", R"({"format": "burin/bench", "version": 2,
    "camera": {"focal_35mm": 50, "pixels": [6000, 4000]}, "views": [)" +
                                 views + "]}");
  Bench bench = read_bench(folder / "bench.json");
  Board board;
  board.size_mm = {200, 150};
  aim_views(bench, board);
  return bench;
}

Eigen::Vector2d seen_at(const Bench& bench, const Eigen::Vector3d& p_board_mm) {
  const std::vector<Eigen::Vector3d> p{bench.views[0].T_camera_board * p_board_mm};
  std::vector<Eigen::Vector2d> q(1);
  project(bench.lens, p, q);
  return q[0];
}

TEST(BenchInWords, EyeLooksAtTheBoardsMiddleWithItsUpperEdgeUp) {
  const TemporaryFolder folder;
  const Bench bench = bench_of_views(folder, R"({"view": "a", "eye_mm": [-300, -100, 900]})");
  EXPECT_LT((bench.views[0].T_camera_board.inverse().translation() - Eigen::Vector3d(-300, -100, 900)).norm(), 1e-9);
  const Eigen::Vector2d middle = seen_at(bench, {100, 75, 0}), above = seen_at(bench, {100, 76, 0});
  EXPECT_LT((middle - Eigen::Vector2d(2999.5, 1999.5)).norm(), 1e-6);
  EXPECT_LT(above.y(), middle.y() - 1);
  EXPECT_NEAR(above.x(), middle.x(), 0.05);  // along the middle column: curvature of a straight line's picture is none
  EXPECT_GT(seen_at(bench, {101, 75, 0}).x(), middle.x() + 1);
}

TEST(BenchInWords, AimAndRollAreObeyed) {
  const TemporaryFolder folder;
  const Bench bench =
      bench_of_views(folder, R"({"view": "a", "eye_mm": [100, 75, 1000], "aim_mm": [20, 30, 5], "roll_deg": 90})");
  const Eigen::Vector2d at = seen_at(bench, {20, 30, 5}), above = seen_at(bench, {20, 31, 5});
  EXPECT_LT((at - Eigen::Vector2d(2999.5, 1999.5)).norm(), 1e-6);
  // The camera was turned clockwise, so what was up lies to the left of its picture.
  EXPECT_LT(above.x(), at.x() - 1);
  EXPECT_NEAR(above.y(), at.y(), 0.6);
}

TEST(BenchInWords, FocalLengthIsThatOfTheFilmsDiagonal) {
  const TemporaryFolder folder;
  const Bench bench = bench_of_views(folder, R"({"view": "a", "eye_mm": [0, 0, 900]})");
  EXPECT_NEAR(bench.lens.intrinsics[0], 50.0 / 36 * 6000, 1e-9);  // 3:2, as the film: any side tells it
  EXPECT_NEAR(nominal_lens(26, 4032, 3024).intrinsics[1], 26 * 5040 / 43.26661530556787, 1e-6);
}

TEST(BenchInWords, OurWriterPutsMatrixAndLensFileInTheirPlace) {
  const TemporaryFolder folder;
  const Bench bench = bench_of_views(folder, R"({"view": "a", "eye_mm": [-300, -100, 900]})");
  write_bench(bench, 400, folder / "again.json");
  const Bench back = read_bench(folder / "again.json");
  EXPECT_EQ(back.views[0].T_camera_board.matrix(), bench.views[0].T_camera_board.matrix());
  EXPECT_EQ(back.lens.intrinsics, bench.lens.intrinsics);
}

TEST(BenchInWords, WithoutABoardNobodyKnowsWhereItsMiddleIs) {
  const TemporaryFolder folder;
  folder.write("bench.json", R"({"format": "burin/bench", "version": 2,
    "camera": {"focal_35mm": 50, "pixels": [6000, 4000]}, "views": [{"view": "a", "eye_mm": [0, 0, 900]}]})");
  const Bench bench = read_bench(folder / "bench.json");
  EXPECT_THAT([&] { find_view(bench, "a", "design.json"); },
              ThrowsMessage<Error>(AllOf(HasSubstr("design.json"), HasSubstr("\"a\""), HasSubstr("aim_mm"))));
  EXPECT_THROW(write_bench(bench, 400, folder / "again.json"), Error);
}

TEST(BenchInWords, NonsenseIsNamed) {
  const TemporaryFolder folder;
  const auto expect = [&](const std::string& view, const std::string& field, const std::string& what) {
    EXPECT_THAT([&] { bench_of_views(folder, R"({"view": "a", )" + view + "}"); },
                ThrowsMessage<Error>(AllOf(HasSubstr("bench.json"), HasSubstr(field), HasSubstr(what))))
        << view;
  };
  expect(R"("eye_mm": [0, 0, 900], "T_camera_board": [[1,0,0,0],[0,-1,0,0],[0,0,-1,800],[0,0,0,1]])",
         "views[0].T_camera_board", "keep one");
  expect(R"("roll_deg": 5, "T_camera_board": [[1,0,0,0],[0,-1,0,0],[0,0,-1,800],[0,0,0,1]])", "views[0].T_camera_board",
         "roll_deg");
  expect(R"("aim_mm": [0, 0, 0])", "views[0].eye_mm", "missing");
  expect(R"("tags": 3)", "views[0].eye_mm", "missing");
  expect(R"("eye_mm": [0, 0, -5])", "views[0].eye_mm", "behind");
  expect(R"("eye_mm": [0, 0, 0])", "views[0].eye_mm", "behind");
  expect(R"("eye_mm": [1, 2, 3], "aim_mm": [1, 2, 3])", "views[0].aim_mm", "where the eye is");
  expect(R"("eye_mm": [1, 2, 3], "aim_mm": [9, 9, 9])", "views[0].aim_mm", "looks away");
  expect(R"("eye_mm": [1, 2], "aim_mm": [9, 9, 0])", "views[0].eye_mm", "");
  const auto camera = [&](const std::string& text, const std::string& field) {
    folder.write("bench.json", R"({"format": "burin/bench", "version": 2, "camera": )" + text + "}");
    EXPECT_THAT([&] { read_bench(folder / "bench.json"); }, ThrowsMessage<Error>(HasSubstr(field))) << text;
  };
  camera(R"({"focal_35mm": 26})", "camera.pixels");
  camera(R"({"pixels": [4000, 3000]})", "camera.focal_35mm");
  camera(R"({"focal_35mm": 0, "pixels": [4000, 3000]})", "camera.focal_35mm");
  camera(R"({"focal_35mm": 26000, "pixels": [4000, 3000]})", "camera.focal_35mm");
  camera(R"({"focal_35mm": 26, "pixels": [4000.5, 3000]})", "camera.pixels");
  camera(R"({"focal_35mm": 26, "pixels": [4000, 3000], "zoom": 2})", "zoom");
}

}  // namespace
}  // namespace burin

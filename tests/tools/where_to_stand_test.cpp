// Proves: a person is told where lamp and camera go, in mm that a ruler finds, with the focus, and with seconds where
// the bench has a scale; of lamps that shine at once where each stands, there, on the sheet and by `burin watch`.
// Oracle: places set out here; the exposure by hand.
#include "tools/where_to_stand.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <numbers>

#include "burin/base/error.h"
#include "tools/sheet/sheet.h"
#include "tools/wanted_bench.h"
#include "tools/watch/wanted_shots.h"

namespace burin {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::Not;

TEST(WhereToStand, SaysPlacesFocusAndExposure) {
  Board board;
  board.size_mm = board.carve_max_mm = {300, 200};
  board.tags.white_albedo = 0.9;
  Bench bench;
  const auto eye = [](const std::string& name, const Eigen::Vector3d& center) {
    View view;
    view.name = name;
    view.T_camera_board.linear() = Eigen::Vector3d(1, -1, -1).asDiagonal();
    view.T_camera_board.translation() = -(view.T_camera_board.linear() * center);
    return view;
  };
  bench.views = {eye("left", {-450, 100, 800}), eye("middle", {150, 100, 1000}), eye("far", {150, 100, 2600})};
  Light light;
  light.id = "ceiling";
  light.position_mm = {150, 900, 600};
  bench.lights = {light};
  DesignSpec design;
  for (const char* name : {"left", "middle"}) {
    DesignView v;
    v.view = name;
    v.light = "ceiling";
    design.views.push_back(v);
  }
  std::string text = where_to_stand(design, bench, board, match_tolerances(design, bench, board, {}));
  EXPECT_THAT(text, AllOf(HasSubstr("lamp \"ceiling\": 600 mm above the face, 150 mm in from the left edge, 700 mm "
                                    "beyond the upper edge\n"),
                          HasSubstr("view \"left\" under \"ceiling\": camera 800 mm above the face, 450 mm beyond the "
                                    "left edge, 100 mm in from the lower edge, aimed at the board's middle (1000 mm "
                                    "away, 37 degrees from straight down); its picture holds within"),
                          HasSubstr("view \"middle\" under \"ceiling\": camera 1000 mm above the board's middle"),
                          HasSubstr("focus: once, at 1000 mm"), Not(HasSubstr("ISO")), Not(HasSubstr("soft"))));
  // A measured lamp has a scale: 0.6 = gain * (0.9 / pi) * I cos / r^2 * s / 64, the lamp 1000 mm away, cos = 0.6.
  bench.lights[0].intensity.setConstant(1e6);
  bench.lights[0].intensity_sigma = Eigen::Vector3d(1, 1, 1);
  bench.sensor.gain = 1e4;
  const double s = 0.6 * 64 / (1e4 * 0.9 / std::numbers::pi * 0.6);
  design.views[1].view = "far";
  text = where_to_stand(design, bench, board, match_tolerances(design, bench, board, {}));
  EXPECT_THAT(text, AllOf(HasSubstr("about 1/" + std::to_string(std::lround(1 / s)) + " s at f/8"), HasSubstr("soft")));
  // Lamps that shine at once are put up one by one, and photographed one by one.
  bench.lights.push_back(light);
  bench.lights[1].id = "window";
  bench.lights[1].position_mm = {-500, 100, 700};
  design.views[1].view = "middle";
  design.views[1].light = "ceiling + window";
  text = where_to_stand(design, bench, board, match_tolerances(design, bench, board, {}));
  EXPECT_THAT(text,
              AllOf(HasSubstr("lamp \"ceiling\": 600 mm above"), HasSubstr("lamp \"window\": 700 mm above"),
                    Not(HasSubstr("lamp \"ceiling +")), HasSubstr("photographed under each of these lamps alone")));
  const std::vector<WantedShot> shots =
      designed_shots(design, bench, board, match_tolerances(design, bench, board, {}));
  ASSERT_EQ(shots.size(), 3U);  // left under the ceiling; middle under each
  EXPECT_EQ(shots[1].light, "ceiling");
  EXPECT_EQ(shots[2].light, "window");
  EXPECT_THAT(shots[2].lamp_place, HasSubstr("700 mm above"));
  EXPECT_EQ(shots[2].tolerance.sideways.least(), default_tolerance(design.views[1], bench, board).eye.sideways.least());
  WantedBench wanted;
  wanted.design = design;
  wanted.board = board;
  wanted.bench = bench;
  wanted.tolerances = match_tolerances(design, bench, board, {});
  const std::vector<SheetPlace> places = sheet_places(wanted);
  ASSERT_EQ(places.size(), 4U);
  EXPECT_EQ(places[0].name, "ceiling");
  EXPECT_EQ(places[1].name, "window");
  EXPECT_EQ(places[1].label, "L2");
  EXPECT_EQ(places[1].at_mm, bench.lights[1].position_mm);

  design.views[1].view = "none";
  EXPECT_THROW(where_to_stand(design, bench, board, {}), Error);
}

}  // namespace
}  // namespace burin

// Proves: a new board's tags lie apart, within the board and outside of the carve area, for boards of all sizes; and
// the eyes placed for it have half vectors 180 degrees / count apart that the grooves reach, judged by check_glints().
#include <gmock/gmock.h>

#include <cmath>
#include <numbers>
#include <set>

#include "burin/base/error.h"
#include "burin/optimize/design/glint.h"
#include "burin/optimize/design/glint_check.h"
#include "burin/optimize/layout/tag_layout.h"
#include "burin/optimize/layout/view_places.h"
#include "tests/temporary_folder.h"

namespace burin {
namespace {

using ::testing::HasSubstr;
using ::testing::ThrowsMessage;

constexpr double kDegree = std::numbers::pi / 180;

TEST(TagLayout, IsReadBackForBoardsOfAllSizes) {
  const TemporaryFolder folder;
  for (const Eigen::Vector2d& size : {Eigen::Vector2d(40, 40),
                                      {60, 60},
                                      {60, 400},
                                      {101.6, 76.2},
                                      {200, 150},
                                      {297, 210},
                                      {150.5, 149.5},
                                      {600, 400},
                                      {1000, 3000}}) {
    const TagSizes sizes = tag_sizes(size);
    EXPECT_LE(sizes.usual_mm, sizes.largest_mm);
    for (const double tag_mm : {4.0, sizes.usual_mm, sizes.largest_mm}) {
      SCOPED_TRACE(testing::Message() << size.transpose() << ", tags of " << tag_mm);
      const Board board = board_with_tags(size, tag_mm);
      write_board(board, folder / "board.json");
      EXPECT_NO_THROW(read_board(folder / "board.json"));  // which refuses papers that overlap
      EXPECT_GE(board.tags.list.size(), 8U);
      EXPECT_LE(board.tags.list.size(), 24U);
      EXPECT_TRUE(((board.carve_max_mm - board.carve_min_mm).array() >= size.array() / 2 - 1).all());
      for (const Tag& tag : board.tags.list) {
        const KeepOut paper = tag_paper(tag, board.tags.family);
        for (const Eigen::Vector2d& corner : paper.polygon_mm) {
          EXPECT_GE(corner.minCoeff(), 0.9);
          EXPECT_GE((size - corner).minCoeff(), 0.9);
          EXPECT_FALSE((corner.array() > board.carve_min_mm.array()).all() &&
                       (corner.array() < board.carve_max_mm.array()).all())
              << "tag " << tag.id << " lies in the carve area";
        }
        EXPECT_EQ(tag.center_mm, tag.center_mm.array().round().matrix());  // a person measures whole mm
      }
    }
  }
}

TEST(TagLayout, RefusesWhatHasNoRoom) {
  EXPECT_THAT([] { tag_sizes({30, 200}); }, ThrowsMessage<Error>(HasSubstr("too small for tags")));
  EXPECT_THROW(tag_sizes({-3, 200}), Error);
  EXPECT_THROW(tag_sizes({200, 1e6}), Error);
  EXPECT_THROW(tag_sizes({200, std::nan("")}), Error);
  EXPECT_THAT([] { board_with_tags({60, 60}, 20); }, ThrowsMessage<Error>(HasSubstr("do not fit")));
}

PlaceQuestion question(int count) {
  PlaceQuestion q;
  q.count = count;
  q.carve_min_mm = {24, 24};
  q.carve_max_mm = {176, 126};
  q.distance_mm = 1000;
  q.lamp_mm = {100, 75 + 643, 766};
  return q;
}

std::vector<GlintView> glints_of(const PlaceQuestion& q, const std::vector<Eigen::Vector3d>& eyes) {
  std::vector<GlintView> views;
  for (std::size_t k = 0; k < eyes.size(); ++k) views.push_back({"v" + std::to_string(k), eyes[k], q.lamp_mm});
  return views;
}

TEST(ViewPlaces, SpreadHalfVectorsOverAllDirectionsWithinReach) {
  for (int count = 1; count <= 9; ++count) {
    SCOPED_TRACE(count);
    const PlaceQuestion q = question(count);
    const auto eyes = view_places(q);
    ASSERT_TRUE(eyes);
    ASSERT_EQ(eyes->size(), static_cast<std::size_t>(count));
    const Eigen::Vector3d middle(100, 75, 0);
    const std::vector<GlintView> views = glints_of(q, *eyes);
    std::vector<double> azimuths;
    for (const GlintView& view : views) {
      EXPECT_NEAR((view.camera_mm - middle).norm(), 1000, 1e-6);
      EXPECT_GT(view.camera_mm.z(), 1000 * std::cos(62.1 * kDegree));
      azimuths.push_back(std::fmod(lean_at(view, middle).azimuth / kDegree + 720, 180));
    }
    std::sort(azimuths.begin(), azimuths.end());
    for (std::size_t k = 1; k < azimuths.size(); ++k) EXPECT_NEAR(azimuths[k] - azimuths[k - 1], 180.0 / count, 1e-6);
    for (std::size_t k = 1; k < eyes->size(); ++k) EXPECT_GE((*eyes)[k].x(), (*eyes)[k - 1].x());
    const auto findings = check_glints(views, q.carve_min_mm, q.carve_max_mm, q.width_um, [&](const Eigen::Vector2d&) {
      return GrooveShape{q.depth_um, q.alpha};
    });
    for (const Finding& finding : findings) ADD_FAILURE() << sentence(finding);
  }
}

TEST(ViewPlaces, StandBeforeABoardWhoseLampIsAbove) {
  // Left and right of it, at much the same height, and not far to the side.
  const auto eyes = view_places(question(3));
  ASSERT_TRUE(eyes);
  EXPECT_LT((*eyes)[0].x(), -300);
  EXPECT_NEAR((*eyes)[1].x(), 100, 60);
  EXPECT_GT((*eyes)[2].x(), 500);
  for (const Eigen::Vector3d& eye : *eyes) {
    EXPECT_LT(std::abs(eye.y() - (*eyes)[1].y()), 300);  // as far as knees bend, a meter away
    EXPECT_GT(eye.z(), 650);
  }
}

TEST(ViewPlaces, FollowALampThatHangsElsewhere) {
  for (const Eigen::Vector3d& lamp :
       {Eigen::Vector3d(-543, 75, 766), {743, 75, 766}, {100, -568, 766}, {100, 75, 1000}, {500, 500, 900}}) {
    PlaceQuestion q = question(3);
    q.lamp_mm = lamp;
    const auto eyes = view_places(q);
    ASSERT_TRUE(eyes) << lamp.transpose();
    EXPECT_THAT(check_glints(glints_of(q, *eyes), q.carve_min_mm, q.carve_max_mm, q.width_um,
                             [&](const Eigen::Vector2d&) {
                               return GrooveShape{q.depth_um, q.alpha};
                             }),
                ::testing::IsEmpty())
        << lamp.transpose();
  }
}

TEST(ViewPlaces, ThereAreNoneForShallowGroovesOrALampBehind) {
  PlaceQuestion q = question(3);
  q.depth_um = 0.5;  // walls of 6 degrees: within the plain face's shine
  EXPECT_FALSE(view_places(q));
  q = question(3);
  q.lamp_mm.z() = -100;
  EXPECT_FALSE(view_places(q));
  q = question(3);
  q.distance_mm = 60;  // half vectors turn by more than the walls reach
  q.lamp_mm = {100, 110, 45};
  EXPECT_FALSE(view_places(q));
}

}  // namespace
}  // namespace burin

// Proves: one photo tells its tags, how bright paper and glints are, its blur, and where it was taken from, each within
// what the drawing allows; faults are named with what to do; a dark photo of a bracket keeps its place. Oracle: photos
// drawn by sampling points of a board through a pinhole (tests/drawn_photo.h), whose blur, exposure and pose are known,
// and a real rig, whose camera places its truth tells.
#include "burin/capture/judge_photo.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <fstream>

#include "burin/base/error.h"
#include "burin/capture/session.h"
#include "burin/simulate/bench_truth.h"
#include "tests/drawn_photo.h"
#include "tests/places.h"
#include "tests/temporary_folder.h"

namespace burin {
namespace {

using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::SizeIs;

struct JudgePhoto : testing::Test {
  TemporaryFolder folder;
  DrawnPhoto photo;

  PhotoFacts judged(const char* name = "a.jpg", const PhotoFacts* before = nullptr) {
    EXPECT_TRUE(write_drawn(photo, folder / name));
    const Lens lens = plain_lens(photo.focal_px, photo.width, photo.height);
    return judge_photo(folder / name, photo.board, &lens, before);
  }
  // Of the drawing's pixels that show the carve area, by the rays through them.
  double drawn_share_above(float value) const {
    const Image image = drawn(photo);
    const Eigen::Isometry3d T_board_camera = photo.T_camera_board.inverse();
    const Eigen::Vector3d eye = T_board_camera.translation();
    int all = 0, above = 0;
    for (int y = 0; y < photo.height; ++y)
      for (int x = 0; x < photo.width; ++x) {
        const Eigen::Vector3d ray =
            T_board_camera.linear() * Eigen::Vector3d((x - (photo.width - 1) / 2.0) / photo.focal_px,
                                                      (y - (photo.height - 1) / 2.0) / photo.focal_px, 1);
        const Eigen::Vector2d q = (eye - eye.z() / ray.z() * ray).head<2>();
        if ((q.array() < photo.board.carve_min_mm.array()).any() ||
            (q.array() > photo.board.carve_max_mm.array()).any())
          continue;
        ++all;
        above += image.at(x, y) >= value;
      }
    return static_cast<double>(above) / all;
  }
  std::vector<Finding> faults(const PhotoFacts& facts, std::vector<const PhotoFacts*> others = {}) const {
    return photo_faults(facts, photo.board, others);
  }
};

TEST_F(JudgePhoto, TellsWhatAPhotoShows) {
  photo.T_camera_board = looking_at_board(photo.board, 520, 20, -15);
  photo.blur_px = 0.9;
  const PhotoFacts facts = judged();
  EXPECT_THAT(facts.tags, SizeIs(6));
  EXPECT_THAT(facts.missing_tags, IsEmpty());
  EXPECT_THAT(facts.stray_tags, IsEmpty());
  EXPECT_NEAR(facts.paper, 0.6, 0.02);  // a level of 8 bits is 0.006 there; blur takes some from small cells
  EXPECT_EQ(facts.paper_clipped, 0);
  ASSERT_TRUE(facts.blur_px);
  EXPECT_NEAR(*facts.blur_px, std::sqrt(0.9 * 0.9 + 1.0 / 12),
              0.08);  // the pixel's square has 1/12; JPEG adds a little
  ASSERT_TRUE(facts.eye_mm());
  // Corners are good to 0.1 px of 1600 a radian: 0.03 mm aside, ten times that in depth.
  EXPECT_LT((*facts.eye_mm() - photo.T_camera_board.inverse().translation()).norm(), 1.5);
  EXPECT_EQ(facts.lens_from, LensFrom::bench);
  EXPECT_NEAR(*facts.exposure_factor, 1.0 / 60 / 64, 1e-8);
  ASSERT_TRUE(facts.glints_clipped);
  EXPECT_NEAR(*facts.glints_clipped, drawn_share_above(0.96F), 0.01);  // a pixel's width around the carve area and tags
  EXPECT_TRUE(shows_tags_well(facts, photo.board));
  EXPECT_FALSE(holds_glints(facts));
  EXPECT_THAT(faults(facts), IsEmpty());
}

TEST_F(JudgePhoto, GlintsAreHeldOnceNoneIsClipped) {
  photo.paper = 0.6 / 16;
  const PhotoFacts facts = judged();
  EXPECT_TRUE(holds_glints(facts));
  EXPECT_NEAR(*facts.glints_bright, 12 * 0.6 / 16, 0.03);
  EXPECT_FALSE(shows_tags_well(facts, photo.board)) << "paper at 4 % is for the glints alone";
  EXPECT_THAT(faults(facts), IsEmpty()) << "a bracket has dark photos";
}

TEST_F(JudgePhoto, ClippedPaperIsNotTakenForBright) {
  photo.paper = 3;
  const PhotoFacts facts = judged();
  EXPECT_GT(facts.paper_clipped, 0.9);
  EXPECT_FALSE(shows_tags_well(facts, photo.board));
}

TEST_F(JudgePhoto, SaysWhichTagsAreMissingAndWhichLieElsewhere) {
  photo.left_out = {11, 14};
  photo.moved_mm[15] = {-9, 4};
  const PhotoFacts facts = judged();
  EXPECT_THAT(facts.missing_tags, ElementsAre(11, 14));
  EXPECT_THAT(facts.stray_tags, ElementsAre(15));
  // It lies where it must not, and leaves the pose alone.
  EXPECT_LT((*facts.eye_mm() - photo.T_camera_board.inverse().translation()).norm(), 3);
  EXPECT_THAT(faults(facts), ElementsAre(testing::Field(&Finding::what, HasSubstr("tag 15 does not lie where"))));
}

TEST_F(JudgePhoto, TooFewTagsCannotBeUsed) {
  photo.left_out = {10, 11, 12};
  const auto found = faults(judged());
  ASSERT_THAT(found, SizeIs(1));
  EXPECT_TRUE(has_errors(found));
  EXPECT_THAT(found[0].what, HasSubstr("shows 3 of the board's 6 tags (not 10, 11, 12)"));
}

TEST_F(JudgePhoto, TellsBlurFromShake) {
  const PhotoFacts sharp = judged("sharp.jpg");
  EXPECT_THAT(faults(sharp), IsEmpty());
  photo.blur_px = 2;
  const PhotoFacts soft = judged("soft.jpg");
  EXPECT_NEAR(*soft.blur_px, 2, 0.2);  // a tag's cells are 8 px wide: wider edges run into each other
  ASSERT_THAT(faults(soft, {&sharp}), SizeIs(1));
  EXPECT_THAT(sentence(faults(soft, {&sharp})[0]), AllOf(HasSubstr("is blurred"), HasSubstr("focus once by hand")));
  EXPECT_THAT(faults(soft, {&soft}), IsEmpty()) << "as soft as all others: preflight's matter";
  photo.blur_px = 0.8;
  photo.shake_px = 9;
  const PhotoFacts shaken = judged("shaken.jpg");
  EXPECT_GT(shaken.one_way_blur, 1.6);
  ASSERT_THAT(faults(shaken, {&sharp}), SizeIs(1));
  EXPECT_THAT(sentence(faults(shaken, {&sharp})[0]), AllOf(HasSubstr("was shaken"), HasSubstr("remote release")));
}

TEST_F(JudgePhoto, LensIsThePhotosOwnWhereTheBenchMeansAnother) {
  photo.T_camera_board = looking_at_board(photo.board, 520, 25, 10);
  photo.focal_35mm = 61;  // 43.267 / hypot(900, 700) * 1600 = 60.7
  ASSERT_TRUE(write_drawn(photo, folder / "a.jpg"));
  const Lens tele = plain_lens(3000, 900, 700);
  const PhotoFacts facts = judge_photo(folder / "a.jpg", photo.board, &tele);
  EXPECT_EQ(facts.lens_from, LensFrom::exif);
  EXPECT_NEAR((*facts.eye_mm() - Eigen::Vector3d(100, 75, 0)).norm(), 520, 520 * 0.02);  // 61 is rounded
  photo.focal_35mm = 0;
  ASSERT_TRUE(write_drawn(photo, folder / "b.jpg"));
  const PhotoFacts own = judge_photo(folder / "b.jpg", photo.board);
  EXPECT_EQ(own.lens_from, LensFrom::photo);
  EXPECT_NEAR(own.focal_px, 1600, 1600 * 0.06);  // in steps of 3 %, tilted by 27 degrees
}

TEST_F(JudgePhoto, BenchsLensFitsAPhotoOfAnotherSize) {
  ASSERT_TRUE(write_drawn(photo, folder / "a.jpg"));
  const Lens half = plain_lens(800, 450, 350);
  const PhotoFacts facts = judge_photo(folder / "a.jpg", photo.board, &half);
  EXPECT_NEAR(facts.focal_px, 1600, 4);
  EXPECT_NEAR(facts.eye_mm()->z(), 500, 3);
}

// The dark end of a bracket shows no tag: it stands where the photo before it did, if that was just now.
TEST_F(JudgePhoto, DarkPhotoKeepsThePlaceOfTheOneBefore) {
  const PhotoFacts paper = judged("1.jpg");
  photo.paper = 0.00005;  // a sixth of the lowest level of 8 bits
  photo.glint = 10000;
  photo.exposure_s = 1.0 / 8000;
  photo.taken_at = "2024:05:01 12:00:09";
  PhotoFacts dark = judged("2.jpg", &paper);
  EXPECT_THAT(dark.tags, IsEmpty());
  EXPECT_TRUE(dark.place_of_before);
  EXPECT_EQ(*dark.eye_mm(), *paper.eye_mm());
  ASSERT_TRUE(dark.glints_clipped) << "glints are judged where the carve area was";
  EXPECT_TRUE(holds_glints(dark));
  EXPECT_THAT(faults(dark, {&paper}), IsEmpty());
  photo.taken_at = "2024:05:01 12:05:00";
  dark = judged("3.jpg", &paper);
  EXPECT_FALSE(dark.place_of_before) << "five minutes later it may stand anywhere";
  EXPECT_TRUE(has_errors(faults(dark, {&paper})));
}

TEST_F(JudgePhoto, NamesWhatAFileLacksOrHasOtherwise) {
  const PhotoFacts usual = judged("usual.jpg");
  photo.exposure_s = 0;
  EXPECT_THAT(faults(judged("a.jpg"))[0].what, HasSubstr("no exposure time"));
  photo = DrawnPhoto();
  photo.f_number = 5.6;
  EXPECT_THAT(faults(judged("b.jpg"), {&usual})[0].what, HasSubstr("f/5.6, others at f/8"));
  photo = DrawnPhoto();
  photo.model = "Phone 9";
  EXPECT_THAT(faults(judged("c.jpg"), {&usual})[0].what, HasSubstr("with a Phone 9, others with a M12"));
  photo = DrawnPhoto();
  std::swap(photo.width, photo.height);
  photo.focal_px = 1400;
  EXPECT_THAT(sentence(faults(judged("d.jpg"), {&usual})[0]),
              AllOf(HasSubstr("is 700 x 900 pixels where others are 900 x 700"), HasSubstr("hold the phone")));
}

TEST_F(JudgePhoto, BrokenFilesAreErrors) {
  ASSERT_TRUE(write_drawn(photo, folder / "a.jpg"));
  const std::string whole = file_text(folder / "a.jpg");
  for (const std::size_t size : {std::size_t{0}, std::size_t{20}, whole.size() / 2}) {
    folder.write("b.jpg", whole.substr(0, size));
    EXPECT_THROW(judge_photo(folder / "b.jpg", photo.board), Error) << size << " bytes";
  }
  folder.write("c.jpg", "no picture at all");
  EXPECT_THROW(judge_photo(folder / "c.jpg", photo.board), Error);
}

TEST_F(JudgePhoto, HeicOfAPhone) {
  if (!write_drawn(photo, folder / "a.heic")) GTEST_SKIP() << "this libheif has no encoder";
  const PhotoFacts facts = judge_photo(folder / "a.heic", photo.board);
  EXPECT_THAT(facts.tags, SizeIs(6));
  EXPECT_NEAR(facts.paper, 0.6, 0.03);
  EXPECT_THAT(faults(facts), IsEmpty());
}

// A real rig, by brute force: where its cameras stood, through the lens that they had.
TEST(JudgePhotoOfARig, FindsThePlaces) {
  const std::filesystem::path rig = places::rig("b-small");
  const BenchTruth truth = read_bench_truth(rig / "truth.json");
  const Session session = read_session(rig / "session.json");
  const Board board = read_board(rig / "board.json");
  int judged = 0;
  for (std::size_t i = 0; i < session.photos.size(); i += 3) {
    const Photo& photo = session.photos[i];
    const PhotoFacts facts = judge_photo(photo.file, board, &truth.lens);
    const auto view = std::find_if(truth.views.begin(), truth.views.end(), [&](const TruthView& v) {
      return std::any_of(v.photos.begin(), v.photos.end(),
                         [&](const TruthPhoto& p) { return p.file.filename() == photo.file.filename(); });
    });
    ASSERT_NE(view, truth.views.end()) << photo.file;
    ASSERT_TRUE(facts.eye_mm()) << photo.file;
    const Eigen::Vector3d eye = view->T_camera_board.inverse().translation();
    EXPECT_LT((*facts.eye_mm() - eye).norm(), 0.01 * eye.norm()) << photo.file;  // bow and tags 0.2 mm aside
    ++judged;
  }
  EXPECT_GT(judged, 1);
}

}  // namespace
}  // namespace burin

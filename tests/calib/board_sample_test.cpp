// What is proved: of a crowded board squares all over it are looked at, as large as they may be, smaller ones within
// larger ones; photos show nothing else; and there they show what photos of the whole board do.
#include "burin/calib/photo/board_sample.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>

#include "burin/calib/photo/photo_problem.h"
#include "burin/scene/crossings.h"
#include "tests/calib/small_grooves.h"

namespace burin {
namespace {

Scratches strewn(std::size_t count, double size_mm, double length_mm) {
  std::mt19937_64 random(3);
  std::uniform_real_distribution<double> place(0.05 * size_mm, 0.95 * size_mm), turn(0, std::numbers::pi);
  Scratches s;
  for (std::size_t i = 0; i < count; ++i) {
    const double a = turn(random), x = place(random), y = place(random), half = length_mm / 2;
    s.x0_mm.push_back(x - half * std::cos(a));
    s.y0_mm.push_back(y - half * std::sin(a));
    s.x1_mm.push_back(x + half * std::cos(a));
    s.y1_mm.push_back(y + half * std::sin(a));
  }
  return s;
}

Board square_board(double size_mm) {
  Board board;
  board.size_mm = {size_mm, size_mm};
  board.carve_min_mm = {0, 0};
  board.carve_max_mm = {size_mm, size_mm};
  board.tool_width_um = 200;
  board.material.depth_um = 12;
  return board;
}

TEST(BoardSample, HoldsAsManyPiecesAsItMay) {
  const Board board = square_board(200);
  const Scratches scratches = strewn(3000, 200, 30);
  Bench bench;
  bench.crossings = Crossings::deepest;
  bench.material.depth_um = 12;
  for (const double most : {20'000.0, 60'000.0}) {
    const BoardSample sample = sample_of(scratches, board, most);
    ASSERT_EQ(sample.squares.size(), 16U);
    EXPECT_LE(sample.pieces, most);
    // Foretold are two a crossing; where crossings are few they are up to five (crossings.h).
    const Carved carved = carve(Sent(scratches), bench, board, sample.squares);
    EXPECT_LT(static_cast<double>(carved.size()), 2.5 * most);
    EXPECT_GT(static_cast<double>(carved.size()), 0.4 * most);
  }
  EXPECT_TRUE(sample_of(scratches, board, 1e7).is_whole());
}

TEST(BoardSample, OfASmallerOneLiesWithinALargerOne) {
  const Board board = square_board(200);
  const Scratches scratches = strewn(3000, 200, 30);
  const BoardSample large = sample_of(scratches, board, 60'000), small = sample_of(scratches, board, 20'000);
  ASSERT_EQ(large.squares.size(), small.squares.size());
  for (std::size_t i = 0; i < large.squares.size(); ++i) EXPECT_TRUE(large.squares[i].contains(small.squares[i]));
}

TEST(BoardSample, LooksWhereSomethingIsCarved) {
  const Board board = square_board(200);
  Scratches corner = strewn(3000, 50, 8);  // one sixteenth of the board
  const BoardSample sample = sample_of(corner, board, 4'000);
  ASSERT_FALSE(sample.is_whole());
  EXPECT_LE(sample.squares.size(), 4U);
  EXPECT_TRUE(sample.holds({25, 25}));
  EXPECT_FALSE(sample.holds({150, 150}));
}

// Photos of a sample, and of the whole: the same values in every pixel that counts, by far fewer pieces.
TEST(BoardSample, ShowsWhatTheWholeShows) {
  SmallGrooves s;
  fill_small_grooves(s, 11);
  Problem& data = s.data;
  for (int k = 0; k < 6; ++k) data.photos.push_back(make_photo_data(add_view(s, k), 1, s.board, s.bench, 2));
  data.model.crossings = Crossings::deepest;
  const Unknowns x = s.truth.of(0);
  const Carved whole = carved_at(data.model, x);
  BoardSample sample;
  for (const double low : {14.0, 34.0}) {
    sample.squares.emplace_back(Eigen::Vector2d(low, low), Eigen::Vector2d(low + 10, low + 10));
    sample.surroundings.emplace_back(Eigen::Vector2d(low - 3, low - 3), Eigen::Vector2d(low + 13, low + 13));
  }
  Problem part = data;
  part.model.sample = sample;
  for (PhotoData& photo : part.photos) show_only(sample, photo);
  const Carved carved = carved_at(part.model, x);
  EXPECT_LT(2 * carved.size(), whole.size());
  std::size_t used = 0, all = 0;
  for (std::size_t k = 0; k < data.photos.size(); ++k) {
    const Image of_whole = predict(data.model, data.photos[k], x, whole),
                of_part = predict(part.model, part.photos[k], x, carved);
    const float brightest = *std::max_element(of_whole.data.begin(), of_whole.data.end());
    for (std::size_t i = 0; i < of_whole.data.size(); ++i) {
      all += data.photos[k].weight[i] > 0;
      if (!(part.photos[k].weight[i] > 0)) continue;
      ++used;
      EXPECT_NEAR(of_part.data[i], of_whole.data[i], 1e-4F * brightest) << k << ' ' << i;
    }
  }
  EXPECT_GT(used, 100U);
  EXPECT_LT(used, all / 5);
}

}  // namespace
}  // namespace burin

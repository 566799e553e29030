// Proves: scratches.csv goes out and in again to its 1e-5 mm, every faulty line is named, real files are read whole.
#include "burin/scene/scratches.h"

#include "burin/scene/carve.h"
#include "tests/places.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/Dense>

#include <array>
#include <cmath>
#include <limits>
#include <vector>

#include "burin/base/error.h"
#include "tests/temporary_folder.h"

namespace burin {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::ThrowsMessage;

constexpr const char* kHeader = "x0_mm,y0_mm,x1_mm,y1_mm\n";

Scratches scratches_of_text(const std::string& text) {
  const TemporaryFolder folder;
  return read_scratches(folder.write("scratches.csv", text));
}

TEST(Scratches, RoundTrip) {
  const TemporaryFolder folder;
  Scratches s;
  for (int i = 0; i < 1000; ++i) {
    s.x0_mm.push_back(i * 0.299 - 3), s.y0_mm.push_back(300 * std::sin(i)), s.x1_mm.push_back(i / 7.0);
    s.y1_mm.push_back(1e-5 * i - 700), s.width_um.push_back(400 + i), s.depth_um.push_back(10 + 1e-4 * i);
    s.alpha.push_back(0.04 + 1e-6 * i);
  }
  write_scratches(s, folder / "s.csv");
  const Scratches back = read_scratches(folder / "s.csv");
  ASSERT_EQ(back.size(), s.size());
  for (std::size_t i = 0; i < s.size(); ++i) {
    EXPECT_NEAR(back.x0_mm[i], s.x0_mm[i], 0.5001e-5);  // five decimals, rounded
    EXPECT_NEAR(back.y0_mm[i], s.y0_mm[i], 0.5001e-5);
    EXPECT_NEAR(back.x1_mm[i], s.x1_mm[i], 0.5001e-5);
    EXPECT_NEAR(back.y1_mm[i], s.y1_mm[i], 0.5001e-5);
    EXPECT_NEAR(back.depth_um[i], s.depth_um[i], 1e-7);
    EXPECT_NEAR(back.alpha[i], s.alpha[i], 1e-10);
  }
  write_scratches(back, folder / "again.csv");
  EXPECT_EQ(file_text(folder / "again.csv"), file_text(folder / "s.csv"));
}

TEST(Scratches, HeaderOnlyIsABoardWithoutScratches) {
  EXPECT_EQ(scratches_of_text(kHeader).size(), 0u);
  EXPECT_EQ(scratches_of_text("x0_mm,y0_mm,x1_mm,y1_mm").size(), 0u);
  const TemporaryFolder folder;
  write_scratches({}, folder / "none.csv");
  EXPECT_EQ(file_text(folder / "none.csv"), kHeader);
}

TEST(Scratches, WhatSpreadsheetsWriteIsRead) {
  const Scratches s = scratches_of_text("\xEF\xBB\xBFy0_mm, x0_mm ,x1_mm,y1_mm,alpha\r\n1, 2,3,+4.5,.05\r\n\r\n");
  ASSERT_EQ(s.size(), 1u);
  EXPECT_EQ(s.x0_mm[0], 2);
  EXPECT_EQ(s.y0_mm[0], 1);
  EXPECT_EQ(s.y1_mm[0], 4.5);
  EXPECT_EQ(s.alpha[0], 0.05);
  EXPECT_TRUE(s.depth_um.empty());
}

TEST(Scratches, FaultyLinesAreNamed) {
  const auto expect = [](const std::string& text, const auto& message) {
    EXPECT_THAT([&] { scratches_of_text(text); }, ThrowsMessage<Error>(message)) << text;
  };
  const std::string head = kHeader, good = "1,2,3,4\n";
  expect(head + good + "1,nan,3,4\n", AllOf(HasSubstr("scratches.csv:3"), HasSubstr("y0_mm is \"nan\"")));
  expect(head + "1,2,inf,4\n", AllOf(HasSubstr("scratches.csv:2"), HasSubstr("x1_mm")));
  expect(head + "1,2,1e999,4\n", AllOf(HasSubstr("scratches.csv:2"), HasSubstr("x1_mm")));
  expect(head + good + good + "5,5,5,5\n", AllOf(HasSubstr("scratches.csv:4"), HasSubstr("no length")));
  expect(head + "5,5,5.0000001,5\n", HasSubstr("no length"));
  expect(head + "1,2,3\n", AllOf(HasSubstr("scratches.csv:2"), HasSubstr("3 values")));
  expect(head + "1,2,3,4,5\n", AllOf(HasSubstr("scratches.csv:2"), HasSubstr("more than 4")));
  expect(head + "1,2,,4\n", AllOf(HasSubstr("scratches.csv:2"), HasSubstr("x1_mm is \"\"")));
  expect(head + "1;2;3;4\n", HasSubstr("scratches.csv:2"));
  expect(head + "0x1,2,3,4\n", HasSubstr("x0_mm is \"0x1\""));
  expect("x0_mm,y0_mm,x1_mm\n1,2,3\n", AllOf(HasSubstr("scratches.csv:1"), HasSubstr("column y1_mm is missing")));
  expect("x0_mm,y0_mm,x1_mm,y1_mm,dept_um\n", HasSubstr("unknown column \"dept_um\""));
  expect("x0_mm,y0_mm,x1_mm,y1_mm,x0_mm\n", HasSubstr("appears twice"));
  expect("x0_mm,y0_mm,x1_mm,y1_mm,depth_um\n1,2,3,4,0\n", HasSubstr("depth_um is 0"));
  expect("x0_mm,y0_mm,x1_mm,y1_mm,alpha\n1,2,3,4,1.5\n", HasSubstr("alpha is greater than 1"));
  expect("", HasSubstr("x0_mm is missing"));
  expect("1,2,3,4\n", HasSubstr("unknown column \"1\""));
}

TEST(Scratches, ChosenAndJoinedRowsKeepAllTheyHave) {
  Scratches s;
  double next = 1;
  for (const auto column :
       {&Scratches::x0_mm, &Scratches::y0_mm, &Scratches::x1_mm, &Scratches::y1_mm, &Scratches::width_um,
        &Scratches::depth_um, &Scratches::alpha, &Scratches::carved, &Scratches::left})
    for (int row = 0; row < 3; ++row) (s.*column).push_back(0.01 * next++);
  const std::array<std::size_t, 2> rows{2, 0};
  const Scratches chosen = selected(s, rows);
  EXPECT_EQ(chosen.y0_mm, (std::vector<double>{s.y0_mm[2], s.y0_mm[0]}));
  EXPECT_EQ(chosen.left, (std::vector<double>{s.left[2], s.left[0]}));

  Scratches plain;
  plain.x0_mm = plain.y0_mm = plain.x1_mm = plain.y1_mm = {1};
  const Scratches both = joined(plain, s, 300, 12, 0.05);
  EXPECT_EQ(both.width_um, (std::vector<double>{300, s.width_um[0], s.width_um[1], s.width_um[2]}));
  EXPECT_EQ(both.left, (std::vector<double>{1, s.left[0], s.left[1], s.left[2]}));
}

TEST(Scratches, NothingUnusableIsWritten) {
  const TemporaryFolder folder;
  Scratches s{{1, 1}, {2, 2}, {3, 3}, {4, std::nan("")}, {}, {}, {}};
  EXPECT_THAT([&] { write_scratches(s, folder / "s.csv"); },
              ThrowsMessage<Error>(AllOf(HasSubstr("s.csv"), HasSubstr("scratch 1"), HasSubstr("y1_mm"))));
  s.y1_mm = {4, 5};
  s.depth_um = {1};
  EXPECT_THAT([&] { write_scratches(s, folder / "s.csv"); },
              ThrowsMessage<Error>(HasSubstr("depth_um has 1 values for 2")));
  EXPECT_EQ(folder.file_count(), 0u);
}

TEST(Scratches, TheRigsCarvedScratchesAreTheDesignedOnesThroughTheirAffine) {
  const std::filesystem::path rig = places::rig("b-small");
  const Scratches designed = read_scratches(rig / "scratches.csv"), carved = read_scratches(rig / "carved.csv");
  ASSERT_EQ(designed.size(), 8000u);
  ASSERT_EQ(carved.size(), 8000u);
  EXPECT_EQ(carved.depth_um.size(), 8000u);
  // Three ends give the affine map; the other 15,997 must follow it to the files' rounding.
  Eigen::Matrix3d from, to;
  for (int k = 0; k < 3; ++k) {
    const std::size_t i = static_cast<std::size_t>(k) * 2999;
    from.col(k) << designed.x0_mm[i], designed.y0_mm[i], 1;
    to.col(k) << carved.x0_mm[i], carved.y0_mm[i], 1;
  }
  const Eigen::Matrix<double, 2, 3> affine = (to * from.inverse()).topRows<2>();
  Bench bench;
  bench.machine_affine = affine;
  const Scratches predicted = carve(Sent(designed), bench, Board()).scratches;
  double worst_mm = 0;
  for (std::size_t i = 0; i < designed.size(); ++i)
    worst_mm = std::max({worst_mm, std::abs(predicted.x0_mm[i] - carved.x0_mm[i]),
                         std::abs(predicted.y0_mm[i] - carved.y0_mm[i]), std::abs(predicted.x1_mm[i] - carved.x1_mm[i]),
                         std::abs(predicted.y1_mm[i] - carved.y1_mm[i])});
  EXPECT_LT(worst_mm, 5e-4);  // ends are written to 1e-4 mm, three of them carry the map to the far corner
}

}  // namespace
}  // namespace burin

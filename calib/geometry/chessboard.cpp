#include "burin/calib/geometry/chessboard.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <opencv2/calib3d.hpp>
#include <opencv2/core/version.hpp>
#include <opencv2/imgproc.hpp>
#if CV_VERSION_MAJOR >= 5
#include <opencv2/objdetect.hpp>  // findChessboardCorners
#endif
#include <optional>
#include <utility>
#include <vector>

#include "burin/base/error.h"
#include "burin/base/files/table.h"
#include "burin/base/limits.h"
#include "burin/base/median.h"
#include "burin/capture/photo.h"
#include "burin/capture/photo_source.h"

namespace burin {
namespace {

Eigen::Vector2d corner_mm(const Chessboard& board, int k) {
  const int column = k % board.columns, row = k / board.columns;
  return board.square_mm * Eigen::Vector2d(column, row);
}

cv::Mat eight_bits(const Image& linear) {
  cv::Mat gray(linear.height, linear.width, CV_8U);
  for (std::size_t i = 0; i < gray.total(); ++i) {
    float sum = 0;
    for (int c = 0; c < linear.channels; ++c) sum += linear.data[i * linear.channels + c];
    const float value = linear_to_srgb(sum / static_cast<float>(linear.channels));
    gray.data[i] = static_cast<std::uint8_t>(std::lround(255 * std::clamp(value, 0.0F, 1.0F)));
  }
  return gray;
}

// Corrects uneven light: each pixel relative to the mean around it.
cv::Mat evenly_lit(const cv::Mat& gray) {
  constexpr double kMean = 128;
  const int around = gray.cols / 8 | 1;  // some squares of a board that fills the picture
  cv::Mat value, mean, out;
  gray.convertTo(value, CV_32F);
  cv::blur(value, mean, {around, around}, {-1, -1}, cv::BORDER_REFLECT);
  cv::Mat(value / (mean + 1)).convertTo(out, CV_8U, kMean);
  return out;
}

// Contrast of a place as a corner of four squares: the brightness of two opposite quarters against the other two. `u`
// and `v` run along the sides of squares. Empty outside the picture.
std::optional<double> saddle_at(const cv::Mat& gray, const cv::Point2f& at, const cv::Point2f& u,
                                const cv::Point2f& v) {
  constexpr float kWithin = 0.3F;  // of a square
  double sum = 0;
  for (const float a : {-kWithin, kWithin})
    for (const float b : {-kWithin, kWithin}) {
      const cv::Point2f p = at + a * u + b * v;
      const int x = cvRound(p.x), y = cvRound(p.y);
      if (x < 0 || y < 0 || x >= gray.cols || y >= gray.rows) return std::nullopt;
      sum += (a * b > 0 ? 1 : -1) * static_cast<double>(gray.at<std::uint8_t>(y, x));
    }
  return std::abs(sum);
}

// True if squares continue beyond a side of the corners, which then are a part of a larger board. One step outside a
// whole board, its outermost squares meet the white margin, with half of the contrast.
bool goes_on(const cv::Mat& gray, const Chessboard& board, const std::vector<cv::Point2f>& corners) {
  constexpr double kMeet = 0.75;
  const auto corner = [&](int row, int column) {
    return corners[static_cast<std::size_t>(row * board.columns + column)];
  };
  // Border corner k of a side, and its inner neighbor.
  const auto side_goes_on = [&](int count, const auto& outer, const auto& inner) {
    std::vector<double> ratios;
    for (int k = 0; k < count; ++k) {
      const cv::Point2f u = outer(k) - inner(k), v = k + 1 < count ? outer(k + 1) - outer(k) : outer(k) - outer(k - 1);
      const std::optional<double> here = saddle_at(gray, outer(k), u, v), beyond = saddle_at(gray, outer(k) + u, u, v);
      if (here && beyond && *here > 0) ratios.push_back(*beyond / *here);
    }
    return !ratios.empty() && median_of(std::move(ratios)) > kMeet;
  };
  const int rows = board.rows, columns = board.columns;
  return side_goes_on(
             columns, [&](int k) { return corner(0, k); }, [&](int k) { return corner(1, k); }) ||
         side_goes_on(
             columns, [&](int k) { return corner(rows - 1, k); }, [&](int k) { return corner(rows - 2, k); }) ||
         side_goes_on(
             rows, [&](int k) { return corner(k, 0); }, [&](int k) { return corner(k, 1); }) ||
         side_goes_on(
             rows, [&](int k) { return corner(k, columns - 1); }, [&](int k) { return corner(k, columns - 2); });
}

// All corners of a board, row by row. The quick check rejects boards in uneven light, but it runs first, since most
// photos pass it. The thorough search also finds a part of a board with more corners, which is another board.
bool find_corners(const cv::Mat& gray, const Chessboard& board, std::vector<cv::Point2f>& corners) {
  constexpr int kThorough = cv::CALIB_CB_ADAPTIVE_THRESH | cv::CALIB_CB_NORMALIZE_IMAGE;
  const cv::Size size(board.columns, board.rows);
  if (cv::findChessboardCorners(gray, size, corners, kThorough | cv::CALIB_CB_FAST_CHECK)) return true;
  if (cv::findChessboardCorners(gray, size, corners, kThorough)) return !goes_on(gray, board, corners);
  const cv::Mat even = evenly_lit(gray);
  return cv::findChessboardCorners(even, size, corners, kThorough) && !goes_on(even, board, corners);
}

// Corners found on a picture of at most kSearchWidth pixels, and refined on the whole picture.
struct Corners {
  std::vector<cv::Point2f> q;
  bool crowded = false;  // the windows extend half way to the next corner, or further
};
std::optional<Corners> corners_in(const cv::Mat& gray, const Chessboard& board, int window_px) {
  constexpr double kSearchWidth = 1600;
  if (std::min(gray.cols, gray.rows) < limit::kLeastPhotoSide) return std::nullopt;
  const double scale = std::max(1.0, gray.cols / kSearchWidth);
  cv::Mat small = gray;
  if (scale > 1) cv::resize(gray, small, {}, 1 / scale, 1 / scale, cv::INTER_AREA);
  std::vector<cv::Point2f> corners;
  if (!find_corners(small, board, corners)) return std::nullopt;
  double nearest = std::numeric_limits<double>::infinity();
  for (cv::Point2f& p : corners) p = (p + cv::Point2f(0.5F, 0.5F)) * scale - cv::Point2f(0.5F, 0.5F);
  for (std::size_t i = 0; i + 1 < corners.size(); ++i)
    if ((i + 1) % static_cast<std::size_t>(board.columns) != 0)
      nearest = std::min(nearest, static_cast<double>(cv::norm(corners[i + 1] - corners[i])));
  // The window of a saddle point must end short of its neighbors.
  const int room = std::max(3, static_cast<int>(0.45 * nearest));
  const int usual = static_cast<int>(std::lround((window_px > 0 ? window_px : kCornerWindow_px) * scale));
  const int reach = window_px > 0 ? usual : std::min(room, usual);
  cv::cornerSubPix(gray, corners, {reach, reach}, {-1, -1},
                   cv::TermCriteria(cv::TermCriteria::EPS + cv::TermCriteria::COUNT, 30, scale > 1 ? 0.01 : 0.1));
  return Corners{std::move(corners), reach > room};
}

}  // namespace

ChessboardViews find_chessboards(const std::filesystem::path& folder, const Chessboard& board, int corner_window_px,
                                 const Progress& progress) {
  ChessboardViews out;
  std::vector<IncomingPhoto> photos;
  const PhotoSource source = folder_source(folder, out.findings);
  while (auto photo = source()) photos.push_back(std::move(*photo));
  std::filesystem::path first;
  for (std::size_t i = 0; i < photos.size(); ++i) {
    if (progress) progress("finding chessboards", static_cast<double>(i) / static_cast<double>(photos.size()));
    if (!photos[i].unreadable.empty()) {
      out.findings.push_back({FindingCode::photo_omitted, Finding::Severity::warning, {}, photos[i].unreadable, ""});
      continue;
    }
    Photo photo;
    photo.file = photos[i].file;
    photo.encoding = encoding_of(photos[i].exif).encoding;
    const LinearPhoto linear = read_photo(photo);
    if (out.width == 0) {
      out.width = linear.value.width;
      out.height = linear.value.height;
      first = photo.file;
    } else if (linear.value.width != out.width || linear.value.height != out.height) {
      fail(photo.file.string(),
           "is " + std::to_string(linear.value.width) + " x " + std::to_string(linear.value.height) + " pixels, but " +
               first.string() + " is " + std::to_string(out.width) + " x " + std::to_string(out.height),
           "give photos of one camera, unrotated, uncropped and at one size");
    }
    const auto corners = corners_in(eight_bits(linear.value), board, corner_window_px);
    if (!corners) {
      out.findings.push_back({FindingCode::photo_omitted, Finding::Severity::warning, photo.file,
                              "is left out: no chessboard with " + std::to_string(board.columns) + " x " +
                                  std::to_string(board.rows) + " inner corners was found in it",
                              "keep the whole board in the photo, sharp, evenly lit, with a white margin around it"});
      continue;
    }
    if (corners->crowded)
      out.findings.push_back({FindingCode::tags_small, Finding::Severity::warning, photo.file,
                              "its squares are small for the window in which corners are refined",
                              "try --corner-window 0, which fits it to the squares"});
    TargetView view{photo.file.filename().string(), {}, {}, {}};
    for (std::size_t k = 0; k < corners->q.size(); ++k) {
      view.p_target_mm.push_back(corner_mm(board, static_cast<int>(k)));
      view.q_px.emplace_back(corners->q[k].x, corners->q[k].y);
    }
    out.views.push_back(std::move(view));
  }
  return out;
}

ChessboardViews read_corners(const std::filesystem::path& vnl, const Chessboard& board, int width, int height) {
  TableReader table(vnl, TableStyle::vnlog, {"filename", "x", "y"},
                    "give a corners.vnl as mrcal's tools read it: # filename x y level");
  ChessboardViews out;
  out.width = width;
  out.height = height;
  std::string current;
  int seen = 0;
  TargetView view;
  const auto finish = [&](const std::string& where) {
    if (current.empty()) return;
    if (seen != board.columns * board.rows && seen != 1)
      fail(where,
           current + " has " + std::to_string(seen) + " corners, a board of " + std::to_string(board.columns) + " x " +
               std::to_string(board.rows) + " has " + std::to_string(board.columns * board.rows),
           "give the number of inner corners with --chessboard COLUMNSxROWS");
    constexpr std::size_t kFewest = 8;
    if (view.q_px.size() >= kFewest)
      out.views.push_back(view);
    else
      out.findings.push_back({FindingCode::photo_omitted, Finding::Severity::warning, current,
                              "is left out: it has " + std::to_string(view.q_px.size()) + " corners", ""});
  };
  while (table.next()) {
    const std::size_t file = *table.find("filename"), x = *table.find("x"), y = *table.find("y");
    const std::string where = table.where();
    table.text(std::max({file, x, y}));  // checks that the row is long enough
    if (table.text(file) != current) {
      finish(where);
      current = table.text(file);
      view = {std::filesystem::path(current).filename().string(), {}, {}, {}};
      seen = 0;
    }
    const int k = seen++;
    if (!table.has(x) || !table.has(y)) continue;
    double weight = 1;
    const auto level = table.find("level"), given = table.find("weight");
    if (level && table.has(*level))
      weight = std::pow(0.5, table.number(*level));
    else if (given && table.has(*given))
      weight = table.number(*given);
    if (!(weight > 0)) continue;  // marked as an outlier
    if (k >= board.columns * board.rows)
      fail(where,
           current + " has more corners than a board of " + std::to_string(board.columns) + " x " +
               std::to_string(board.rows),
           "give the number of inner corners with --chessboard COLUMNSxROWS");
    view.p_target_mm.push_back(corner_mm(board, k));
    view.q_px.emplace_back(table.number(x), table.number(y));
    view.sigma_px.push_back(1 / weight);
  }
  finish(vnl.string());
  if (out.views.empty())
    fail(vnl.string(), "holds no view of a chessboard", "give a corners.vnl as mrcal's tools read it");
  return out;
}

}  // namespace burin

#include "burin/capture/judge_photo.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <opencv2/calib3d.hpp>
#include <opencv2/imgproc.hpp>

#include "burin/base/median.h"
#include "burin/capture/exif.h"
#include "burin/capture/photo.h"
#include "burin/capture/tags/tag_look.h"

namespace burin {
namespace {

constexpr double kSearch_px = 3e6;       // size of the copy for the tag search
constexpr double kLargeTag_px = 40;      // in that copy: a tag of this size would have been found
constexpr double kOtherFocal = 1.0 / 7;  // a lens that differs by more is another one
constexpr double kAside = 0.01;          // share of the photo's width: shift of a tag by lens and bow
constexpr double kSamePlace_s = 60;      // from photo to photo
constexpr double kFullFrameDiagonal_mm = 43.267;

// The mean of the channels, for tag detection, and the brightest channel, which clips first.
struct Grays {
  Image mean, top;
};

Grays grays_of(const Image& value) {
  Grays out{Image(value.width, value.height, 1), {}};
  if (value.channels == 1) {
    out.mean = value;
    out.top = value;
    return out;
  }
  out.top = Image(value.width, value.height, 1);
  for (std::size_t i = 0; i < out.mean.data.size(); ++i) {
    const float* v = &value.data[3 * i];
    out.mean.data[i] = (v[0] + v[1] + v[2]) / 3;
    out.top.data[i] = std::max({v[0], v[1], v[2]});
  }
  return out;
}

void add_new(std::vector<TagDetection>&& seen, const TagSet& tags, double scale, std::vector<TagDetection>& found) {
  for (TagDetection& tag : seen) {
    // Pixels of the copy to pixels of the photo; both count from the middle of their first.
    for (Eigen::Vector2d& q : tag.coarse_px) q = scale * (q + Eigen::Vector2d(0.5, 0.5)) - Eigen::Vector2d(0.5, 0.5);
    tag.corner_px = tag.coarse_px;
    const bool listed = std::any_of(tags.list.begin(), tags.list.end(), [&](const Tag& b) { return b.id == tag.id; });
    const bool known = std::any_of(found.begin(), found.end(), [&](const TagDetection& f) {
      return f.id == tag.id &&
             (f.coarse_px[0] - tag.coarse_px[0]).norm() < (tag.coarse_px[1] - tag.coarse_px[0]).norm();
    });
    if (tag.hamming <= 1 && listed && !known) found.push_back(std::move(tag));
  }
}

std::vector<TagDetection> find_tags(const Image& gray, const TagSet& tags) {
  TagDetector& detector = detector_of_this_thread(tags.family);
  const double pixels = 1.0 * gray.width * gray.height;
  const double scale = std::max(1.0, std::ceil(std::sqrt(pixels / kSearch_px)));
  std::vector<TagDetection> found;
  const auto search = [&](const Image& picture, double by) {
    // A highlight may be far brighter than paper: raise the brightness until every tag is found.
    for (const double brighter : {1., 8., 64.}) {
      if (found.size() >= tags.list.size()) return;
      add_new(detector.detect_coarse(picture, brighter), tags, by, found);
    }
  };
  if (scale > 1) {
    Image small(static_cast<int>(gray.width / scale), static_cast<int>(gray.height / scale), 1);
    const int across = static_cast<int>(small.width * scale), down = static_cast<int>(small.height * scale);
    const cv::Mat full(gray.height, gray.width, CV_32F, const_cast<float*>(gray.data.data()));
    cv::Mat into(small.height, small.width, CV_32F, small.data.data());
    cv::resize(full(cv::Rect(0, 0, across, down)), into, into.size(), 0, 0, cv::INTER_AREA);
    search(small, scale);
  }
  std::vector<double> sides;
  sides.reserve(found.size());
  for (const TagDetection& tag : found) sides.push_back((tag.coarse_px[1] - tag.coarse_px[0]).norm() / scale);
  const bool large = !sides.empty() && median_of(sides) >= kLargeTag_px;
  if (found.size() < tags.list.size() && !large) search(gray, 1);
  std::stable_sort(found.begin(), found.end(), [](const auto& a, const auto& b) { return a.id < b.id; });
  return found;
}

// Sharpness from the sides of the tags, measured at full size.
void measure_blur(const std::vector<TagDetection>& found, const LinearPhoto& photo, const Image& gray,
                  const std::string& family, PhotoFacts& facts) {
  std::vector<std::uint8_t> valid(photo.clipped.size());
  std::transform(photo.clipped.begin(), photo.clipped.end(), valid.begin(),
                 [](std::uint8_t c) { return static_cast<std::uint8_t>(!c); });
  const TagsInPhoto measured = detector_of_this_thread(family).measure(gray, valid, {}, found);
  std::vector<double> all, along_rows, along_columns;
  for (const TagDetection& tag : measured.tags) {
    for (int k = 0; k < 4; ++k) {
      const Eigen::Vector2d side = tag.coarse_px[(k + 1) % 4] - tag.coarse_px[k];
      all.push_back(tag.side_blur_px[k]);
      // Motion across a side widens it: a side along the rows shows blur along the columns.
      (std::abs(side.x()) > std::abs(side.y()) ? along_rows : along_columns).push_back(tag.side_blur_px[k]);
    }
    if (!facts.worst_blur_px || tag.blur_px > *facts.worst_blur_px) {
      facts.worst_blur_px = tag.blur_px;
      facts.worst_blur_tag = tag.id;
    }
  }
  if (all.empty()) return;
  facts.blur_px = median_of(std::move(all));
  if (along_rows.empty() || along_columns.empty()) return;
  const double ratio = median_of(std::move(along_rows)) / median_of(std::move(along_columns));
  facts.one_way_blur = std::max(ratio, 1 / ratio);
}

// The bench's lens for a picture of another size or orientation, as far as a pose needs it.
Lens fitted(const Lens& lens, int width, int height) {
  if (lens.width == width && lens.height == height) return lens;
  const double scale = std::hypot(width, height) / std::hypot(lens.width, lens.height);
  return plain_lens(scale * (lens.intrinsics[0] + lens.intrinsics[1]) / 2, width, height);
}

bool has_focal(const Lens* lens) {
  return lens != nullptr && lens->intrinsics.size() >= 4 && lens->width > 0 && lens->intrinsics[0] > 0;
}

void find_pose(AgreeingCorners& corners, const Lens* believed, PhotoFacts& facts) {
  std::optional<Lens> lens;
  double told = 0;
  if (facts.exif.focal_35mm)
    told = *facts.exif.focal_35mm / kFullFrameDiagonal_mm * std::hypot(facts.width, facts.height);
  if (has_focal(believed)) {
    lens = fitted(*believed, facts.width, facts.height);
    facts.lens_from = LensFrom::bench;
    if (told > 0 && std::abs(std::log(told / lens->intrinsics[0])) > kOtherFocal) lens.reset();
  }
  if (!lens && told > 0) {
    lens = plain_lens(told, facts.width, facts.height);
    facts.lens_from = LensFrom::exif;
  }
  if (lens) {
    drop_stray_tag(corners, *lens, kAside * facts.width);
    facts.pose = board_pose(corners, *lens);
    facts.focal_px = lens->intrinsics[0];
  } else {
    constexpr double kStep = 1.03;
    for (const double focal : focal_scale(kStep)) {
      const double f = focal * facts.width;
      const auto pose = board_pose(corners, plain_lens(f, facts.width, facts.height));
      if (!pose || (facts.pose && pose->error_px >= facts.pose->error_px)) continue;
      facts.pose = pose;
      facts.focal_px = f;
    }
    facts.lens_from = LensFrom::photo;
  }
  if (!facts.pose) facts.lens_from = LensFrom::nowhere;
}

void place_carve_area(const AgreeingCorners& corners, const Board& board, PhotoFacts& facts) {
  if (corners.pixel.size() < 4) return;
  std::vector<cv::Point2d> from, to;
  for (std::size_t i = 0; i < corners.pixel.size(); ++i) {
    from.emplace_back(corners.board_mm[i].x(), corners.board_mm[i].y());
    to.emplace_back(corners.pixel[i].x(), corners.pixel[i].y());
  }
  const cv::Mat H = cv::findHomography(from, to);
  if (H.empty()) return;
  const cv::Matx33d h = H;
  const Eigen::Vector2d a = board.carve_min_mm, b = board.carve_max_mm;
  const std::array<Eigen::Vector2d, 4> rectangle{a, Eigen::Vector2d(b.x(), a.y()), b, Eigen::Vector2d(a.x(), b.y())};
  for (int k = 0; k < 4; ++k) {
    const cv::Vec3d q = h * cv::Vec3d(rectangle[k].x(), rectangle[k].y(), 1);
    if (!(std::abs(q[2]) > 1e-12)) return;
    facts.carve_px[k] = {q[0] / q[2], q[1] / q[2]};
    // A corner behind the camera projects far away, or to the wrong side.
    if (!(facts.carve_px[k].norm() < 100.0 * (facts.width + facts.height))) return;
  }
  facts.carve_seen = true;
}

std::vector<cv::Point> rounded(std::span<const Eigen::Vector2d> polygon) {
  std::vector<cv::Point> out;
  for (const Eigen::Vector2d& q : polygon)
    out.emplace_back(static_cast<int>(std::lround(q.x())), static_cast<int>(std::lround(q.y())));
  return out;
}

// Clipped share of the carve area.
void judge_glints(const LinearPhoto& photo, const Image& top, PhotoFacts& facts) {
  const std::vector<cv::Point> area = rounded(facts.carve_px);
  const cv::Rect box = cv::boundingRect(area) & cv::Rect(0, 0, facts.width, facts.height);
  if (box.area() == 0) return;
  cv::Mat mask = cv::Mat::zeros(box.height, box.width, CV_8U);
  const auto fill = [&](std::vector<cv::Point> polygon, int value) {
    for (cv::Point& q : polygon) q -= box.tl();
    cv::fillPoly(mask, std::vector<std::vector<cv::Point>>{std::move(polygon)}, cv::Scalar(value));
  };
  fill(area, 1);
  for (const TagLook& tag : facts.tags) {  // paper is no glint: exclude the tag and the largest border of any family
    const Eigen::Vector2d middle = (tag.corner_px[0] + tag.corner_px[1] + tag.corner_px[2] + tag.corner_px[3]) / 4;
    std::array<Eigen::Vector2d, 4> paper;
    for (int k = 0; k < 4; ++k) paper[k] = middle + 1.9 * (tag.corner_px[k] - middle);
    fill(rounded(paper), 0);
  }
  std::vector<float> values;
  std::size_t clipped = 0;
  for (int y = 0; y < box.height; ++y)
    for (int x = 0; x < box.width; ++x) {
      if (!mask.at<std::uint8_t>(y, x)) continue;
      const std::size_t i = static_cast<std::size_t>(y + box.y) * facts.width + x + box.x;
      values.push_back(top.data[i]);
      clipped += photo.clipped[i];
    }
  if (values.size() < 100) return;
  facts.glints_clipped = static_cast<double>(clipped) / static_cast<double>(values.size());
  facts.glints_bright = quantile_in_place(values, 0.999);
}

void judge_paper(PhotoFacts& facts) {
  std::vector<double> white, sides;
  double lost = 0;
  for (const TagLook& tag : facts.tags) {
    white.push_back(tag.white);
    lost += tag.clipped_fraction;
    sides.push_back((tag.corner_px[1] - tag.corner_px[0]).norm());
  }
  if (white.empty()) return;
  facts.paper_clipped = lost / static_cast<double>(white.size());
  facts.paper = median_of(std::move(white));
  facts.tag_side_px = median_of(std::move(sides));
}

// A bracket's darkest photo gets the place of the previous photo.
void take_place_of(const PhotoFacts& before, PhotoFacts& facts) {
  if (!facts.tags.empty() || before.width != facts.width || before.height != facts.height) return;
  if (!facts.exif.time_s || !before.exif.time_s || !facts.exposure_factor || !before.exposure_factor) return;
  const double later_s = *facts.exif.time_s - *before.exif.time_s;
  if (later_s < 0 || later_s > kSamePlace_s || *facts.exposure_factor >= *before.exposure_factor) return;
  facts.pose = before.pose;
  facts.lens_from = before.lens_from;
  facts.focal_px = before.focal_px;
  facts.carve_px = before.carve_px;
  facts.carve_seen = before.carve_seen;
  facts.place_of_before = true;
}

}  // namespace

std::optional<Eigen::Vector3d> PhotoFacts::eye_mm() const {
  if (!pose) return std::nullopt;
  return Eigen::Vector3d(pose->T_camera_board.inverse().translation());
}

PhotoFacts judge_photo(const std::filesystem::path& file, const Board& board, const Lens* believed,
                       const PhotoFacts* before, double f_number) {
  PhotoFacts facts;
  facts.file = file;
  facts.exif = read_exif(file);
  if (!facts.exif.f_number && f_number > 0) facts.exif.f_number = f_number;
  const bool other_has_aperture = before != nullptr && before->exif.f_number;
  if (facts.exif.exposure_s && (facts.exif.f_number || !other_has_aperture))
    facts.exposure_factor = exposure_factor(*facts.exif.exposure_s, facts.exif.iso.value_or(100),
                                            facts.exif.f_number.value_or(kAssumedAperture));
  Photo photo;
  photo.file = file;
  photo.encoding = encoding_of(facts.exif).encoding;
  LinearPhoto linear = read_photo(photo);
  facts.width = linear.value.width;
  facts.height = linear.value.height;
  const Grays grays = grays_of(linear.value);
  linear.value = {};

  std::vector<float> some;
  for (std::size_t i = 0; i < grays.top.data.size(); i += 7) some.push_back(grays.top.data[i]);
  facts.bright = quantile_in_place(some, 0.995);

  const std::vector<TagDetection> found = find_tags(grays.mean, board.tags);
  facts.tags = look_at_tags(found, grays.top, linear.clipped, board.tags.family);
  for (const Tag& tag : board.tags.list)
    if (std::none_of(facts.tags.begin(), facts.tags.end(), [&](const TagLook& t) { return t.id == tag.id; }))
      facts.missing_tags.push_back(tag.id);
  judge_paper(facts);
  measure_blur(found, linear, grays.mean, board.tags.family, facts);

  AgreeingCorners corners = agreeing_corners(facts.tags, board.tags, kAside * facts.width, true);
  find_pose(corners, believed, facts);
  facts.stray_tags = corners.stray;
  place_carve_area(corners, board, facts);
  if (before != nullptr) take_place_of(*before, facts);
  if (facts.carve_seen) judge_glints(linear, grays.top, facts);
  return facts;
}

}  // namespace burin

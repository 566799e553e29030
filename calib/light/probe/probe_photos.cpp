#include "burin/calib/light/probe/probe_photos.h"

#include <tbb/enumerable_thread_specific.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <numbers>
#include <thread>

#include "burin/capture/tags/tag_look.h"

namespace burin {
namespace {

constexpr int kGlance_px = 1200;      // width of the small pictures
constexpr double kLargePhoto = 40e6;  // pixels: larger photos are halved, and the ball stays large enough
constexpr double kAroundBall = 1.25;  // of the ball's radius: the part kept
constexpr double kMostPaperClipped = 0.1;

Image smaller(const Image& gray, int by) {
  return by <= 1 ? gray : resized(gray, std::max(1, gray.width / by), std::max(1, gray.height / by));
}

// R G B of the white paper of each tag of one view, without clipped tags.
std::vector<Eigen::Vector3d> paper_of(const MergedView& view, const TagsInPhoto& tags, const std::string& family) {
  std::vector<TagDetection> small = tags.tags;
  for (TagDetection& tag : small)
    for (Eigen::Vector2d& corner : tag.coarse_px) corner = ((corner.array() + 0.5) / view.bin - 0.5).matrix();
  std::vector<std::uint8_t> clipped(view.valid.size());
  std::transform(view.valid.begin(), view.valid.end(), clipped.begin(), [](std::uint8_t v) { return v ? 0 : 1; });
  std::vector<Eigen::Vector3d> out;
  std::vector<bool> usable;
  for (int c = 0; c < 3; ++c) {
    Image channel(view.value.width, view.value.height, 1);
    const int n = view.value.channels;
    for (std::size_t i = 0; i < channel.data.size(); ++i)
      channel.data[i] = view.value.data[i * static_cast<std::size_t>(n) + static_cast<std::size_t>(n == 3 ? c : 0)];
    const std::vector<TagLook> looks = look_at_tags(small, channel, clipped, family);
    out.resize(looks.size());
    usable.resize(looks.size(), true);
    for (std::size_t i = 0; i < looks.size(); ++i) {
      out[i][c] = looks[i].white;
      usable[i] = usable[i] && looks[i].white > 0 && looks[i].clipped_fraction < kMostPaperClipped;
    }
  }
  std::vector<Eigen::Vector3d> kept;
  for (std::size_t i = 0; i < out.size(); ++i)
    if (usable[i]) kept.push_back(out[i]);
  return kept;
}

}  // namespace

std::vector<ProbeGlance> glance_at(const Session& session, std::span<const Bracket> brackets,
                                   std::span<const NoiseModel> noise, const Board& board, const Progress& progress) {
  std::vector<ProbeGlance> out(brackets.size());
  std::vector<int> ids;
  for (const Tag& tag : board.tags.list) ids.push_back(tag.id);
  tbb::enumerable_thread_specific<TagDetector> detector([&] { return TagDetector(board.tags.family); });
  const std::thread::id caller = std::this_thread::get_id();
  std::atomic<std::size_t> done = 0;
  const int width = photo_size(session).width, bin = std::max(1, width / kGlance_px);
  for_each_merged(session, brackets, noise, bin, [&](std::size_t b, MergedView&& view, GrayView&& gray) {
    ProbeGlance& glance = out[b];
    TagsInPhoto tags = detector.local().detect(gray.value, gray.valid, ids);
    glance.paper = paper_of(view, tags, board.tags.family);
    glance.tags = {brackets[b].view, session.photos[static_cast<std::size_t>(brackets[b].photos.front())].file,
                   std::move(tags.tags), std::move(tags.rejected)};
    glance.gray = smaller(gray.value, bin);
    glance.scale = static_cast<double>(gray.value.width) / glance.gray.width;
    ++done;
    if (progress && std::this_thread::get_id() == caller)
      progress("reading photos, finding tags", static_cast<double>(done) / static_cast<double>(brackets.size()));
  });
  return out;
}

std::vector<BallPicture> pictures_of_ball(const Session& session, std::span<const Bracket> brackets,
                                          std::span<const NoiseModel> noise, std::span<const BallView> places,
                                          const MirrorBall& ball, const Progress& progress) {
  std::vector<BallPicture> out(places.size());
  const PhotoSize size = photo_size(session);
  const int bin = static_cast<double>(size.width) * size.height > kLargePhoto ? 2 : 1;
  const std::thread::id caller = std::this_thread::get_id();
  std::atomic<std::size_t> done = 0;
  for_each_merged(session, brackets, noise, bin, [&](std::size_t b, MergedView&& view, GrayView&&) {
    BallPicture& picture = out[b];
    picture.lens = places[b].lens;
    picture.T_camera_board = places[b].T_camera_board;
    picture.scale = bin;
    const auto cone = tangent_cone(ball, places[b].eye_mm());
    if (!cone) return;
    std::vector<Eigen::Vector3d> rays;
    constexpr int kRays = 64;
    rays.reserve(kRays);
    for (int k = 0; k < kRays; ++k)
      rays.push_back(picture.T_camera_board.linear() *
                     cone->ray(kAroundBall * cone->half_angle, k * 2 * std::numbers::pi / kRays));
    std::vector<Eigen::Vector2d> at(rays.size());
    project(picture.lens, rays, at);
    Eigen::Vector2d low = at[0], high = at[0];
    for (const Eigen::Vector2d& q : at) {
      low = low.cwiseMin(q);
      high = high.cwiseMax(q);
    }
    const int left = std::clamp(static_cast<int>(low.x() / bin), 0, view.value.width - 1);
    const int top = std::clamp(static_cast<int>(low.y() / bin), 0, view.value.height - 1);
    const int right = std::clamp(static_cast<int>(high.x() / bin) + 1, left, view.value.width - 1);
    const int bottom = std::clamp(static_cast<int>(high.y() / bin) + 1, top, view.value.height - 1);
    const int n = view.value.channels;
    picture.value = Image(right - left + 1, bottom - top + 1, 3);
    picture.valid.resize(static_cast<std::size_t>(picture.value.width) * picture.value.height);
    picture.origin_px = {bin * left + (bin - 1) / 2.0, bin * top + (bin - 1) / 2.0};
    for (int y = top; y <= bottom; ++y)
      for (int x = left; x <= right; ++x) {
        for (int c = 0; c < 3; ++c) picture.value.at(x - left, y - top, c) = view.value.at(x, y, n == 3 ? c : 0);
        picture.valid[static_cast<std::size_t>(y - top) * picture.value.width + (x - left)] =
            view.valid[static_cast<std::size_t>(y) * view.value.width + x];
      }
    ++done;
    if (progress && std::this_thread::get_id() == caller)
      progress("reading the ball", static_cast<double>(done) / static_cast<double>(places.size()));
  });
  return out;
}

BallView in_gray(const BallPicture& picture) {
  BallView view;
  view.lens = picture.lens;
  view.T_camera_board = picture.T_camera_board;
  view.origin_px = picture.origin_px;
  view.scale = picture.scale;
  view.gray = Image(picture.value.width, picture.value.height, 1);
  for (std::size_t i = 0; i < view.gray.data.size(); ++i)
    view.gray.data[i] = (picture.value.data[3 * i] + picture.value.data[3 * i + 1] + picture.value.data[3 * i + 2]) / 3;
  return view;
}

}  // namespace burin

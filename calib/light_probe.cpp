#include "burin/calib/light_probe.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <set>
#include <utility>

#include "burin/base/error.h"
#include "burin/base/files/decimals.h"
#include "burin/base/median.h"
#include "burin/calib/camera_look.h"
#include "burin/calib/geometry/board_solver.h"
#include "burin/calib/light/probe/fill_unseen.h"
#include "burin/calib/light/probe/find_ball.h"
#include "burin/calib/light/probe/probe_panorama.h"
#include "burin/calib/light/probe/probe_photos.h"
#include "burin/scene/far_light.h"

namespace burin {
namespace {

constexpr double kMostClipped = 0.03;      // of the directions above the face
constexpr double kBrightShare = 0.2;       // of the brightest pixel: darker pixels belong to another light, or none
constexpr double kUsualReflectance = 0.6;  // polished steel
constexpr double kDeg = 180 / std::numbers::pi;

std::string in_percent(double share, int digits = 2) { return significant(100 * share, digits) + " %"; }

// Intermediate data: a bracket of each view, and its results.
struct ProbeWork {
  Session session;
  std::vector<Bracket> brackets;
  std::vector<NoiseModel> noise;
  std::vector<ProbeGlance> glances;
  std::vector<BallView> places;  // of the brackets, after the poses are solved

  std::filesystem::path file_of(std::size_t b) const {
    return session.photos[static_cast<std::size_t>(brackets[b].photos.front())].file;
  }
  std::vector<std::filesystem::path> files() const {
    std::vector<std::filesystem::path> out;
    for (std::size_t b = 0; b < brackets.size(); ++b) out.push_back(file_of(b));
    return out;
  }
  // Keeps only these views.
  void keep(const std::vector<bool>& kept) {
    const auto thin = [&](auto& list) {
      std::size_t to = 0;
      for (std::size_t i = 0; i < kept.size() && i < list.size(); ++i)
        if (kept[i] && to++ != i) list[to - 1] = std::move(list[i]);
      list.resize(std::min(to, list.size()));
    };
    thin(brackets);
    thin(noise);
    thin(glances);
    thin(places);
  }
};

std::optional<Lens> believed_lens(const LightProbeOptions& options, PhotoSize size) {
  std::optional<Lens> lens = options.lens;
  if (!lens && options.bench != nullptr) lens = options.bench->lens;
  if (lens && (lens->width != size.width || lens->height != size.height))
    fail("the given lens",
         "is for pictures of " + std::to_string(lens->width) + " x " + std::to_string(lens->height) +
             " pixels, the photos have " + std::to_string(size.width) + " x " + std::to_string(size.height),
         "give the bench or camera model of the camera that took these photos, in the same orientation");
  return lens;
}

ProbeWork first_reading(const Session& given, const Board& board, const LightProbeOptions& options, LightProbe& out,
                        const Progress& progress) {
  if (given.photos.empty()) fail("the light probe", "has no photos", "give photos of a mirror ball on the board");
  if (board.tags.list.size() < 3)
    fail("board.json: tags.list", "has " + counted(board.tags.list.size(), "tag"),
         "list at least three: they determine the camera's place");
  ProbeWork work;
  Sensor sensor;
  if (options.bench != nullptr)
    sensor = options.bench->sensor;
  else
    look_at_brackets(given, CurveFrom::as_told, sensor, out.findings);
  work.session = with_camera(given, sensor);
  work.brackets = brackets_of(work.session);
  work.noise = session_noise(work.session, work.brackets);
  work.glances = glance_at(work.session, work.brackets, work.noise, board, progress);
  return work;
}

// Solves lens and poses by the tags; leaves out views without enough of them.
void solve_places(ProbeWork& work, const Board& believed, const LightProbeOptions& options, LightProbe& out,
                  const Progress& progress) {
  const PhotoSize size = photo_size(work.session);
  Board board = believed;
  BoardSolverOptions solver;
  solver.lens = believed_lens(options, size);
  const bool guess = options.lens ? options.lens_is_a_guess : options.bench != nullptr && options.bench->camera.empty();
  solver.fix_lens = solver.lens.has_value() && (!guess || work.brackets.size() < 3);
  solver.check_with_mrcal = false;
  if (options.bench != nullptr && !options.bench->tags.empty()) {
    board.tags.list = options.bench->tags;
    board.tags.sigma_mm = std::min(board.tags.sigma_mm, 0.05);
    if (options.bench->bend) board.bend = options.bench->bend;
  }
  std::vector<ViewTags> pictures;
  std::size_t found = 0;
  for (const ProbeGlance& glance : work.glances) {
    pictures.push_back(glance.tags);
    found += glance.tags.tags.size();
  }
  if (found == 0) {
    for (const ViewTags& picture : pictures)
      if (!picture.rejected.empty())
        fail(picture.file.string(),
             "no tag can be used in any photo; of tag " + std::to_string(picture.rejected.front().id) + ", " +
                 in_words(picture.rejected.front()),
             "take the photos again: tags sharp, their paper not clipped in the darker ones");
    fail(work.file_of(0).string(), "no tag of the board's is seen in any photo, so the camera's place is unknown",
         "photograph ball and tags together, sharp, the tags at least 20 pixels wide; and check tags.family in "
         "board.json");
  }
  if (!solver.lens && work.brackets.size() < 3)
    fail(work.file_of(0).string(),
         "photos from " + counted(work.brackets.size(), "place") +
             " do not determine the lens, and their EXIF has no focal length",
         "give the lens (--camera camera.cameramodel, or --bench), or photograph ball and tags from three places");
  const BoardSolution solution = solve_board(board, pictures, size.width, size.height, solver, progress);
  for (const Finding& finding : solution.findings)  // single corners do not matter here
    if (finding.severity != Finding::Severity::note) out.findings.push_back(finding);
  for (const std::string& name : solution.not_determined)
    if (!solver.fix_lens)
      out.findings.push_back(make_warning(FindingCode::lens_weak, "the photos hardly determine the lens' " + name,
                                          "give --bench or --camera with a lens that was measured"));
  std::vector<bool> kept;
  for (std::size_t b = 0; b < work.brackets.size(); ++b) {
    const auto view = std::find_if(solution.views.begin(), solution.views.end(),
                                   [&](const View& v) { return v.name == work.brackets[b].view; });
    kept.push_back(view != solution.views.end());
    BallView place;
    if (kept.back()) {
      place.lens = solution.lens;
      place.T_camera_board = view->T_camera_board;
      place.gray = std::move(work.glances[b].gray);
      place.scale = work.glances[b].scale;
      place.origin_px.setConstant((place.scale - 1) / 2);
      std::vector<Eigen::Vector2d> corners;
      for (const TagDetection& tag : pictures[b].tags)
        corners.insert(corners.end(), tag.corner_px.begin(), tag.corner_px.end());
      place.free_rays.resize(corners.size());
      unproject(place.lens, corners, place.free_rays);
      for (Eigen::Vector3d& ray : place.free_rays) ray = place.T_camera_board.linear().transpose() * ray;
      ProbePlace told;
      told.view = view->name;
      told.exposures = static_cast<int>(work.brackets[b].photos.size());
      told.tags = view->tags.value_or(0);
      told.tags_rms_px = view->reprojection_rms_px.value_or(0);
      out.places.push_back(told);
    }
    work.places.push_back(std::move(place));
  }
  work.keep(kept);
  constexpr double kPoorPose_px = 1.5;
  for (std::size_t b = 0; b < work.brackets.size(); ++b)
    if (out.places[b].tags_rms_px > kPoorPose_px)
      out.findings.push_back(
          {FindingCode::lens_weak, Finding::Severity::warning, work.file_of(b),
           "its tags lie " + significant(out.places[b].tags_rms_px, 2) + " pixels from where lens and board have them",
           "give the lens of this camera at this zoom and focus (--bench, --camera), or photograph from three places "
           "and more without it"});
}

// Finds the ball in the small pictures, then at full resolution. Views that hide it are left out.
FittedBall solve_ball(ProbeWork& work, const Board& board, const LightProbeOptions& options,
                      std::vector<BallPicture>& pictures, LightProbe& out, const Progress& progress) {
  const BallHints hints{options.ball_mm, options.photographer_deg / kDeg};
  auto fit = find_ball(work.places, board, hints, progress);
  require_ball(fit, work.files());
  std::vector<bool> kept;
  for (std::size_t b = 0; b < work.brackets.size(); ++b) {
    kept.push_back(shows_ball(*fit, b));
    if (!kept.back())
      out.findings.push_back(
          {FindingCode::photo_omitted, Finding::Severity::warning, work.file_of(b),
           "is left out: along only " + in_percent(fit->views[b].found) + " of the ball's outline an edge is seen",
           "the ball is to be seen whole"});
  }
  std::size_t to = 0;
  for (std::size_t b = 0; b < kept.size(); ++b)
    if (kept[b]) out.places[to++] = out.places[b];
  out.places.resize(to);
  work.keep(kept);
  pictures = pictures_of_ball(work.session, work.brackets, work.noise, work.places, fit->ball, progress);
  std::vector<BallView> views;
  views.reserve(pictures.size());
  for (const BallPicture& picture : pictures) views.push_back(in_gray(picture));
  fit = fit_ball(views, fit->ball, board, hints);
  require_ball(fit, work.files());
  for (std::size_t b = 0; b < views.size(); ++b) {
    out.places[b].outline_found = fit->views[b].found;
    out.places[b].outline_rms_px = fit->views[b].rms_px;
    out.places[b].radius_px = fit->views[b].radius_px;
  }
  return *fit;
}

void tell_ball(const FittedBall& fit, LightProbe& out) {
  out.ball = fit.ball;
  out.radius_sigma_mm = fit.radius_sigma_mm;
  // A displaced ball turns its normals by the displacement over its radius, and directions by twice as much. Edge
  // errors are correlated if the ball shows like things along its rim: by a part of their scatter.
  constexpr double kTogether = 0.4;
  std::vector<double> scatter;
  for (const ProbePlace& place : out.places) scatter.push_back(place.outline_rms_px / place.radius_px);
  out.direction_sigma_deg =
      2 * std::hypot(fit.center_sigma_mm.maxCoeff() / fit.ball.radius_mm, kTogether * median_of(std::move(scatter))) *
      kDeg;
  out.agreement = fit.agreement;
  constexpr double kPoorAgreement = 0.87;
  if (out.places.size() > 1 && fit.agreement < kPoorAgreement)
    out.findings.push_back(make_warning(
        FindingCode::ball,
        "the places' pictures of the room agree only with a correlation of " + significant(fit.agreement, 2) +
            ": directions may be off by a degree or two",
        "ball and lamps must not move between photos; a ball that stands out from the face, and more places, help"));
  double largest = 1;
  for (const ProbePlace& place : out.places) largest = std::max(largest, place.radius_px);
  out.pixel_deg = 2 / largest * kDeg;
  if (out.pixel_deg > 2)
    out.findings.push_back(make_warning(FindingCode::ball,
                                        "a pixel in the ball's middle spans " + significant(out.pixel_deg, 2) +
                                            " degrees of the room: small lamps are smeared over that",
                                        "come closer, or take a larger ball: 200 pixels and more are good"));
  std::vector<double> round;
  for (const OutlineLook& look : fit.views) round.push_back(look.out_of_round);
  if (const double off = median_of(round); off > 0.005)
    out.findings.push_back(make_warning(FindingCode::ball,
                                        "the ball is not quite round: its outline is off by " + in_percent(off) +
                                            " of its radius, directions by up to " + significant(4 * off * kDeg, 2) +
                                            " degrees",
                                        "a bearing ball is round"));
}

// Shares of the directions above the face.
void tell_shares(LightProbe& out) {
  double all = 0, seen = 0, photographer = 0, clipped = 0;
  for (int y = 0; y < out.radiance.height / 2; ++y) {
    const double weight = std::sin(std::numbers::pi * (y + 0.5) / out.radiance.height);
    for (int x = 0; x < out.radiance.width; ++x) {
      const Seen how = out.seen[static_cast<std::size_t>(y) * out.radiance.width + x];
      all += weight;
      seen += how == Seen::nowhere ? 0 : weight;
      photographer += how == Seen::photographer ? weight : 0;
      clipped += how == Seen::clipped ? weight : 0;
    }
  }
  out.seen_share = seen / all;
  out.photographer_share = photographer / all;
  out.clipped_share = clipped / all;
}

void judge_exposures(const ProbeWork& work, LightProbe& out) {
  if (out.clipped_share == 0) return;
  std::size_t shortest = 0, photos = 0;
  double factor = INFINITY;
  for (const Bracket& bracket : work.brackets)
    for (const int i : bracket.photos) {
      ++photos;
      const double exposed = exposure_factor(work.session.photos[static_cast<std::size_t>(i)]);
      if (exposed < factor) {
        factor = exposed;
        shortest = static_cast<std::size_t>(i);
      }
    }
  const std::string file = work.session.photos[shortest].file.string();
  if (photos == work.brackets.size())
    fail(file, "a light in the ball is clipped, and no place has a second, shorter exposure that holds it",
         "bracket: from each place without moving the camera, three or more exposures, each a fourth of the one "
         "before, until no lamp is white in the last");
  if (out.clipped_share > kMostClipped)
    fail(
        file,
        in_percent(out.clipped_share) +
            " of the directions above the face are clipped even in this, the shortest exposure",
        "take shorter exposures, or a smaller aperture or a gray filter for all of them, until no lamp is white in the "
        "last");
  out.findings.push_back(
      {FindingCode::exposure, Finding::Severity::warning, file,
       "the brightest light (" + in_percent(out.clipped_share) +
           " of the directions above the face) is clipped even in this, the shortest exposure: it is at least as "
           "bright as in the picture",
       "add a shorter exposure, or name the sun as a light of its own (\"sun\" in bench.json)"});
}

// Solves for the reflectance that makes the ball's light equal the paper's: white paper sends albedo / pi of its
// irradiance.
void solve_reflectance(const ProbeWork& work, const Board& board, const LightProbeOptions& options, LightProbe& out) {
  auto panorama = std::make_shared<Panorama>();
  panorama->radiance = out.radiance;
  const Eigen::Vector3d seen = irradiance(*panorama, Eigen::Vector3d::UnitZ());
  std::array<std::vector<double>, 3> paper;
  for (const ProbeGlance& glance : work.glances)
    for (const Eigen::Vector3d& white : glance.paper)
      for (int c = 0; c < 3; ++c) paper[static_cast<std::size_t>(c)].push_back(std::log(white[c]));
  std::optional<Eigen::Vector3d> by_paper;
  if (!paper[0].empty()) {
    Eigen::Vector3d found;
    double spread = 0;
    for (int c = 0; c < 3; ++c) {
      std::vector<double>& values = paper[static_cast<std::size_t>(c)];
      const double middle = median_of(values);
      found[c] = seen[c] * board.tags.white_albedo / (std::numbers::pi * std::exp(middle));
      for (double& value : values) value = std::abs(value - middle);
      spread = std::max(spread, 1.4826 * median_of(values));
    }
    out.paper_spread = spread;
    by_paper = found;
  }
  const bool plausible = by_paper && by_paper->minCoeff() > 0.02 && by_paper->maxCoeff() < 1.1;
  if (options.reflectance) {
    out.reflectance = *options.reflectance;
    if (!by_paper) return;
    const double ratio = by_paper->mean() / out.reflectance.mean();
    if (std::abs(std::log(ratio)) > 0.1)
      out.findings.push_back(make_warning(
          FindingCode::ball,
          "the tags' paper gets " + significant(1 / ratio, 3) +
              " times the light that the ball shows with the given "
              "reflectance" +
              (out.clipped_share > 0 ? ": much of that is what is clipped" : ""),
          "leave out --reflectance to believe the paper (albedo " + significant(board.tags.white_albedo, 2) + ")"));
    return;
  }
  if (plausible && out.clipped_share == 0) {
    out.reflectance = *by_paper;
    out.reflectance_by_paper = true;
    return;
  }
  out.reflectance.setConstant(kUsualReflectance);
  out.findings.push_back(make_warning(
      FindingCode::ball,
      out.clipped_share > 0
          ? "a clipped light is missing in the ball and not on the paper, so the paper does not determine "
            "the ball's reflectance: 0.6 is assumed"
      : by_paper ? "by the tags' paper the ball would reflect " + significant(by_paper->mean(), 2) +
                       " of the light, which no mirror does: 0.6 is assumed"
                 : "the tags' paper cannot be used, so the ball's reflectance is not known: 0.6 is assumed",
      by_paper && out.clipped_share == 0
          ? "a lamp that is near lights ball and tags unequally; check white_albedo in board.json"
          : "give --reflectance"));
}

// Connected pixels around the brightest one, not much darker.
BrightestLight brightest_light(const Image& radiance) {
  Panorama frame;
  frame.radiance = Image(radiance.width, radiance.height, 3);
  const int w = radiance.width, h = radiance.height / 2;
  const auto value = [&](std::size_t i) {
    return radiance.data[3 * i] + radiance.data[3 * i + 1] + radiance.data[3 * i + 2];
  };
  std::size_t top = 0;
  double all = 0;
  const auto power = [&](std::size_t i) {
    const int y = static_cast<int>(i) / w;
    return value(i) * frame.solid_angle(y) * frame.direction(0, y + 0.5).z();
  };
  for (std::size_t i = 0; i < static_cast<std::size_t>(w) * h; ++i) {
    if (value(i) > value(top)) top = i;
    all += power(i);
  }
  std::set<std::size_t> inside = {top};
  std::vector<std::size_t> open = {top};
  Eigen::Vector3d middle(0, 0, 0);
  double sum = 0;
  while (!open.empty()) {
    const std::size_t i = open.back();
    open.pop_back();
    const int x = static_cast<int>(i) % w, y = static_cast<int>(i) / w;
    middle += value(i) * frame.solid_angle(y) * frame.direction(x + 0.5, y + 0.5);
    sum += power(i);
    for (const auto& [dx, dy] : {std::pair(1, 0), std::pair(-1, 0), std::pair(0, 1), std::pair(0, -1)}) {
      if (y + dy < 0 || y + dy >= h) continue;
      const std::size_t next = static_cast<std::size_t>(y + dy) * w + (x + dx + w) % w;
      if (value(next) >= kBrightShare * value(top) && inside.insert(next).second) open.push_back(next);
    }
  }
  return {middle.normalized(), all > 0 ? sum / all : 0};
}

void tell_photographer(const LightProbeOptions& options, LightProbe& out) {
  if (out.photographer_share < 0.005) return;
  out.findings.push_back(make_warning(
      FindingCode::ball,
      "towards the camera (" + in_percent(out.photographer_share) +
          " of the directions above the face) no other place looks past the photographer, who stays in the picture "
          "there",
      out.places.size() == 1 ? "photograph the ball from a second place, a quarter turn around the board"
                             : "photograph from places that are more than " +
                                   significant(2 * options.photographer_deg, 2) + " degrees apart about the ball"));
}

}  // namespace

LightProbe light_probe(const Session& session, const Board& board, const LightProbeOptions& options,
                       const Progress& progress) {
  LightProbe out;
  ProbeWork work = first_reading(session, board, options, out, progress);
  solve_places(work, board, options, out, progress);
  std::vector<BallPicture> pictures;
  tell_ball(solve_ball(work, board, options, pictures, out, progress), out);

  if (progress) progress("joining the pictures", 0);
  const Sensor sensor = options.bench != nullptr ? options.bench->sensor : Sensor{};
  for (BallPicture& picture : pictures) picture.vignette = sensor.vignette;
  ProbeMerge merge;
  merge.width = options.width > 0 ? options.width : panorama_width(pictures, out.ball);
  merge.photographer_rad = options.photographer_deg / kDeg;
  merge.board_mm = board.size_mm;
  ProbePanorama joined = probe_panorama(pictures, out.ball, merge);
  out.radiance = std::move(joined.radiance);
  out.seen = std::move(joined.seen);
  tell_shares(out);
  judge_exposures(work, out);
  tell_photographer(options, out);
  std::vector<std::uint8_t> known(out.seen.size());
  std::transform(out.seen.begin(), out.seen.end(), known.begin(), [](Seen s) { return s == Seen::nowhere ? 0 : 1; });
  fill_unseen(out.radiance, known);

  solve_reflectance(work, board, options, out);
  for (std::size_t i = 0; i < out.radiance.data.size(); ++i)
    out.radiance.data[i] =
        static_cast<float>(out.radiance.data[i] / (out.reflectance[static_cast<Eigen::Index>(i % 3)] * sensor.gain));
  out.brightest = brightest_light(out.radiance);
  return out;
}

}  // namespace burin

#include "burin/calib/verdict/candidate_photo.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <set>

#include "burin/base/error.h"
#include "burin/base/files/decimals.h"
#include "burin/base/median.h"
#include "burin/calib/light/lamp_model.h"
#include "burin/calib/photo/carved_states.h"
#include "burin/calib/photo/effect_unknowns.h"
#include "burin/calib/photo/paper_equation.h"
#include "burin/scene/board_face.h"
#include "burin/scene/footprint_grid.h"

namespace burin {
namespace {

constexpr double kFrameMargin = 0.04;  // of the picture's sides: free border around the board
constexpr double kSmallestTag_px = 15;

Eigen::Vector3d middle_of(const Board& board) { return {0.5 * board.size_mm.x(), 0.5 * board.size_mm.y(), 0}; }

// Camera axes as rows: the camera looks along `forward`. It is upright if the board's normal (seen from the side) or y
// (from above) points up in the picture; then it is rolled.
Eigen::Isometry3d looking(const Eigen::Vector3d& eye, const Eigen::Vector3d& target, double tilt, double roll) {
  const Eigen::Vector3d z = (target - eye).normalized();
  constexpr double kAboveAll = 0.1;
  const Eigen::Vector3d up = tilt < kAboveAll ? Eigen::Vector3d::UnitY() : Eigen::Vector3d::UnitZ();
  const Eigen::Vector3d x0 = z.cross(up).normalized(), y0 = z.cross(x0);
  Eigen::Matrix3d R;
  R.row(0) = std::cos(roll) * x0 + std::sin(roll) * y0;
  R.row(1) = -std::sin(roll) * x0 + std::cos(roll) * y0;
  R.row(2) = z;
  Eigen::Isometry3d T = Eigen::Isometry3d::Identity();
  T.linear() = R;
  T.translation() = -R * eye;
  return T;
}

bool sees_board(const Lens& lens, const Eigen::Isometry3d& T, const Board& board) {
  std::vector<Eigen::Vector3d> p;
  for (const double x : {0.0, 0.5, 1.0})
    for (const double y : {0.0, 0.5, 1.0})
      p.push_back(T * Eigen::Vector3d(x * board.size_mm.x(), y * board.size_mm.y(), 0));
  for (const Eigen::Vector3d& v : p)
    if (!(v.z() > 1e-6)) return false;
  std::vector<Eigen::Vector2d> q(p.size());
  project(lens, p, q);
  const double margin_x = kFrameMargin * lens.width, margin_y = kFrameMargin * lens.height;
  return std::all_of(q.begin(), q.end(), [&](const Eigen::Vector2d& v) {
    return v.x() > margin_x && v.y() > margin_y && v.x() < lens.width - margin_x && v.y() < lens.height - margin_y;
  });
}

// The smallest distance with the whole board in the picture.
double nearest_mm(const Lens& lens, const Board& board, const Eigen::Vector3d& direction, double tilt, double roll) {
  const Eigen::Vector3d middle = middle_of(board);
  const double size = board.size_mm.norm();
  const auto sees = [&](double d) {
    return sees_board(lens, looking(middle + d * direction, middle, tilt, roll), board);
  };
  double far = 0.6 * size;
  while (!sees(far)) {
    far *= 1.5;
    if (far > 100 * size)
      fail("the lens", "does not see the whole board from any distance",
           "check the .cameramodel: its focal lengths, its picture's size");
  }
  double near = far / 1.5;
  for (int i = 0; i < 12; ++i) {
    const double d = 0.5 * (near + far);
    (sees(d) ? far : near) = d;
  }
  return far;
}

std::string beside_edges(double value, double size, const char* low, const char* high) {
  const auto told = [](double distance, const char* where, const char* edge) {
    return fixed(distance, 0) + " mm " + where + " the " + edge + " edge";
  };
  if (value < 0) return told(-value, "beyond", low);
  if (value > size) return told(value - size, "beyond", high);
  return value <= size / 2 ? told(value, "in from", low) : told(size - value, "in from", high);
}

}  // namespace

CameraPlace camera_place_at(const Eigen::Vector3d& center_mm, const Board& board, std::size_t direction) {
  const Eigen::Vector3d middle = middle_of(board), away = center_mm - middle;
  if (!(away.z() > 0))
    fail("a camera", "stands " + fixed(center_mm.z(), 0) + " mm above the face, behind the board", "put it in front");
  CameraPlace place;
  place.direction = direction;
  place.distance_mm = away.norm();
  place.tilt_rad = std::atan2(away.head<2>().norm(), away.z());
  place.azimuth_rad = std::atan2(away.y(), away.x());
  place.T_camera_board = looking(center_mm, middle, place.tilt_rad, 0);
  return place;
}

FocusRange depth_of_field(const Lens& lens, double focus_mm) {
  constexpr double kAperture = 8, kSensorWidth_mm = 36, kBlurredShare = 1.0 / 1200, kMostTimes = 3;
  const double focal = lens.intrinsics.at(0) / lens.width;  // of the picture's width
  const double aperture_mm = focal * kSensorWidth_mm / kAperture;
  const double reach = kBlurredShare / (aperture_mm * focal);  // in 1/d, 1/mm
  const double far = std::max(1 / focus_mm - reach, 1 / (kMostTimes * focus_mm));
  return {1 / (1 / focus_mm + reach), 1 / far};
}

std::vector<CameraPlace> camera_places(const Board& board, const Lens& lens, bool variants,
                                       const std::optional<FocusRange>& focus) {
  struct Ring {
    double tilt_deg;
    int count;
  };
  constexpr std::array<Ring, 5> kRings{{{0, 1}, {20, 6}, {38, 10}, {53, 10}, {65, 10}}};
  std::vector<CameraPlace> places;
  std::size_t direction = 0;
  for (const Ring& ring : kRings)
    for (int i = 0; i < ring.count; ++i) {
      CameraPlace place;
      place.direction = direction;
      place.tilt_rad = ring.tilt_deg * std::numbers::pi / 180;
      // Rings are rotated relative to each other, and to the board, so that all viewpoints differ.
      place.azimuth_rad = 2 * std::numbers::pi * (i + 0.25 * ring.tilt_deg / 20) / ring.count;
      const Eigen::Vector3d toward(std::sin(place.tilt_rad) * std::cos(place.azimuth_rad),
                                   std::sin(place.tilt_rad) * std::sin(place.azimuth_rad), std::cos(place.tilt_rad));
      const Eigen::Vector3d middle = middle_of(board);
      const auto add = [&](double factor, double roll) {
        place.roll_rad = roll;
        const double nearest = nearest_mm(lens, board, toward, place.tilt_rad, roll);
        place.distance_mm = factor * nearest;
        if (focus) {
          if (nearest > focus->far_mm) return;
          place.distance_mm = factor > 1 ? focus->far_mm : std::max(nearest, focus->near_mm);
        }
        place.T_camera_board = looking(middle + place.distance_mm * toward, middle, place.tilt_rad, roll);
        places.push_back(place);
      };
      const std::size_t before = places.size();
      add(1, 0);
      if (variants) {
        add(1.5, 0);
        add(1, std::numbers::pi / 2);
      }
      if (places.size() > before) ++direction;
    }
  return places;
}

std::string place_in_words(const Eigen::Vector3d& p, const Board& board) {
  const std::string above = fixed(p.z(), 0) + " mm above";
  const double near = 0.02 * board.size_mm.norm();
  const auto at = [&](double x, double y) { return (p.head<2>() - Eigen::Vector2d(x, y)).norm() < near; };
  const double w = board.size_mm.x(), h = board.size_mm.y();
  if (at(w / 2, h / 2)) return above + " the board's middle";
  if (at(0, 0)) return above + " the lower left corner";
  if (at(w, 0)) return above + " the lower right corner";
  if (at(0, h)) return above + " the upper left corner";
  if (at(w, h)) return above + " the upper right corner";
  return above + " the face, " + beside_edges(p.x(), w, "left", "right") + ", " +
         beside_edges(p.y(), h, "lower", "upper");
}

std::string place_in_words(const CameraPlace& place, const Board& board) {
  const std::string aim = place.tilt_rad < 0.01
                              ? "looking straight down"
                              : "aimed at the board's middle (" + fixed(place.distance_mm, 0) + " mm away, " +
                                    fixed(place.tilt_rad * 180 / std::numbers::pi, 0) + " degrees from straight down)";
  return "camera " + place_in_words(place.center_mm(), board) + ", " + aim +
         (place.roll_rad > 0.1 ? ", camera on its side" : "");
}

bool in_the_way(const Eigen::Vector3d& camera_mm, const Eigen::Vector3d& lamp_mm, const Board& board) {
  constexpr double kRadius_mm = 70;
  const Eigen::Vector3d middle = middle_of(board);
  const auto hides = [&](const Eigen::Vector3d& thing, const Eigen::Vector3d& from) {
    const Eigen::Vector3d axis = middle - from;
    const double along = (thing - from).dot(axis) / axis.squaredNorm();
    return along > 0 && along < 1 &&
           (thing - from - along * axis).norm() < along * board.size_mm.norm() / 2 + kRadius_mm;
  };
  return hides(camera_mm, lamp_mm) || hides(lamp_mm, camera_mm);
}

std::vector<Light> turned_lamps(const Light& light, const Board& board, const std::vector<double>& angles_deg) {
  std::vector<Light> out;
  const Eigen::Vector3d middle = middle_of(board);
  for (const double degrees : angles_deg) {
    const Eigen::AngleAxisd turn(degrees * std::numbers::pi / 180, Eigen::Vector3d::UnitZ());
    Light turned = light;
    turned.id += "-turned-" + std::to_string(std::lround(degrees));
    turned.position_mm = middle + turn * (light.position_mm - middle);
    turned.axis = turn * light.axis;
    out.push_back(turned);
  }
  return out;
}

void append_candidates(Bundle& bundle, const Board& board, const std::vector<CameraPlace>& places,
                       double corner_sigma_px, const std::optional<LensScatter>& lens_scatter) {
  std::set<int> known;
  for (const BundleCorner& c : bundle.corners)
    if (c.used) known.insert(c.tag);
  const bool all = bundle.corners.empty();
  for (const CameraPlace& place : places) {
    const std::size_t view = bundle.views.size();
    bundle.views.push_back(place.T_camera_board);
    if (lens_scatter) {
      bundle.view_lenses.resize(view);
      bundle.view_lenses.push_back({{}, *lens_scatter});
    }
    for (std::size_t t = 0; t < board.tags.list.size(); ++t) {
      if (!all && !known.count(static_cast<int>(t))) continue;
      const auto seen = corners_to_see(bundle, view, t, board.tags.list[t], board.tags.z_mm, corner_sigma_px);
      bool good = true;
      for (std::size_t k = 0; k < 4; ++k) {
        const Eigen::Vector2d &q = seen[k].q_px, &next = seen[(k + 1) % 4].q_px;
        good = good && q.allFinite() && q.x() > 0 && q.y() > 0 && q.x() < bundle.lens.width - 1 &&
               q.y() < bundle.lens.height - 1 && (next - q).norm() > kSmallestTag_px;
      }
      if (good) bundle.corners.insert(bundle.corners.end(), seen.begin(), seen.end());
    }
  }
}

LightCandidate light_candidate(const Problem& data, const State& state, const Bench& bench, const CameraPlace& place,
                               std::size_t light, const std::vector<bool>& free, const LightCandidateOptions& options) {
  const Board& board = *data.model.board;
  const Unknowns x = state.of(light);
  const auto n = static_cast<Eigen::Index>(free.size());
  LightCandidate out;
  out.information = Eigen::MatrixXd::Zero(n, n);

  // The photo's pixels, binned to the requested size, without content.
  Bench there = bench;
  View view;
  view.name = "candidate";
  view.T_camera_board = place.T_camera_board;
  there.views = {view};
  const Surface surface = surface_of(board, bench);
  LightView pixels;
  pixels.light = light;
  const double mm_per_px = place.distance_mm / bench.lens.intrinsics[0];
  // Large boards have coarser pixels: information grows with the number of grooves, not of pixels.
  constexpr double kMostPixels = 200'000;
  const double coarse_mm = std::max(options.pixel_mm, std::sqrt(board.size_mm.prod() / kMostPixels));
  const int bin = std::max(1, static_cast<int>(std::lround(coarse_mm / mm_per_px)));
  pixels.lens = binned_lens(bench.lens, bin);
  pixels.window = window_of(pixels.lens, place.T_camera_board, surface, {0, 0}, board.size_mm, 1);
  if (pixels.window.width < 8 || pixels.window.height < 8) return out;
  pixels.value = Image(pixels.window.width, pixels.window.height, 1);
  pixels.sigma = Image(pixels.window.width, pixels.window.height, 1, 1.0F);
  pixels.valid.assign(pixels.value.data.size(), 1);
  const double blur_px = std::exp(x[unknown::log_blur]);
  PhotoData photo = make_photo_data(pixels, bin, board, there, 0.8 + 3 * blur_px / bin);
  show_only(data.model.sample, photo);

  // Paper: a white and a black sample per tag.
  const Eigen::Vector3d eye = place.center_mm();
  const std::vector<Tag>& tags = bench.tags.empty() ? board.tags.list : bench.tags;
  const LampModel<double> lamp{x.segment<3>(unknown::lamp_position), x[unknown::log_intensity],
                               x.segment<2>(unknown::spot), x[unknown::spot + 2]};
  for (const Tag& tag : tags)
    for (const SampleKind kind : {SampleKind::white_paper, SampleKind::black_paper}) {
      LightSample sample;
      sample.kind = kind;
      sample.light = light;
      sample.tag = tag.id;
      sample.p_board = above_face(surface, tag.center_mm.x(), tag.center_mm.y(), board.tags.z_mm);
      sample.normal = face_normal(surface, tag.center_mm.x(), tag.center_mm.y());
      sample.to_camera = (eye - sample.p_board).normalized();
      const Eigen::Vector3d v = place.T_camera_board * sample.p_board;
      Eigen::Vector2d q;
      project(bench.lens, {&v, 1}, {&q, 1});
      if (!(v.z() > 0) || !q.allFinite() || q.x() < 0 || q.y() < 0 || q.x() > bench.lens.width - 1 ||
          q.y() > bench.lens.height - 1)
        continue;
      sample.radius2 = vignette_radius2(bench.lens.width, bench.lens.height, q.x(), q.y());
      const bool white = kind == SampleKind::white_paper;
      sample.value = vignette_at(x.data() + unknown::vignette, sample.radius2) *
                     paper_radiance(lamp, x[unknown::ambient], paper_albedo(board, kind), sample);
      if (!(sample.value > 0)) continue;
      if (white) out.light.paper = std::max(out.light.paper, sample.value);
      sample.sigma = options.noise * out.light.paper;
      const PaperEquation paper = paper_equation(data, state, sample, free);
      out.information += paper.row * paper.row.transpose();
    }

  // Metal: every pixel, with the error from the predicted brightness.
  const CarvedStates grooves(data.model);
  photo.photo.value = predict(data.model, photo, x, *grooves.at(x));
  std::vector<float> bright;
  const double noise = options.noise * out.light.paper;
  for (std::size_t i = 0; i < photo.weight.size(); ++i) {
    if (!(photo.weight[i] > 0)) continue;
    const double value = photo.photo.value.data[i];
    bright.push_back(photo.photo.value.data[i]);
    photo.weight[i] = static_cast<float>(1 / std::max(1e-300, std::hypot(noise, options.model_error * value)));
  }
  if (bright.empty()) return out;
  out.light.metal = quantile_in_place(bright, 0.999);
  FreeUnknowns wanted{};
  for (int i = 0; i < unknown::pose; ++i) wanted[i] = free[global_index(i, light)];
  const PhotoEquations equations = photo_equations(data.model, photo, x, grooves, wanted);
  for (int a = 0; a < unknown::pose; ++a)
    for (int b = 0; b < unknown::pose; ++b)
      out.information(global_index(a, light), global_index(b, light)) += equations.JtJ(a, b);

  ModelData whole = data.model;
  whole.crossings = Crossings::add;
  out.straddle =
      straddle_of(carved_at(whole, x), surface, std::exp(x[unknown::log_alpha]), std::exp(x[unknown::log_depth]),
                  board.tool_width_um, x.segment<3>(unknown::lamp_position), eye, profile_of(data.model.profile, x));
  return out;
}

}  // namespace burin

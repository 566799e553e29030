#include "tools/watch/shoot.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "burin/base/median.h"

namespace burin {
namespace {

constexpr double kDimPaper = 0.05, kSameDimEye = 0.04;  // paper's share of white in a dim photo, and kSameEye for it
constexpr double kSameEye = 0.01;  // share of the distance; more than the scatter of poses from one photo
constexpr double kDarkest = -8.5;  // stops: a darker photo clips for other reasons than a groove's glint
constexpr double kGlintStep = 1.0 / 8;
constexpr double kOneEye_mm = 1;  // shots within this distance are one place, under several lamps

bool has_error(const JudgedPhoto& photo) { return has_errors(photo.faults); }

std::vector<const PhotoFacts*> others_of(const Shoot& shoot, const std::filesystem::path& file) {
  std::vector<const PhotoFacts*> others;
  for (const JudgedPhoto& photo : shoot.photos)
    if (photo.facts.file != file) others.push_back(&photo.facts);
  return others;
}

// Returns true if both cameras have the same rotation about the line of sight; upside down counts as upright.
bool same_way_up(const Eigen::Isometry3d& a, const Eigen::Isometry3d& b) {
  const Eigen::Matrix3d R = a.linear() * b.linear().transpose();
  const double roll = std::atan2(R(1, 0) - R(0, 1), R(0, 0) + R(1, 1));
  return std::cos(2 * roll) > 0;  // within 45 degrees
}

// Returns the exposure factor for white paper at 60 %, from all photos with a measurement; 0 without any.
double paper_factor(const Shoot& shoot) {
  std::vector<double> factors;
  for (const JudgedPhoto& photo : shoot.photos) {
    const PhotoFacts& f = photo.facts;
    if (f.exposure_factor && f.paper > 0.01 && f.paper_clipped <= kPaperLost)
      factors.push_back(*f.exposure_factor * kPaperAt / f.paper);
  }
  return median_of(std::move(factors));
}

std::optional<double> stops_of(const PhotoFacts& facts, const Shoot& shoot) {
  if (!facts.exposure_factor) return std::nullopt;
  if (facts.paper > 0.01 && facts.paper_clipped <= kPaperLost) return std::log2(facts.paper / kPaperAt);
  const double at_paper = paper_factor(shoot);
  if (!(at_paper > 0)) return std::nullopt;
  return std::log2(*facts.exposure_factor / at_paper);
}

bool same_place(const PhotoFacts& a, const PhotoFacts& b, const Board& board) {
  const auto eye_a = a.eye_mm(), eye_b = b.eye_mm();
  if (!eye_a || !eye_b) return false;
  const Eigen::Vector3d middle(board.size_mm.x() / 2, board.size_mm.y() / 2, 0);
  const double reach = std::min(a.paper, b.paper) < kDimPaper ? kSameDimEye : kSameEye;
  return (*eye_a - *eye_b).norm() <= reach * (*eye_a - middle).norm();
}

// Union of the results of all photos from one place.
struct PlaceState {
  bool tags = false, glints = false;
};

PlaceState place_state(const JudgedPhoto& at, const Shoot& shoot, std::size_t from = 0) {
  PlaceState out;
  for (std::size_t i = from; i < shoot.photos.size(); ++i) {
    const JudgedPhoto& photo = shoot.photos[i];
    if (has_error(photo) || photo.shot != at.shot || photo.light != at.light) continue;
    if (&photo != &at && !same_place(photo.facts, at.facts, shoot.board)) continue;
    out.tags = out.tags || shows_tags_well(photo.facts, shoot.board);
    // Highlights in the darkest photo come from a tag's varnish, a drop or a screw; no exposure avoids their clipping.
    out.glints =
        out.glints || holds_glints(photo.facts) || (photo.stops && *photo.stops <= kDarkest) || !photo.facts.carve_seen;
  }
  return out;
}

bool is_done(const JudgedPhoto& at, const Shoot& shoot) {
  const PlaceState state = place_state(at, shoot);
  return state.tags && state.glints;
}

void find_shot(const Shoot& shoot, JudgedPhoto& photo) {
  const auto eye = photo.facts.eye_mm();
  if (!eye) return;
  for (std::size_t i = 0; i < shoot.wanted.size(); ++i) {
    const WantedShot& shot = shoot.wanted[i];
    if (!photo.light.empty() && shot.light != photo.light) continue;
    const Offset offset = offset_of(shot.eye_mm, *eye, shoot.board, shot.tolerance);
    const bool wrong = shot.T_camera_board && !same_way_up(*shot.T_camera_board, photo.facts.pose->T_camera_board);
    const auto rank = [](bool wrong_way_up, const Offset& o) {
      return std::pair(o.reaches <= 1 ? (wrong_way_up ? 1 : 0) : 2, o.reaches <= 1 ? o.reaches : o.mm);
    };
    if (photo.nearest) {
      const bool one_eye = (shoot.wanted[*photo.nearest].eye_mm - shot.eye_mm).norm() < kOneEye_mm &&
                           photo.wrong_way_up == wrong && offset.reaches <= 1;
      if (one_eye ? state_of(shoot, *photo.nearest) != ShotState::done || state_of(shoot, i) == ShotState::done
                  : rank(wrong, offset) >= rank(photo.wrong_way_up, photo.offset))
        continue;
    }
    photo.nearest = i;
    photo.offset = offset;
    photo.wrong_way_up = wrong;
  }
  if (photo.nearest && photo.offset.reaches <= 1 && !photo.wrong_way_up) photo.shot = photo.nearest;
}

// Assigns the shot of a photo that is too dark for a pose. It is the shot from the place of `before`, the preceding
// photo, under this photo's lamp.
void take_place_of(const JudgedPhoto& before, const Shoot& shoot, JudgedPhoto& photo) {
  if (before.light == photo.light) {
    photo.shot = before.shot;
    photo.nearest = before.nearest;
    photo.offset = before.offset;
    photo.wrong_way_up = before.wrong_way_up;
    return;
  }
  if (!before.shot) return;
  for (std::size_t i = 0; i < shoot.wanted.size() && !photo.shot; ++i)
    if (shoot.wanted[i].light == photo.light &&
        (shoot.wanted[i].eye_mm - shoot.wanted[*before.shot].eye_mm).norm() < kOneEye_mm)
      photo.shot = photo.nearest = i;
}

NextStep move_on(const Shoot& shoot) {
  NextStep next;
  for (std::size_t i = 0; i < shoot.wanted.size(); ++i) {
    if (state_of(shoot, i) == ShotState::done) continue;
    next.kind = NextStep::Kind::move;
    next.shot = i;
    next.factor = paper_factor(shoot);
    return next;
  }
  if (places_of(shoot) < shoot.least_places) next.kind = NextStep::Kind::further;
  return next;
}

}  // namespace

bool is_further_place(const JudgedPhoto& photo, const Shoot& shoot) {
  constexpr double kAttempt = 3;  // in reaches: a nearer photo is an attempt at the wanted place
  return !photo.shot && photo.facts.pose && shoot.least_places > 0 &&
         (!photo.nearest || photo.offset.reaches > kAttempt);
}

const JudgedPhoto& add_photo(PhotoFacts facts, Shoot& shoot) {
  remove_photo(facts.file, shoot);
  if (const NextStep before = next_step(shoot); before.kind == NextStep::Kind::move) shoot.sent_to = before.shot;
  JudgedPhoto photo;
  photo.facts = std::move(facts);
  photo.light = shoot.light;
  photo.faults = photo_faults(photo.facts, shoot.board, others_of(shoot, photo.facts.file));
  photo.stops = stops_of(photo.facts, shoot);
  // The dark end of a bracket belongs to the place of its other photos, for any plan.
  if (photo.facts.place_of_before && !shoot.photos.empty()) {
    take_place_of(shoot.photos.back(), shoot, photo);
  } else {
    const auto one = std::find_if(shoot.photos.rbegin(), shoot.photos.rend(), [&](const JudgedPhoto& other) {
      return other.shot && other.light == photo.light && same_place(other.facts, photo.facts, shoot.board);
    });
    find_shot(shoot, photo);
    // A bracket stays together: shots from one place under two lamps follow each other as complete brackets.
    if (one != shoot.photos.rend() && photo.shot && !is_done(*one, shoot)) photo.shot = photo.nearest = one->shot;
  }
  shoot.photos.push_back(std::move(photo));
  return shoot.photos.back();
}

bool remove_photo(const std::filesystem::path& file, Shoot& shoot) {
  return std::erase_if(shoot.photos, [&](const JudgedPhoto& photo) { return photo.facts.file == file; }) > 0;
}

ShotState state_of(const Shoot& shoot, std::size_t shot) {
  ShotState state = ShotState::open;
  for (const JudgedPhoto& photo : shoot.photos) {
    if (photo.shot != shot) continue;
    if (has_error(photo)) {
      if (state == ShotState::open) state = ShotState::again;
      continue;
    }
    if (is_done(photo, shoot)) return ShotState::done;
    state = ShotState::begun;
  }
  return state;
}

std::size_t places_of(const Shoot& shoot) {
  std::vector<const JudgedPhoto*> places;
  for (const JudgedPhoto& photo : shoot.photos)
    if (!has_error(photo) && photo.facts.pose && std::none_of(places.begin(), places.end(), [&](const JudgedPhoto* p) {
          return same_place(p->facts, photo.facts, shoot.board);
        }))
      places.push_back(&photo);
  return places.size();
}

NextStep next_exposure(const Shoot& shoot, std::size_t from) {
  NextStep next;
  if (shoot.photos.empty()) return next;
  const JudgedPhoto& last = shoot.photos.back();
  const PhotoFacts& facts = last.facts;
  if (!facts.exposure_factor) return next;
  next.shot = last.shot;
  const PlaceState state = place_state(last, shoot, from);
  if (!state.tags) {
    next.kind = NextStep::Kind::expose;
    const bool measured = facts.paper > 0.002 && facts.paper_clipped <= kPaperLost;
    if (measured)
      next.factor = *facts.exposure_factor * kPaperAt / facts.paper;
    else if (facts.paper_clipped > kPaperLost)
      next.factor = *facts.exposure_factor / 4;
    else
      next.factor = paper_factor(shoot);
    return next;
  }
  if (state.glints) return next;
  double darkest = *facts.exposure_factor;
  for (std::size_t i = from; i < shoot.photos.size(); ++i)
    if (const JudgedPhoto& photo = shoot.photos[i]; !has_error(photo) && photo.light == last.light &&
                                                    photo.facts.exposure_factor &&
                                                    same_place(photo.facts, facts, shoot.board))
      darkest = std::min(darkest, *photo.facts.exposure_factor);
  next.kind = NextStep::Kind::expose;
  next.factor = darkest * kGlintStep;
  next.for_glints = true;
  return next;
}

NextStep next_step(const Shoot& shoot) {
  if (shoot.photos.empty()) return move_on(shoot);
  const JudgedPhoto& last = shoot.photos.back();
  if (has_error(last) && !(last.shot && state_of(shoot, *last.shot) == ShotState::done)) {
    NextStep again;
    again.kind = NextStep::Kind::retake;
    again.shot = last.shot;
    if (last.facts.tags.empty() && last.facts.exposure_factor && last.facts.bright < 0.02)
      again.factor = 8 * *last.facts.exposure_factor;
    return again;
  }
  if (last.shot || shoot.wanted.empty() || is_further_place(last, shoot)) {
    const NextStep exposure = next_exposure(shoot);
    if (exposure.kind == NextStep::Kind::expose) return exposure;
  }
  return move_on(shoot);
}

}  // namespace burin

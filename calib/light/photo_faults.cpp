#include "burin/calib/light/photo_faults.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <set>
#include <utility>

#include "burin/base/files/decimals.h"
#include "burin/base/median.h"

namespace burin {
namespace {

constexpr double kBlurred_px = 1.6;     // edges of a sharp photo: 0.5 to 1 px, half a pixel of it the pixel itself
constexpr double kBlurredFactor = 1.8;  // times the session's median

template <typename Names>
std::string listed(const Names& names) {
  constexpr std::size_t kMost = 5;
  std::string out;
  std::size_t said = 0;
  for (const auto& name : names) {
    if (said == kMost) return out + " and " + std::to_string(names.size() - kMost) + " more";
    out += (said++ ? ", " : "") + name;
  }
  return out;
}

// The lens' vignetting from paper alone, by a robust fit: log white = light on the tag + the photo's exposure + v1 r^2
// + v2 r^4.
Eigen::Vector2d paper_vignetting(std::span<const LightSample* const> white) {
  std::map<std::pair<std::size_t, int>, Eigen::Index> tag;  // under each light
  std::map<std::size_t, Eigen::Index> photo;
  for (const LightSample* s : white) {
    tag.try_emplace({s->light, s->tag}, static_cast<Eigen::Index>(tag.size()));
    photo.try_emplace(s->light_view, static_cast<Eigen::Index>(photo.size()));
  }
  const auto n_tag = static_cast<Eigen::Index>(tag.size()), n = n_tag + static_cast<Eigen::Index>(photo.size()) + 2;
  Eigen::VectorXd x = Eigen::VectorXd::Zero(n);
  constexpr int kRounds = 15;
  for (int round = 0; round < kRounds; ++round) {
    // Weak priors: exposures and light are correlated, and so are v1 and v2 if all tags are on a ring.
    Eigen::MatrixXd H = 1e-3 * Eigen::MatrixXd::Identity(n, n);
    Eigen::VectorXd g = Eigen::VectorXd::Zero(n);
    H.bottomRightCorner<2, 2>().diagonal() += Eigen::Vector2d(4, 16) / (round == 0 ? 1 : 0.02);
    for (const LightSample* s : white) {
      const std::array<std::pair<Eigen::Index, double>, 4> row{{{tag[{s->light, s->tag}], 1},
                                                                {n_tag + photo[s->light_view], 1},
                                                                {n - 2, s->radius2},
                                                                {n - 1, s->radius2 * s->radius2}}};
      double r = std::log(s->value);
      for (const auto& [i, c] : row) r -= c * x[i];
      const double weight = round == 0 ? 1 : 1 / std::max(0.02, std::abs(r));
      for (const auto& [i, c] : row) {
        for (const auto& [j, d] : row) H(i, j) += weight * c * d;
        g[i] += weight * c * std::log(s->value);
      }
    }
    x = H.ldlt().solve(g);
  }
  return x.tail<2>();
}

}  // namespace

void leave_out_blurred(std::vector<ViewTags>& pictures, std::size_t keep_views) {
  std::vector<double> blur, known;  // one per picture: 0 with too few tags
  for (const ViewTags& picture : pictures) {
    std::vector<double> sides;
    for (const TagDetection& tag : picture.tags)
      sides.insert(sides.end(), tag.side_blur_px.begin(), tag.side_blur_px.end());
    constexpr std::size_t kFewestSides = 8;
    blur.push_back(sides.size() < kFewestSides ? 0 : median_of(std::move(sides)));
    if (blur.back() > 0) known.push_back(blur.back());
  }
  const double usual = median_of(known);
  std::vector<std::pair<double, std::size_t>> worst;
  for (std::size_t i = 0; i < pictures.size(); ++i)
    if (blur[i] > std::max(kBlurred_px, kBlurredFactor * usual)) worst.emplace_back(-blur[i], i);
  std::sort(worst.begin(), worst.end());
  for (const auto& [minus_blur, i] : worst) {
    std::set<std::string> views;
    for (std::size_t k = 0; k < pictures.size(); ++k)
      if (k != i && !pictures[k].tags.empty()) views.insert(pictures[k].view);
    if (views.size() < keep_views) return;
    for (const TagDetection& tag : pictures[i].tags)
      pictures[i].rejected.push_back(
          {tag.id, 0.25 * (tag.corner_px[0] + tag.corner_px[1] + tag.corner_px[2] + tag.corner_px[3]),
           TagFault::photo_blurred, blur[i], usual});
    pictures[i].tags.clear();
  }
}

std::vector<Finding> rejected_tags(std::span<const ViewTags> pictures, const Board& board,
                                   const BoardSolution& solved) {
  struct Refused {
    std::set<int> ids;
    std::string why;
  };
  std::map<TagFault, std::map<std::string, Refused>> by_fault;  // and view
  std::map<std::string, std::set<int>> seen;
  std::map<std::string, std::filesystem::path> file;
  for (const ViewTags& picture : pictures) {
    if (std::none_of(solved.views.begin(), solved.views.end(), [&](const View& v) { return v.name == picture.view; }))
      continue;
    file[picture.view] = picture.file;
    for (const TagDetection& tag : picture.tags) seen[picture.view].insert(tag.id);
    for (const RejectedTag& tag : picture.rejected) {
      seen[picture.view].insert(tag.id);
      Refused& refused = by_fault[tag.fault][picture.view];
      refused.ids.insert(tag.id);
      refused.why = in_words(tag);
    }
  }
  std::vector<Finding> findings;
  for (auto& [fault, views] : by_fault) {
    std::map<int, std::vector<std::string>> by_tag;
    for (const auto& [view, refused] : views) {
      if (2 * refused.ids.size() > seen[view].size() && refused.ids.size() > 2) {
        findings.push_back({FindingCode::tags_omitted, Finding::Severity::warning, file[view],
                            std::to_string(refused.ids.size()) + " of " + std::to_string(seen[view].size()) +
                                " tags are not used in view " + view,
                            refused.why});
        continue;
      }
      for (const int id : refused.ids) by_tag[id].push_back(view);
    }
    for (const auto& [id, in] : by_tag) {
      const bool known = std::any_of(board.tags.list.begin(), board.tags.list.end(),
                                     [id = id](const Tag& tag) { return tag.id == id; });
      findings.push_back(
          {FindingCode::tags_omitted,
           known ? Finding::Severity::warning : Finding::Severity::note,
           {},
           "tag " + std::to_string(id) + " is not used in view" + (in.size() > 1 ? "s " : " ") + listed(in),
           views[in.front()].why});
    }
  }
  return findings;
}

std::vector<Finding> unseen_tags(std::span<const ViewTags> pictures, const Board& board, const BoardSolution& solved) {
  std::vector<Finding> findings;
  const Surface surface{board.size_mm, solved.bow_mm, board.bend};
  for (const Tag& tag : board.tags.list) {
    std::set<std::string> expected, missed;
    const auto corners = tag_corners_mm(tag);
    for (const View& view : solved.views) {
      bool seen = false, inside = true;
      for (const ViewTags& picture : pictures) {
        if (picture.view != view.name) continue;
        seen = seen || std::any_of(picture.tags.begin(), picture.tags.end(),
                                   [&](const TagDetection& t) { return t.id == tag.id; });
        // Tags seen and refused have findings already.
        seen = seen || std::any_of(picture.rejected.begin(), picture.rejected.end(),
                                   [&](const RejectedTag& t) { return t.id == tag.id; });
      }
      const Lens own = view.own_lens ? with_own(solved.lens, *view.own_lens) : solved.lens;
      std::array<Eigen::Vector2d, 4> q;
      for (int k = 0; k < 4; ++k) {
        const Eigen::Vector3d p = above_face(surface, corners[k].x(), corners[k].y(), board.tags.z_mm);
        const Eigen::Vector3d v = view.T_camera_board * p;
        project(own, {&v, 1}, {&q[k], 1});
        inside = inside && v.z() > 0 && q[k].allFinite();
      }
      for (int k = 0; k < 4 && inside; ++k) {
        const double side = (q[(k + 1) % 4] - q[k]).norm(), margin = 0.4 * side;  // its own border, and quiet paper
        constexpr double kReadable_px = 20;
        inside = side > kReadable_px && q[k].x() > margin && q[k].y() > margin &&
                 q[k].x() < solved.lens.width - margin && q[k].y() < solved.lens.height - margin;
      }
      if (!inside) continue;
      expected.insert(view.name);
      if (!seen) missed.insert(view.name);
    }
    if (missed.empty()) continue;
    const bool always = missed.size() == expected.size();
    const bool often = 3 * missed.size() >= expected.size();
    findings.push_back({FindingCode::tags_unread,
                        always || often ? Finding::Severity::warning : Finding::Severity::note,
                        {},
                        "tag " + std::to_string(tag.id) + " should be in view" + (missed.size() > 1 ? "s " : " ") +
                            listed(missed) + (always && expected.size() > 1 ? ", all that hold its place," : "") +
                            " but cannot be read there",
                        always ? "it is covered, damaged or missing, or its id in board.json is wrong"
                               : "it is covered, glares or is blurred there"});
  }
  return findings;
}

std::vector<LampGroup> photos_of_another_lamp(std::span<const LightSample> samples, const Bench& bench) {
  std::vector<const LightSample*> white_samples;
  for (const LightSample& s : samples)
    if (s.kind == SampleKind::white_paper && s.value > 0) white_samples.push_back(&s);
  const Eigen::Vector2d vignette = paper_vignetting(white_samples);
  std::map<std::size_t, std::map<std::size_t, std::map<int, double>>> white;  // log; by light, light view, tag
  for (const LightSample* s : white_samples)
    white[s->light][s->light_view][s->tag] = std::log(s->value) - s->radius2 * (vignette[0] + s->radius2 * vignette[1]);
  constexpr double kAlike = 0.03;         // RMS over the board: uneven paper, gloss, vignetting
  constexpr double kDifferentFactor = 4;  // times the spread of the agreeing photos
  constexpr std::size_t kFewestTags = 5;
  std::vector<LampGroup> groups;
  for (const auto& white_of_lamp : white) {
    const auto& photos = white_of_lamp.second;
    std::vector<std::size_t> index;
    for (const auto& [light_view, tags] : photos)
      if (tags.size() >= kFewestTags) index.push_back(light_view);
    const std::size_t n = index.size();
    if (n < 3) continue;
    // Difference of two photos' shading: robust scatter of the log ratios around their median.
    const auto distance = [&](std::size_t a, std::size_t b) {
      std::vector<double> ratio;
      for (const auto& [tag, value] : photos.at(index[a])) {
        const auto other = photos.at(index[b]).find(tag);
        if (other != photos.at(index[b]).end()) ratio.push_back(value - other->second);
      }
      if (ratio.size() < kFewestTags) return -1.0;
      const double middle = median_of(ratio);
      for (double& r : ratio) r = std::abs(r - middle);
      return 1.4826 * median_of(ratio);
    };
    Eigen::MatrixXd d = Eigen::MatrixXd::Zero(static_cast<Eigen::Index>(n), static_cast<Eigen::Index>(n));
    std::vector<double> nearest;  // each photo's distance to the most similar one: the usual scatter
    for (std::size_t a = 0; a < n; ++a) {
      double best = -1;
      for (std::size_t b = 0; b < n; ++b) {
        if (a == b) continue;
        d(static_cast<Eigen::Index>(a), static_cast<Eigen::Index>(b)) = distance(a, b);
        const double here = d(static_cast<Eigen::Index>(a), static_cast<Eigen::Index>(b));
        if (here >= 0 && (best < 0 || here < best)) best = here;
      }
      if (best >= 0) nearest.push_back(best);
    }
    const double alike = std::max(kAlike, kDifferentFactor * median_of(nearest));
    // Photos linked by similarity form sets; the largest set is the lamp's.
    std::vector<int> set_of(n, -1);
    std::vector<std::vector<std::size_t>> sets;
    for (std::size_t start = 0; start < n; ++start) {
      if (set_of[start] >= 0) continue;
      sets.push_back({start});
      set_of[start] = static_cast<int>(sets.size()) - 1;
      for (std::size_t k = 0; k < sets.back().size(); ++k)
        for (std::size_t other = 0; other < n; ++other) {
          const double here = d(static_cast<Eigen::Index>(sets.back()[k]), static_cast<Eigen::Index>(other));
          if (set_of[other] >= 0 || here < 0 || here > alike) continue;
          set_of[other] = set_of[start];
          sets.back().push_back(other);
        }
    }
    std::stable_sort(sets.begin(), sets.end(), [](const auto& a, const auto& b) { return a.size() > b.size(); });
    for (std::size_t s = 1; s < sets.size(); ++s) {
      LampGroup group;
      group.light = bench.lights[white_of_lamp.first].id;
      std::vector<double> between;
      for (const std::size_t a : sets[s]) {
        group.light_views.push_back(index[a]);
        for (const std::size_t b : sets[0])
          if (const double here = d(static_cast<Eigen::Index>(a), static_cast<Eigen::Index>(b)); here >= 0)
            between.push_back(here);
      }
      if (between.empty()) continue;  // no tag in common: no comparison
      group.spread = median_of(between);
      groups.push_back(group);
    }
  }
  return groups;
}

namespace {

// White paper under one lamp: its place and brightness, and the pose of the camera.
struct LitPaper {
  Eigen::Vector3d p_board, normal;
  double log_value, radius2;
  Eigen::Isometry3d T_board_camera;
};

// RMS residual of the paper's log brightness under a lamp there, with intensity and vignetting fitted. `on_camera`: the
// lamp's position is in the camera's frame, not in the board's.
double paper_left(const std::vector<LitPaper>& paper, const Eigen::Vector3d& lamp_mm, bool on_camera) {
  const auto n = static_cast<Eigen::Index>(paper.size());
  Eigen::MatrixXd A(n, 3);
  Eigen::VectorXd left(n);
  for (Eigen::Index i = 0; i < n; ++i) {
    const LitPaper& at = paper[static_cast<std::size_t>(i)];
    const Eigen::Vector3d lamp = on_camera ? Eigen::Vector3d(at.T_board_camera * lamp_mm) : lamp_mm;
    const Eigen::Vector3d way = lamp - at.p_board;
    const double cosine = way.normalized().dot(at.normal);
    if (!(cosine > 1e-3)) return std::numeric_limits<double>::infinity();
    left[i] = at.log_value - std::log(cosine / way.squaredNorm());
    A.row(i) << 1, at.radius2, at.radius2 * at.radius2;
  }
  left -= A * A.colPivHouseholderQr().solve(left);
  return std::sqrt(left.squaredNorm() / static_cast<double>(n));
}

// Its minimum from a start, by a search along axes with shrinking steps.
double least_paper_left(const std::vector<LitPaper>& paper, Eigen::Vector3d lamp_mm, double step_mm, bool on_camera) {
  double best = paper_left(paper, lamp_mm, on_camera);
  const double last_mm = 0.02 * step_mm;
  constexpr int kMost = 400;
  for (int round = 0; round < kMost && step_mm > last_mm; ++round) {
    bool better = false;
    for (int axis = 0; axis < 3; ++axis)
      for (const double by : {-step_mm, step_mm}) {
        const Eigen::Vector3d there = lamp_mm + by * Eigen::Vector3d::Unit(axis);
        if (const double left = paper_left(paper, there, on_camera); left < best) {
          best = left;
          lamp_mm = there;
          better = true;
        }
      }
    if (!better) step_mm *= 0.5;
  }
  return best;
}

}  // namespace

std::vector<std::string> lamps_that_ride(std::span<const LightView> views, std::span<const LightSample> samples,
                                         const Bench& bench) {
  constexpr std::size_t kFewestViews = 4, kFewestTags = 5;
  constexpr double kExplained = 0.06, kFarBetter = 0.4;
  std::vector<std::string> out;
  for (std::size_t light = 0; light < bench.lights.size(); ++light) {
    std::vector<LitPaper> paper;
    std::map<std::size_t, std::size_t> tags;  // by view
    double distance_mm = 0;
    for (const LightSample& sample : samples) {
      if (sample.light != light || sample.kind != SampleKind::white_paper || !(sample.value > 0)) continue;
      const std::size_t view = views[sample.light_view].view;
      const Eigen::Isometry3d T_board_camera = bench.views[view].T_camera_board.inverse();
      paper.push_back({sample.p_board, sample.normal, std::log(sample.value), sample.radius2, T_board_camera});
      distance_mm = std::max(distance_mm, (T_board_camera.translation() - sample.p_board).norm());
      ++tags[view];
    }
    std::size_t usable = 0;
    for (const auto& [view, count] : tags) usable += count >= kFewestTags ? 1 : 0;
    if (usable < kFewestViews) continue;
    const double riding = least_paper_left(paper, Eigen::Vector3d::Zero(), 0.1 * distance_mm, true);
    if (!(riding < kExplained)) continue;
    double standing = std::numeric_limits<double>::infinity();
    const Eigen::Vector3d middle = paper[paper.size() / 2].p_board;
    for (const double x : {-1., 0., 1.})
      for (const double y : {-1., 0., 1.})
        standing = std::min(standing, least_paper_left(paper, middle + distance_mm * Eigen::Vector3d(x, y, 1),
                                                       0.5 * distance_mm, false));
    if (riding < kFarBetter * standing) out.push_back(bench.lights[light].id);
  }
  return out;
}

namespace {

constexpr double kTonesReach = 0.06;      // half the side of a pixel's surroundings, of the picture's width
constexpr double kTonesStored = 1 / 2.2;  // approximate encoding of stored pictures

// Sums over rectangles of a view's stored brightness, for means around any of its pixels.
class BrightnessAround {
 public:
  explicit BrightnessAround(const LightView& view)
      : width_(view.value.width),
        height_(view.value.height),
        reach_(std::max(2, static_cast<int>(kTonesReach * view.lens.width))),
        sums_(static_cast<std::size_t>(width_ + 1) * (height_ + 1), 0) {
    for (int y = 0; y < height_; ++y) {
      double row = 0;
      for (int x = 0; x < width_; ++x) {
        row += std::pow(std::max(0.0, static_cast<double>(view.value.at(x, y))), kTonesStored);
        sums_[at(x + 1, y + 1)] = sums_[at(x + 1, y)] + row;
      }
    }
  }

  // The logarithm of the mean around a pixel, without pixels nearer than `hole_px`.
  double log_mean(int x, int y, int hole_px) const {
    const auto [all, count] = sum(x, y, reach_);
    const auto [hole, in_hole] = hole_px > 0 ? sum(x, y, std::min(hole_px, reach_ - 1)) : std::pair(0.0, 0.0);
    return std::log(std::max(1e-12, (all - hole) / std::max(1.0, count - in_hole)));
  }

 private:
  std::size_t at(int x, int y) const { return static_cast<std::size_t>(y) * (width_ + 1) + x; }
  std::pair<double, double> sum(int x, int y, int reach) const {
    const int x0 = std::clamp(x - reach, 0, width_), x1 = std::clamp(x + reach + 1, 0, width_),
              y0 = std::clamp(y - reach, 0, height_), y1 = std::clamp(y + reach + 1, 0, height_);
    return {sums_[at(x1, y1)] - sums_[at(x0, y1)] - sums_[at(x1, y0)] + sums_[at(x0, y0)],
            static_cast<double>(x1 - x0) * (y1 - y0)};
  }

  int width_, height_, reach_;
  std::vector<double> sums_;  // [y][x]: of all pixels above and left
};

// The logarithm of each sample's surroundings; for paper without its own tag.
std::vector<double> around_samples(std::span<const LightView> views, std::span<const LightSample> samples,
                                   const Bench& bench) {
  std::vector<BrightnessAround> around;
  around.reserve(views.size());
  for (const LightView& view : views) around.emplace_back(view);
  std::map<int, double> side_mm;
  for (const Tag& tag : bench.tags) side_mm[tag.id] = tag.size_mm;
  std::vector<double> out;
  for (const LightSample& sample : samples) {
    const LightView& view = views[sample.light_view];
    const Eigen::Vector3d v = bench.views[view.view].T_camera_board * sample.p_board;
    Eigen::Vector2d q;
    project(view.lens, {&v, 1}, {&q, 1});
    constexpr double kOfSide = 0.8;  // half a tag, with its border and the white around it
    const auto side = side_mm.find(sample.tag);
    const double hole = side == side_mm.end() ? 0 : kOfSide * side->second * view.lens.intrinsics[0] / v.z();
    out.push_back(around[sample.light_view].log_mean(static_cast<int>(std::lround(q.x())) - view.window.x0,
                                                     static_cast<int>(std::lround(q.y())) - view.window.y0,
                                                     static_cast<int>(hole)));
  }
  return out;
}

}  // namespace

std::optional<LocalTones> find_local_tones(std::span<const LightView> views, std::span<const LightSample> samples,
                                           const Bench& bench) {
  std::vector<LightSample> paper;
  for (const LightSample& sample : samples)
    if (sample.kind == SampleKind::white_paper && sample.value > 0) paper.push_back(sample);
  const std::vector<double> around = around_samples(views, paper, bench);
  // Unknowns: photos (each under its lamp), tags under a lamp, vignetting, and the power.
  std::map<std::size_t, Eigen::Index> photos;
  std::map<std::pair<std::size_t, int>, Eigen::Index> tags;
  for (const LightSample& s : paper) {
    photos.emplace(s.light_view, 0);
    tags.emplace(std::pair(s.light, s.tag), 0);
  }
  Eigen::Index next = 0;
  for (auto& [view, at] : photos) at = next++;
  for (auto& [tag, at] : tags) at = next++;
  const Eigen::Index vignette = next, power = next + 2, n = next + 3;
  const auto count = static_cast<double>(paper.size());
  constexpr double kFewestMore = 20;  // samples beyond the unknowns
  if (count < static_cast<double>(n) + kFewestMore) return std::nullopt;
  Eigen::VectorXd x = Eigen::VectorXd::Zero(n);
  double scatter = 0, sigma = 0;
  constexpr int kRounds = 6;
  for (int round = 0; round < kRounds; ++round) {
    Eigen::MatrixXd H = 1e-9 * Eigen::MatrixXd::Identity(n, n);  // photos and tags share a constant
    Eigen::VectorXd g = Eigen::VectorXd::Zero(n);
    std::vector<double> off;
    for (std::size_t i = 0; i < paper.size(); ++i) {
      const LightSample& s = paper[i];
      Eigen::VectorXd row = Eigen::VectorXd::Zero(n);
      row[photos.at(s.light_view)] = row[tags.at({s.light, s.tag})] = 1;
      row[vignette] = s.radius2;
      row[vignette + 1] = s.radius2 * s.radius2;
      row[power] = around[i];
      const double left = std::log(s.value) - row.dot(x);
      off.push_back(std::abs(left));
      constexpr double kRobust = 2;
      const double weight = scatter > 0 ? 1 / (1 + std::pow(left / (kRobust * scatter), 2)) : 1;
      H.selfadjointView<Eigen::Lower>().rankUpdate(row, weight);
      g += weight * left * row;
    }
    const Eigen::LDLT<Eigen::MatrixXd> solver(H.selfadjointView<Eigen::Lower>());
    x += solver.solve(g);
    scatter = std::max(1e-6, 1.4826 * median_of(off));
    const double freedom = std::sqrt(count / (count - static_cast<double>(n)));
    sigma = freedom * scatter * std::sqrt(std::max(0.0, solver.solve(Eigen::VectorXd::Unit(n, power))[power]));
  }
  constexpr double kLeast = 0.03, kBeyondChance = 6;
  if (x[power] > -kLeast || x[power] > -kBeyondChance * sigma) return std::nullopt;
  return LocalTones{x[power], sigma};
}

Image without_local_tones(const LightView& view, const LocalTones& tones) {
  const BrightnessAround around(view);
  Image out(view.value.width, view.value.height, 1);
  double sum = 0;
  for (int y = 0; y < out.height; ++y)
    for (int x = 0; x < out.width; ++x) {
      const double log_factor = -tones.power * around.log_mean(x, y, 0);
      out.at(x, y) = static_cast<float>(log_factor);
      sum += log_factor;
    }
  const double mean = sum / std::max(1.0, static_cast<double>(out.data.size()));
  for (float& v : out.data) v = static_cast<float>(std::exp(v - mean));
  return out;
}

std::vector<LightSample> without_local_tones(std::span<const LightView> views, std::span<const LightSample> samples,
                                             const LocalTones& tones, const Bench& bench) {
  const std::vector<double> around = around_samples(views, samples, bench);
  double mean = 0;
  for (const double one : around) mean += one / static_cast<double>(around.size());
  std::vector<LightSample> out(samples.begin(), samples.end());
  for (std::size_t i = 0; i < out.size(); ++i) {
    const double factor = std::exp(-tones.power * (around[i] - mean));
    out[i].value *= factor;
    out[i].sigma *= factor;
  }
  return out;
}

Finding told(const LocalTones& tones) {
  return make_warning(FindingCode::camera_settings,
                      "white paper is stored the darker the brighter its surroundings are (by their power of " +
                          fixed(tones.power, 2) + " +- " + fixed(tones.sigma, 2) +
                          "): the camera brightens the dark, by local tone mapping (\"HDR\", \"smart tones\"), which "
                          "nothing undoes; lamp, "
                          "roughnesses and depth may be far off, and their sigmas count by how much",
                      "take raw files (DNG), or switch HDR and automatic enhancement off, and take the photos again");
}

}  // namespace burin

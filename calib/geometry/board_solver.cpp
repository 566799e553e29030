#include "burin/calib/geometry/board_solver.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <map>
#include <numbers>
#include <set>

#include "burin/base/error.h"
#include "burin/base/files/decimals.h"
#include "burin/base/median.h"
#include "burin/calib/geometry/lens_solver.h"
#include "burin/calib/geometry/own_focal.h"

namespace burin {
namespace {

constexpr double kFloor_px = 0.004;      // error beyond the line fit's own noise: sampling, neighboring marks
constexpr double kSeedSigma_px = 0.3;    // while lens and poses are only initial guesses
constexpr double kTagOutlier_sigma = 4;  // a tag this far from its position in board.json is misplaced
constexpr double kFarView_px = 1.5;      // residual of a photo with another lens, while the lens is rough,
constexpr double kFarFactor = 8;         // and its ratio to the residuals of the others
constexpr double kOddView_px = 0.2;      // these limits for a known lens: such a photo resembles a noisy one, but
constexpr double kOddFactor = 6;         // focus breathing of 2 % moves its camera by 2 % of its distance
constexpr double kTornView = 0.3;        // share of a photo's tags that are outliers there and fit the other photos

// Priors for a lens that differs from all others: a digital zoom, or an enlarged crop.
constexpr double kAnyShift = 0.1;                    // of the picture's longer side
constexpr double kAnyFocal = 0.5;                    // of a logarithm
constexpr double kZoomed = 5;                        // ratio to the usual scatter for a zoom
constexpr double kLittle_px = 0.02, kLittle = 1e-5;  // of views with equal lenses, next to an enlarged one

constexpr const char* kOddPhoto =
    "it was taken with another focal length or focus, was moved between its exposures or exposed twice; take it again";

// State of the solve: the bundle, and its corners in the caller's terms.
struct Solver {
  const Board& board;
  const std::vector<ViewTags>& pictures;
  const BoardSolverOptions& options;

  Solver(const Board& b, const std::vector<ViewTags>& p, const BoardSolverOptions& o)
      : board(b), pictures(p), options(o) {}

  Bundle bundle;
  std::vector<std::string> view_names;
  std::vector<bool> view_dropped, tag_dropped;
  struct Origin {
    int picture, detection, corner;
  };
  std::vector<Origin> origin;        // one per bundle corner
  std::vector<double> raw_sigma_px;  // from the detector, with the floor
  BoardSolution out;

  void finding(FindingCode code, Finding::Severity severity, const std::filesystem::path& file, const std::string& what,
               const std::string& remedy, const std::string& field = {}) {
    out.findings.push_back({code, severity, file, what, remedy, field});
  }
  std::filesystem::path file_of(int view) const {
    for (const ViewTags& p : pictures)
      if (p.view == view_names[view]) return p.file;
    return {};
  }
  int tags_in(int view) const {
    std::set<int> ids;
    for (const BundleCorner& c : bundle.corners)
      if (c.view == view && c.used) ids.insert(c.tag);
    return static_cast<int>(ids.size());
  }
  bool has_own_lens(int view) const {
    const auto v = static_cast<std::size_t>(view);
    return v < bundle.view_lenses.size() && bundle.view_lenses[v].moves();
  }
  LensScatter any_lens() const { return {kAnyShift * std::max(bundle.lens.width, bundle.lens.height), kAnyFocal}; }
  void drop_view(int view, const std::string& what, const std::string& remedy) {
    if (view_dropped[view]) return;
    view_dropped[view] = true;
    if (has_own_lens(view)) bundle.view_lenses[static_cast<std::size_t>(view)] = {};
    for (BundleCorner& c : bundle.corners)
      if (c.view == view) c.used = false;
    if (remedy == kOddPhoto) out.odd_views.push_back(view_names[view]);
    finding(FindingCode::photo_omitted, Finding::Severity::warning, file_of(view),
            "view " + view_names[view] + " is left out: " + what, remedy);
  }
  void drop_tag(int tag, const std::string& what, const std::string& remedy) {
    if (tag_dropped[tag]) return;
    tag_dropped[tag] = true;
    for (BundleCorner& c : bundle.corners)
      if (c.tag == tag) c.used = false;
    finding(FindingCode::tags_omitted, Finding::Severity::warning, board.tags.list.empty() ? "" : "board.json",
            "tag " + std::to_string(board.tags.list[tag].id) + " is left out: " + what, remedy);
  }
  void require_views() {
    int left = 0;
    for (std::size_t v = 0; v < view_names.size(); ++v) left += view_dropped[v] ? 0 : 1;
    const int needed = options.fix_lens ? 1 : 3;
    if (left >= needed) return;
    std::string names;
    std::size_t said = 0;
    for (const Finding& f : out.findings) {
      if (said++ == 2) {
        names += "; and " + std::to_string(out.findings.size() - 2) + " more";
        break;
      }
      names += "; " + sentence(f);
    }
    fail("the session",
         counted(static_cast<std::size_t>(left), "usable view") + " do not determine lens and poses" + names,
         "photograph the board from at least " + std::to_string(needed) +
             " places, better ten, tilted in different directions, with at least " + std::to_string(options.min_tags) +
             " sharp tags each");
  }

  void collect(int width, int height) {
    std::map<int, int> tag_index;
    for (std::size_t i = 0; i < board.tags.list.size(); ++i) {
      tag_index[board.tags.list[i].id] = static_cast<int>(i);
      TagPlacement t;
      t.sigma_mm = std::max(board.tags.sigma_mm, 1e-4);
      // A placement error of sigma at both ends of a tag turns it by about sigma / half its side.
      t.sigma_rad = t.sigma_mm / (board.tags.list[i].size_mm / 2);
      bundle.tags.push_back(t);
    }
    bundle.surface = {board.size_mm, Eigen::Vector3d::Zero(), board.bend};
    bundle.lens.width = width;
    bundle.lens.height = height;
    for (std::size_t p = 0; p < pictures.size(); ++p) {
      auto at = std::find(view_names.begin(), view_names.end(), pictures[p].view);
      const int view = static_cast<int>(at - view_names.begin());
      if (at == view_names.end()) view_names.push_back(pictures[p].view);
      for (std::size_t d = 0; d < pictures[p].tags.size(); ++d) {
        const TagDetection& tag = pictures[p].tags[d];
        const auto index = tag_index.find(tag.id);
        if (index == tag_index.end()) continue;
        const Tag& believed = board.tags.list[index->second];
        const auto corners = tag_corners_mm(believed);
        const auto outward = outward_px(tag.corner_px);
        for (int k = 0; k < 4; ++k) {
          BundleCorner c;
          c.view = view;
          c.tag = index->second;
          c.center_mm = believed.center_mm;
          c.offset_mm = corners[k] - believed.center_mm;
          c.z_mm = board.tags.z_mm;
          c.q_px = tag.corner_px[k];
          c.outward = outward[k];
          c.sigma_px = kSeedSigma_px;
          bundle.corners.push_back(c);
          origin.push_back({static_cast<int>(p), static_cast<int>(d), k});
          raw_sigma_px.push_back(std::hypot(tag.corner_sigma_px[k], kFloor_px));
        }
      }
    }
    bundle.views.assign(view_names.size(), Eigen::Isometry3d::Identity());
    view_dropped.assign(view_names.size(), false);
    tag_dropped.assign(bundle.tags.size(), false);
    for (std::size_t v = 0; v < view_names.size(); ++v) {
      if (std::find(options.leave_out.begin(), options.leave_out.end(), view_names[v]) != options.leave_out.end()) {
        view_dropped[v] = true;
        for (BundleCorner& c : bundle.corners)
          if (c.view == static_cast<int>(v)) c.used = false;
        continue;
      }
      const int n = tags_in(static_cast<int>(v));
      if (n >= options.min_tags) continue;
      std::map<TagFault, std::vector<RejectedTag>> refused;
      for (const ViewTags& p : pictures)
        if (p.view == view_names[v])
          for (const RejectedTag& r : p.rejected) refused[r.fault].push_back(r);
      const auto most = std::max_element(refused.begin(), refused.end(), [](const auto& a, const auto& b) {
        return a.second.size() < b.second.size();
      });
      if (n == 0 && refused.empty())
        drop_view(static_cast<int>(v), "no tag can be read in it",
                  "it is out of focus, was moved or exposed twice, is too dark or too bright, or does not show the "
                  "board: take it again");
      else
        drop_view(static_cast<int>(v),
                  "only " + std::to_string(n) + " of its tags can be used" +
                      (most == refused.end() ? ""
                                             : " (" + std::to_string(most->second.size()) +
                                                   " others: " + in_words(most->second.front()) + ")"),
                  "go closer, light the tags, keep the whole board in the photo");
    }
    require_views();
  }

  void seed() {
    const int width = bundle.lens.width, height = bundle.lens.height;
    double focal = 0;
    if (options.lens) {
      bundle.lens = *options.lens;
      focal = bundle.lens.intrinsics[0];
    } else {
      focal = seed_focal_px(bundle);
      bundle.lens = plain_lens("LENSMODEL_OPENCV4", focal, width, height);
    }
    const PoseSeed poses = seed_poses(bundle, focal);
    for (std::size_t v = 0; v < view_names.size(); ++v) {
      if (view_dropped[v]) continue;
      if (!poses.found[v])
        drop_view(static_cast<int>(v), "its tags differ from their places in board.json",
                  "check the tags' ids and places in board.json");
      else
        bundle.views[v] = poses.T_camera_board[v];
    }
    require_views();
    // An initial guess with a corner behind the camera cannot start the solve.
    const auto residuals = bundle_residuals_px(bundle);
    for (std::size_t i = 0; i < residuals.size(); ++i)
      if (!residuals[i].allFinite()) bundle.corners[i].used = false;
  }

  std::vector<double> view_rms(const std::vector<Eigen::Vector2d>& residuals) const {
    std::vector<std::vector<double>> sizes(view_names.size());
    for (std::size_t i = 0; i < residuals.size(); ++i)
      if (bundle.corners[i].used) sizes[bundle.corners[i].view].push_back(residuals[i].norm());
    std::vector<double> rms;
    rms.reserve(sizes.size());
    for (auto& s : sizes) rms.push_back(median_of(s) / 1.177);  // median of a Rayleigh distribution, per axis
    return rms;
  }

  // Finds a photo that this lens does not fit: it gets its own lens, since it may be enlarged, or is excluded.
  bool drop_far_views(double far_px, double far_factor) {
    const auto rms = view_rms(bundle_residuals_px(bundle));
    std::vector<double> present;
    for (std::size_t v = 0; v < rms.size(); ++v)
      if (!view_dropped[v] && rms[v] > 0) present.push_back(rms[v]);
    const double usual = median_of(present);
    int worst = -1;
    for (std::size_t v = 0; v < rms.size(); ++v)
      if (!view_dropped[v] && rms[v] > far_px && rms[v] > far_factor * usual && (worst < 0 || rms[v] > rms[worst]))
        worst = static_cast<int>(v);
    if (worst < 0) return false;
    if (options.own_lenses && !has_own_lens(worst)) {
      const std::optional<OwnLensFit> fit = own_lens_fits(bundle)[static_cast<std::size_t>(worst)];
      bundle.view_lenses.resize(view_names.size());
      ViewLens& lens = bundle.view_lenses[static_cast<std::size_t>(worst)];
      lens.prior = any_lens();
      if (fit) lens.own = {fit->difference.head<2>(), std::exp(fit->difference[2])};
      return true;
    }
    drop_view(
        worst,
        "its tags miss their places by " + fixed(rms[worst], 2) + " px, the others' by " + fixed(usual, 2) + " px",
        kOddPhoto);
    require_views();
    return true;
  }

  // Noise of each photo: the detector's sigma times a factor from the photo's residuals (median, so outliers do not
  // count).
  void reweigh() {
    const auto residuals = bundle_residuals_px(bundle);
    std::vector<std::vector<double>> relative(view_names.size());
    std::vector<double> all;
    for (std::size_t i = 0; i < residuals.size(); ++i)
      if (bundle.corners[i].used) {
        relative[bundle.corners[i].view].push_back(residuals[i].norm() / raw_sigma_px[i]);
        all.push_back(relative[bundle.corners[i].view].back());
      }
    const double overall = std::max(median_of(all) / 1.177, 0.05);
    for (std::size_t i = 0; i < residuals.size(); ++i) {
      const auto& own = relative[bundle.corners[i].view];
      // A photo with few corners follows the others.
      const double n = static_cast<double>(own.size()), share = n / (n + 24);
      const double factor =
          own.empty()
              ? overall
              : std::exp(share * std::log(std::max(median_of(own) / 1.177, 0.05)) + (1 - share) * std::log(overall));
      bundle.corners[i].sigma_px = factor * raw_sigma_px[i];
    }
  }

  // Intersection of rays through a tag's corners with the board, mm: the photos' median, and the median distance from
  // it.
  std::pair<Eigen::Vector2d, double> place_of(int tag) const {
    std::vector<Eigen::Vector2d> places;
    for (std::size_t i = 0; i + 3 < bundle.corners.size(); i += 4) {
      const BundleCorner& c = bundle.corners[i];
      if (c.tag != tag || view_dropped[c.view]) continue;
      Eigen::Vector2d sum(0, 0);
      const Eigen::Isometry3d T_board_camera = bundle.views[c.view].inverse();
      for (int k = 0; k < 4; ++k) {
        Eigen::Vector3d v;
        unproject(lens_of(bundle, static_cast<std::size_t>(c.view)), {&bundle.corners[i + k].q_px, 1}, {&v, 1});
        const Eigen::Vector3d d = T_board_camera.linear() * v, from = T_board_camera.translation();
        if (bundle.surface.bend) {
          constexpr double kNowhere = std::numeric_limits<double>::quiet_NaN();
          sum += flat_place(cylinder_of(bundle.surface), from, d).value_or(Eigen::Vector2d(kNowhere, kNowhere)) / 4;
          continue;
        }
        sum += (from + (board.tags.z_mm - from.z()) / d.z() * d).head<2>() / 4;
      }
      if (sum.allFinite()) places.push_back(sum);
    }
    std::vector<double> x, y, off;
    for (const Eigen::Vector2d& p : places) {
      x.push_back(p.x());
      y.push_back(p.y());
    }
    const Eigen::Vector2d middle(median_of(x), median_of(y));
    for (const Eigen::Vector2d& p : places) off.push_back((p - middle).norm());
    return {middle, median_of(off)};
  }

  // Outlier statistics of tags from their corners. By tag: number of photos in which it is bad, and in which it is
  // seen. By view: its tags, and whether they are bad there.
  struct Contradictions {
    std::map<int, std::pair<int, int>> bad_and_seen;
    std::map<int, std::vector<std::pair<int, bool>>> by_view;
  };

  // Excludes outlier corners, tags in single photos, and tags in all photos. Returns whether anything changed.
  bool leave_out(const BundleOptions& o) {
    bool changed = false;
    const Contradictions found = leave_out_corners(changed);
    if (leave_out_torn_view(found)) return true;
    changed = leave_out_moved_tags(found) || changed;
    changed = leave_out_misplaced_tag(o) || changed;
    for (std::size_t v = 0; v < view_names.size(); ++v)
      if (!view_dropped[v] && tags_in(static_cast<int>(v)) < options.min_tags) {
        drop_view(static_cast<int>(v),
                  "only " + std::to_string(tags_in(static_cast<int>(v))) + " of its tags agree with the other photos",
                  "take it again, sharp and with the whole board in it");
        changed = true;
      }
    require_views();
    return changed;
  }

  // Excludes single corners, and tags in single photos: two bad corners make a bad tag.
  Contradictions leave_out_corners(bool& changed) {
    const auto residuals = bundle_residuals_px(bundle);
    std::map<std::pair<int, int>, std::vector<std::size_t>> by_detection;
    for (std::size_t i = 0; i < residuals.size(); ++i)
      if (!view_dropped[bundle.corners[i].view] && !tag_dropped[bundle.corners[i].tag])
        by_detection[{origin[i].picture, origin[i].detection}].push_back(i);
    const auto good = [&](std::size_t i) {
      return residuals[i].allFinite() &&
             residuals[i].norm() < options.outlier_sigma * std::sqrt(2.0) * bundle.corners[i].sigma_px;
    };
    Contradictions out;
    for (const auto& [key, corners] : by_detection) {
      const auto bad = std::count_if(corners.begin(), corners.end(), [&](std::size_t i) { return !good(i); });
      const int tag = bundle.corners[corners[0]].tag;
      out.bad_and_seen[tag].first += bad >= 2 ? 1 : 0;
      ++out.bad_and_seen[tag].second;
      out.by_view[bundle.corners[corners[0]].view].emplace_back(tag, bad >= 2);
      for (const std::size_t i : corners) {
        const bool use = good(i) && bad < 2;
        changed = changed || use != bundle.corners[i].used;
        bundle.corners[i].used = use;
      }
    }
    return out;
  }

  // Excludes a photo of another focal length. It keeps the few tags that suit its wrong pose, which is far off. One at
  // a time, because it biases the others.
  bool leave_out_torn_view(const Contradictions& found) {
    int torn = -1;
    std::pair<int, int> torn_counts;
    for (const auto& [view, tags] : found.by_view) {
      int bad = 0, seen = 0;
      for (const auto& [tag, is_bad] : tags) {
        const auto& [bad_views, seen_views] = found.bad_and_seen.at(tag);
        if (2 * (bad_views - (is_bad ? 1 : 0)) > seen_views - 1) continue;  // the tag's fault
        bad += is_bad ? 1 : 0;
        ++seen;
      }
      if (bad >= 3 && bad > kTornView * seen && (torn < 0 || bad * torn_counts.second > torn_counts.first * seen)) {
        torn = view;
        torn_counts = {bad, seen};
      }
    }
    if (torn < 0) return false;
    drop_view(torn,
              std::to_string(torn_counts.first) + " of its " + std::to_string(torn_counts.second) +
                  " tags contradict the other photos",
              kOddPhoto);
    require_views();
    return true;
  }

  // Excludes tags that are outliers in most photos: misplaced, or not flat.
  bool leave_out_moved_tags(const Contradictions& found) {
    bool changed = false;
    for (const auto& [tag, counts] : found.bad_and_seen) {
      if (counts.second < 3 || 2 * counts.first <= counts.second) continue;
      const auto [at, spread] = place_of(tag);
      const Tag& believed = board.tags.list[tag];
      if (spread < 0.03 * believed.size_mm) {
        seen_at_[tag] = at;
        const Eigen::Vector2d shift = at - believed.center_mm;
        drop_tag(tag,
                 "the photos show it at " + fixed(at.x(), 1) + ", " + fixed(at.y(), 1) + " mm, " +
                     fixed(shift.norm(), 1) + " mm from where board.json has it",
                 "correct its center_mm, rotation_deg or id");
      } else {
        drop_tag(tag,
                 "its corners contradict each other in " + std::to_string(counts.first) + " of " +
                     std::to_string(counts.second) + " photos",
                 "it is peeling, bent or was moved between photos; stick it flat");
      }
      changed = true;
    }
    return changed;
  }

  // Excludes the tag with the largest shift, compared with the usual shifts on this board. One at a time, because a
  // misplaced tag biases its neighbors.
  bool leave_out_misplaced_tag(const BundleOptions& o) {
    const BundleUncertainty u = bundle_uncertainty(bundle, o);
    std::vector<double> size;
    for (std::size_t t = 0; t < bundle.tags.size(); ++t)
      if (!tag_dropped[t] && u.tag_sigma[t].x() > 0)
        size.push_back(bundle.tags[t].shift_mm.norm() / bundle.tags[t].sigma_mm);
    const double spread = std::max(1.0, median_of(size) / 1.177);
    int worst = -1;
    double worst_size = kTagOutlier_sigma * spread;
    for (std::size_t t = 0; t < bundle.tags.size(); ++t) {
      if (tag_dropped[t] || !(u.tag_sigma[t].x() > 0)) continue;
      const double s = bundle.tags[t].shift_mm.norm() / std::sqrt(2.0) / bundle.tags[t].sigma_mm;
      const double turn = std::abs(bundle.tags[t].turn_rad) / bundle.tags[t].sigma_rad;
      if (std::max(s, turn) > worst_size) {
        worst_size = std::max(s, turn);
        worst = static_cast<int>(t);
      }
    }
    if (worst >= 0) {
      const TagPlacement& t = bundle.tags[worst];
      seen_at_[worst] = board.tags.list[worst].center_mm + t.shift_mm;
      drop_tag(worst,
               "the photos show it " + fixed(t.shift_mm.norm(), 2) +
                   " mm from where board.json has it, and turned by " + fixed(t.turn_rad * 180 / std::numbers::pi, 1) +
                   " degrees; tags.sigma_mm is " + fixed(board.tags.sigma_mm, 2),
               "correct its center_mm by " + fixed(t.shift_mm.x(), 2) + ", " + fixed(t.shift_mm.y(), 2) +
                   " mm, or raise sigma_mm");
      return true;
    }
    if (spread > 2 && !said_spread_) {
      said_spread_ = true;
      finding(FindingCode::tags_misplaced, Finding::Severity::warning, "board.json",
              "the tags lie " + fixed(spread, 1) + " times further from their places than tags.sigma_mm (" +
                  fixed(board.tags.sigma_mm, 2) + " mm) says",
              "raise sigma_mm, or measure center_mm again", "tags.sigma_mm");
    }
    return false;
  }

  // Reports tags that were excluded in single photos, and tags that occupy each other's positions.
  void name_contradictions(const std::vector<Eigen::Vector2d>& residuals) {
    std::map<std::pair<int, bool>, std::vector<std::string>> views;  // by tag, and whether it is far from its position
    for (std::size_t i = 0; i + 3 < bundle.corners.size(); i += 4) {
      const BundleCorner& c = bundle.corners[i];
      if (view_dropped[c.view] || tag_dropped[c.tag]) continue;
      int used = 0;
      double nearest = 1e300;
      for (int k = 0; k < 4; ++k) {
        used += bundle.corners[i + k].used ? 1 : 0;
        if (residuals[i + k].allFinite()) nearest = std::min(nearest, residuals[i + k].norm());
      }
      if (used > 1) continue;
      const double side = (bundle.corners[i + 1].q_px - c.q_px).norm();
      views[{c.tag, nearest > 0.3 * side}].push_back(view_names[c.view]);
    }
    for (const auto& [key, in] : views) {
      std::string list;
      for (std::size_t k = 0; k < in.size() && k < 5; ++k) list += (k ? ", " : "") + in[k];
      if (in.size() > 5) list += " and " + std::to_string(in.size() - 5) + " more";
      finding(FindingCode::tags_omitted, Finding::Severity::warning, {},
              "tag " + std::to_string(board.tags.list[key.first].id) + " is left out in view" +
                  (in.size() > 1 ? "s " : " ") + list + ": its corners " +
                  (key.second ? "are far from where the others have them" : "contradict the others"),
              key.second ? "something else was read as this tag, or it was moved: cover or restick it"
                         : "it was partly covered, bent or glaring");
    }
    for (const auto& [a, at_a] : seen_at_)
      for (const auto& [b, at_b] : seen_at_) {
        const double near = 0.25 * board.tags.list[a].size_mm;
        if (a < b && (at_a - board.tags.list[b].center_mm).norm() < near &&
            (at_b - board.tags.list[a].center_mm).norm() < near)
          finding(FindingCode::tags_misplaced, Finding::Severity::warning, "board.json",
                  "tags " + std::to_string(board.tags.list[a].id) + " and " + std::to_string(board.tags.list[b].id) +
                      " lie in each other's places",
                  "exchange their ids in tags.list", "tags.list");
      }
  }

  // Corrects for the lens, which bends a tag's sides, while the detector fits straight lines
  // (burin/capture/tags/tag_detector.h).
  void straighten() {
    const double skip = side_skip_fraction(board.tags.family);
    for (std::size_t i = 0; i + 3 < bundle.corners.size(); i += 4) {
      const BundleCorner& c = bundle.corners[i];
      if (view_dropped[c.view]) continue;
      std::array<Eigen::Vector3d, 4> p;
      std::array<Eigen::Vector2d, 4> flat;
      for (int k = 0; k < 4; ++k) {
        p[k] = bundle.views[c.view] * bundle_point_mm(bundle, bundle.corners[i + k]);
        flat[k] = bundle_flat_mm(bundle, bundle.corners[i + k]);
      }
      const Lens lens = lens_of(bundle, static_cast<std::size_t>(c.view));
      auto side = [&](int k, double t) {
        Eigen::Vector3d v = p[k] + t * (p[(k + 1) % 4] - p[k]);
        if (bundle.surface.bend) {  // the paper bends along
          const Eigen::Vector2d at = flat[k] + t * (flat[(k + 1) % 4] - flat[k]);
          v = bundle.views[c.view] * above_face(bundle.surface, at.x(), at.y(), c.z_mm);
        }
        Eigen::Vector2d q;
        project(lens, {&v, 1}, {&q, 1});
        return q;
      };
      const auto bias = curved_side_bias_px(side, skip);
      const TagDetection& tag = pictures[origin[i].picture].tags[origin[i].detection];
      const double most_px = bundle.surface.bend ? 0.2 * (tag.corner_px[1] - tag.corner_px[0]).norm() : 1;
      for (int k = 0; k < 4; ++k)
        if (bias[k].allFinite() && bias[k].norm() < most_px) bundle.corners[i + k].q_px = tag.corner_px[k] - bias[k];
    }
  }

 private:
  bool said_spread_ = false;
  std::map<int, Eigen::Vector2d> seen_at_;  // excluded tags with a wrong position: their estimated positions, mm
};

}  // namespace

namespace {

// Sets the priors of the views' lenses: the scatter of the estimates, with their uncertainty. A view that differs by
// far more than the others is a zoom, and gets the wide prior of any_lens().
LensScatter set_lens_priors(Solver& s, const BundleOptions& o, Bundle& bundle) {
  const BundleUncertainty u = bundle_uncertainty(bundle, o);
  std::vector<double> shift2, focal2;
  for (std::size_t v = 0; v < bundle.view_lenses.size(); ++v) {
    if (s.view_dropped[v]) continue;
    const OwnLens& own = bundle.view_lenses[v].own;
    shift2.push_back(0.5 * (own.shift_px.squaredNorm() + u.own_lens[v].topLeftCorner<2, 2>().trace()));
    focal2.push_back(std::pow(std::log(own.focal_ratio), 2) + u.own_lens[v](2, 2));
  }
  const auto usual = [](const std::vector<double>& squares) {
    const double middle = median_of(squares);
    double sum = 0, n = 0;
    for (const double square : squares)
      if (square <= kZoomed * kZoomed * middle) sum += square, ++n;
    return std::sqrt(sum / std::max(1.0, n));
  };
  const LensScatter scatter{usual(shift2), usual(focal2)};
  for (ViewLens& lens : bundle.view_lenses) {
    const bool zoomed = lens.own.shift_px.norm() > kZoomed * std::numbers::sqrt2 * scatter.shift_px ||
                        std::abs(std::log(lens.own.focal_ratio)) > kZoomed * scatter.focal;
    lens.prior = zoomed ? s.any_lens() : scatter;
  }
  return scatter;
}

// Gives each view its own lens on two conditions. Separately fitted views must differ significantly. The own lenses
// must explain the corners better by more than the penalty of three parameters per view.
void ask_for_own_lenses(Solver& s, const BundleOptions& o, const std::string& model) {
  std::vector<bool> counts;
  for (std::size_t v = 0; v < s.view_names.size(); ++v)
    counts.push_back(!s.view_dropped[v] && !s.has_own_lens(static_cast<int>(v)));
  LensScatter scatter = lens_scatter(own_lens_fits(s.bundle), counts);
  s.out.lenses_differ = scatter.shift_px > 0 || scatter.focal > 0;
  if (!s.out.lenses_differ || !s.options.own_lenses) return;
  // Starts from a wide prior. A common lens hides most of the differences at first, and a narrow prior would never
  // widen.
  constexpr double kMuchShift = 0.01, kMuchFocal = 0.02;  // of the picture's longer side; of a logarithm
  scatter = {std::max(2 * scatter.shift_px, kMuchShift * std::max(s.bundle.lens.width, s.bundle.lens.height)),
             std::max(2 * scatter.focal, kMuchFocal)};
  Bundle with = s.bundle;
  with.view_lenses.resize(with.views.size());
  for (ViewLens& lens : with.view_lenses)
    if (!lens.moves()) lens.prior = scatter;
  if (!s.options.fix_lens && !s.options.lens)
    with.lens = plain_lens("LENSMODEL_OPENCV4", with.lens.intrinsics[0], with.lens.width, with.lens.height);
  Bundle without = s.bundle;
  const BundleSummary before = solve_with_lens_model(without, o, without.lens.model);
  BundleSummary after = solve_with_lens_model(with, o, model);
  constexpr int kRounds = 5;
  for (int round = 0; round < kRounds; ++round) {
    scatter = set_lens_priors(s, o, with);
    after = solve_with_lens_model(with, o, with.lens.model);
  }
  if (!(information_criterion(after, with) < information_criterion(before, without))) return;
  s.bundle = std::move(with);
  s.out.lens_scatter = scatter;
}

// Robust solve that finds outliers. Ends with the bundle's lens of the chosen model, and returns its name.
std::string solve_robustly(Solver& s, const std::function<void(double)>& report) {
  const BoardSolverOptions& options = s.options;
  const int width = s.bundle.lens.width, height = s.bundle.lens.height;
  // Initial guess: the plainest lens, a flat board, tags at their prior positions.
  BundleOptions o;
  o.fix_lens = options.fix_lens;
  o.cauchy_sigma = 2;
  o.robust_priors = true;
  o.hold_tag_set = false;
  o.fix_bow = true;
  o.fix_tags = true;
  const std::string first = options.lens ? options.lens->model : "LENSMODEL_OPENCV4";
  const auto solve = [&](const std::string& model) { solve_with_lens_model(s.bundle, o, model); };
  do solve(first);
  while (s.drop_far_views(kFarView_px, kFarFactor));
  report(0.2);

  o.fix_bow = false;
  o.fix_tags = false;
  solve(first);
  s.reweigh();
  // Residuals of the plainest lens may contain distortion, so choose the model before judging corners.
  std::string model = options.lens ? options.lens->model : options.lens_model;
  if (!options.fix_lens && !options.lens)
    s.bundle.lens = plain_lens("LENSMODEL_OPENCV4", s.bundle.lens.intrinsics[0], width, height);
  solve(model);
  s.straighten();
  s.reweigh();
  solve(s.bundle.lens.model);
  ask_for_own_lenses(s, o, model);
  s.reweigh();
  report(0.5);
  for (int round = 0; round < 30; ++round) {
    const bool changed = s.drop_far_views(kOddView_px, kOddFactor) || s.leave_out(o);
    s.reweigh();
    solve(s.bundle.lens.model);
    if (!changed && round > 0) break;
  }
  report(0.7);
  return model;
}

// Least squares without the outliers, in the frame of the set of tags.
BundleOptions solve_finally(Solver& s, const std::string& model) {
  BundleOptions o;
  o.fix_lens = s.options.fix_lens;
  o.cauchy_sigma = 0;
  o.robust_priors = false;
  o.hold_tag_set = true;
  if (!s.options.fix_lens && !s.options.lens)
    s.bundle.lens =
        plain_lens("LENSMODEL_OPENCV4", s.bundle.lens.intrinsics[0], s.bundle.lens.width, s.bundle.lens.height);
  const auto solve = [&](const std::string& lens) { solve_with_lens_model(s.bundle, o, lens); };
  for (int round = 0; round < 3; ++round) {
    solve(round == 0 ? model : s.bundle.lens.model);
    if (s.out.lens_scatter) s.out.lens_scatter = set_lens_priors(s, o, s.bundle);
    const bool changed = s.leave_out(o);
    s.straighten();
    s.reweigh();
    if (!changed && round > 0) break;
  }
  solve(s.bundle.lens.model);
  return o;
}

// Scales all weights by the residuals, with the degrees of freedom of the parameters, and reports their size.
void scale_weights(Solver& s, const std::vector<Eigen::Vector2d>& residuals) {
  double chi2 = 0, sum2 = 0, n = 0, scale_sum = 0;
  for (std::size_t i = 0; i < residuals.size(); ++i) {
    const BundleCorner& c = s.bundle.corners[i];
    if (!c.used) continue;
    chi2 += residuals[i].squaredNorm() / (c.sigma_px * c.sigma_px);
    sum2 += residuals[i].squaredNorm();
    const double z = (s.bundle.views[c.view] * bundle_point_mm(s.bundle, c)).z();
    scale_sum += s.bundle.lens.intrinsics[0] / z;
    n += 2;
  }
  double parameters = 4 + (s.options.fix_lens ? 0 : static_cast<double>(s.bundle.lens.intrinsics.size()));
  for (std::size_t v = 0; v < s.view_dropped.size(); ++v) parameters += s.view_dropped[v] ? 0 : own_count(s.bundle, v);
  for (const bool dropped : s.tag_dropped) parameters += dropped ? 0 : 3;
  const double factor = std::sqrt(chi2 / std::max(1.0, n - parameters));
  for (BundleCorner& c : s.bundle.corners) c.sigma_px *= factor;
  s.out.rms_px = std::sqrt(sum2 / std::max(1.0, n));
  s.out.rms_board_mm = s.out.rms_px / (2 * scale_sum / std::max(1.0, n));
}

// Reports every corner with its residual, and counts those excluded one by one.
void tell_corners(Solver& s, const std::vector<Eigen::Vector2d>& residuals) {
  int single = 0;
  for (std::size_t i = 0; i < residuals.size(); ++i) {
    const BundleCorner& c = s.bundle.corners[i];
    single += !c.used && !s.view_dropped[c.view] && !s.tag_dropped[c.tag] ? 1 : 0;
    s.out.corners.push_back({s.view_names[c.view], s.origin[i].picture, s.board.tags.list[c.tag].id, s.origin[i].corner,
                             c.q_px, -residuals[i], c.sigma_px, c.used});
  }
  if (single > 0)
    s.finding(FindingCode::outliers_omitted, Finding::Severity::note, {},
              std::to_string(single) + " of " + std::to_string(s.bundle.corners.size()) +
                  " corners contradict the others and are left out",
              "residuals.vnl names them");
}

void tell_views(Solver& s, const BundleUncertainty& u, const std::vector<Eigen::Vector2d>& residuals) {
  std::vector<double> view2(s.view_names.size(), 0), view_n(s.view_names.size(), 0);
  for (std::size_t i = 0; i < residuals.size(); ++i) {
    const BundleCorner& c = s.bundle.corners[i];
    if (!c.used) continue;
    view2[c.view] += residuals[i].squaredNorm();
    view_n[c.view] += 2;
  }
  for (std::size_t v = 0; v < s.view_names.size(); ++v) {
    if (s.view_dropped[v]) continue;
    View view;
    view.name = s.view_names[v];
    view.T_camera_board = s.bundle.views[v];
    view.center_sigma_mm = u.center_mm2[v].diagonal().cwiseMax(0).cwiseSqrt();
    view.reprojection_rms_px = std::sqrt(view2[v] / std::max(1.0, view_n[v]));
    view.tags = s.tags_in(static_cast<int>(v));
    if (s.has_own_lens(static_cast<int>(v))) {
      const Eigen::Vector3d sigma = u.own_lens[v].diagonal().cwiseMax(0).cwiseSqrt();
      view.own_lens = s.bundle.view_lenses[v].own;
      view.own_lens_sigma = {sigma.head<2>(), sigma[2] * view.own_lens->focal_ratio};
    }
    s.out.views.push_back(view);
    s.out.center_covariance_mm2.push_back(u.center_mm2[v]);
    s.out.pose_covariance.push_back(u.pose[v]);
  }
}

void tell_tags(Solver& s, const BundleUncertainty& u) {
  for (std::size_t t = 0; t < s.bundle.tags.size(); ++t) {
    if (s.tag_dropped[t] || !(u.tag_sigma[t].x() > 0)) continue;
    Tag tag = s.board.tags.list[t];
    tag.center_mm += s.bundle.tags[t].shift_mm;
    tag.rotation_deg += s.bundle.tags[t].turn_rad * 180 / std::numbers::pi;
    tag.center_sigma_mm = u.tag_sigma[t].head<2>();
    tag.rotation_sigma_deg = u.tag_sigma[t].z() * 180 / std::numbers::pi;
    s.out.tags.push_back(tag);
    s.out.tag_sigma.push_back(u.tag_sigma[t]);
  }
}

// Reports the views' own lenses by their scatter, and enlarged photos.
void tell_own_lenses(Solver& s) {
  for (std::size_t v = 0; v < s.bundle.view_lenses.size(); ++v) {
    const ViewLens& lens = s.bundle.view_lenses[v];
    if (s.view_dropped[v] || !(lens.prior.focal >= kAnyFocal)) continue;
    s.finding(FindingCode::camera_changed, Finding::Severity::warning, s.file_of(static_cast<int>(v)),
              "view " + s.view_names[v] + " has a focal length " + fixed(lens.own.focal_ratio, 4) +
                  " times the others', its middle moved by " + fixed(lens.own.shift_px.norm(), 0) +
                  " px: a digital zoom, or a crop that was enlarged; it is measured and used so",
              "do not zoom, crop or enlarge: an enlarged picture shows no more");
  }
  if (!s.out.lens_scatter) {
    // Only zooms move; all others share one lens.
    const auto moves = [](const ViewLens& lens) { return lens.moves(); };
    if (std::any_of(s.bundle.view_lenses.begin(), s.bundle.view_lenses.end(), moves))
      s.out.lens_scatter = LensScatter{kLittle_px, kLittle};
    return;
  }
  const LensScatter& scatter = *s.out.lens_scatter;
  s.out.focal_scatter = scatter.focal;
  s.finding(
      FindingCode::camera_changed, Finding::Severity::warning, {},
      "focal lengths differ from photo to photo by " + general(100 * scatter.focal, 2) + " % and principal points by " +
          general(scatter.shift_px, 2) +
          " px, as autofocus and a stabilizer make them: each photo's are measured, at the price of larger sigmas",
      "focus once by hand, switch autofocus and stabilizer off, and leave the zoom alone");
}

// Refocusing between photos moves each camera along its axis without any effect on corners. This raises all sigmas
// until the cameras' sigmas include it.
void count_focal_scatter(Solver& s, const BundleOptions& o, BundleUncertainty& u) {
  if (s.out.lens_scatter) return;  // own lenses include it
  std::vector<bool> counts;
  for (const bool dropped : s.view_dropped) counts.push_back(!dropped);
  const double scatter = focal_scatter(own_focals(s.bundle), counts);
  constexpr double kLeast = 1e-4;  // a tenth of a millimeter at a meter
  if (scatter < kLeast || s.options.fix_lens) return;
  double times = 1;
  for (std::size_t v = 0; v < s.view_names.size(); ++v) {
    if (s.view_dropped[v]) continue;
    const Eigen::Vector3d center = s.bundle.views[v].inverse().translation();
    const Eigen::Vector3d axis = center.normalized();
    const double along_mm = std::sqrt(std::max(1e-12, axis.dot(u.center_mm2[v] * axis)));
    times = std::max(times, std::hypot(1.0, center.norm() * scatter / along_mm));
  }
  s.out.focal_scatter = scatter;
  for (BundleCorner& c : s.bundle.corners) c.sigma_px *= times;
  u = bundle_uncertainty(s.bundle, o);
  s.finding(FindingCode::camera_changed, Finding::Severity::warning, {},
            "focal lengths differ from photo to photo by " + general(100 * scatter, 2) +
                " %: the camera refocused for some, or its zoom moved; cameras may be off by as much of their "
                "distance, which their sigmas count",
            "focus once by hand, switch autofocus off, tape the zoom ring, and take the photos again");
}

}  // namespace

BoardSolution solve_board(const Board& board, const std::vector<ViewTags>& pictures, int width, int height,
                          const BoardSolverOptions& options, const Progress& progress) {
  const auto report = [&progress](double fraction) {
    if (progress) progress("solving for lens and poses", fraction);
  };
  Solver s(board, pictures, options);
  s.collect(width, height);
  s.seed();
  report(0.1);
  const std::string model = solve_robustly(s, report);
  const BundleOptions o = solve_finally(s, model);
  report(0.9);

  const auto residuals = bundle_residuals_px(s.bundle);
  scale_weights(s, residuals);
  BundleUncertainty u = bundle_uncertainty(s.bundle, o);
  tell_own_lenses(s);
  count_focal_scatter(s, o, u);
  s.name_contradictions(residuals);
  s.out.lens = s.bundle.lens;
  s.out.lens_covariance = u.lens;
  s.out.bow_mm = s.bundle.surface.bow_mm;
  s.out.bow_sigma_mm = u.bow_mm2.diagonal().cwiseMax(0).cwiseSqrt();
  s.out.edge_mm = s.bundle.edge_mm;
  s.out.edge_sigma_mm = u.edge_sigma_mm;
  s.out.not_determined = u.not_determined;
  tell_corners(s, residuals);
  tell_views(s, u, residuals);
  tell_tags(s, u);
  if (options.check_with_mrcal && !options.fix_lens) {
    s.out.check = check_with_mrcal(s.bundle);
    if (s.out.check->max_shift_px > 0.05)
      s.finding(FindingCode::lens_weak, Finding::Severity::warning, {},
                "mrcal's own solver, started at this solution, moves corners by " +
                    fixed(s.out.check->max_shift_px, 2) + " px",
                "the lens is poorly determined: add photos with the board tilted and near the corners of the frame");
  }
  s.out.bundle = std::move(s.bundle);
  s.out.options = o;
  report(1);
  return std::move(s.out);
}

}  // namespace burin

#include "burin/calib/light/photo_faults.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <set>

#include "burin/render/files/decimals.h"
#include "burin/render/median.h"

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

// The lens' vignetting from paper alone: log white = light on the tag + the photo's exposure + v1 r^2 + v2 r^4,
// robustly.
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
    // Weak priors: exposures and light trade against each other, and v1 against v2 where all tags lie on a ring.
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
  std::vector<double> blur, known;  // one a picture: 0 where too few tags tell
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
        findings.push_back({Finding::Severity::warning, file[view],
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
          {known ? Finding::Severity::warning : Finding::Severity::note,
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
        // What was seen and refused has been told already.
        seen = seen || std::any_of(picture.rejected.begin(), picture.rejected.end(),
                                   [&](const RejectedTag& t) { return t.id == tag.id; });
      }
      std::array<Eigen::Vector2d, 4> q;
      for (int k = 0; k < 4; ++k) {
        const Eigen::Vector3d p = above_face(surface, corners[k].x(), corners[k].y(), board.tags.z_mm);
        const Eigen::Vector3d v = view.T_camera_board * p;
        project(solved.lens, {&v, 1}, {&q[k], 1});
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
    findings.push_back({always || often ? Finding::Severity::warning : Finding::Severity::note,
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
  constexpr double kDifferentFactor = 4;  // times what the agreeing photos differ by
  constexpr std::size_t kFewestTags = 5;
  std::vector<LampGroup> groups;
  for (const auto& white_of_lamp : white) {
    const auto& photos = white_of_lamp.second;
    std::vector<std::size_t> index;
    for (const auto& [light_view, tags] : photos)
      if (tags.size() >= kFewestTags) index.push_back(light_view);
    const std::size_t n = index.size();
    if (n < 3) continue;
    // How differently two photos are shaded: what is left of the log ratios beside their median, robustly.
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
    std::vector<double> nearest;  // each photo to the one most like it: what is normal here
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
    // Photos linked by likeness form sets; the largest set is the lamp's.
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
      if (between.empty()) continue;  // no tag in common: nothing is known
      group.spread = median_of(between);
      groups.push_back(group);
    }
  }
  return groups;
}

}  // namespace burin

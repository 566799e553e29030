#include "burin/calib/photo/normal_system.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <utility>

#include "burin/calib/geometry/information.h"
#include "burin/calib/photo/board_tiles.h"
#include "burin/calib/photo/carved_states.h"
#include "burin/calib/photo/geometry_agreement.h"
#include "burin/calib/photo/paper_equation.h"

namespace burin {
namespace {

// Number of required derivatives of a photo by its lens: a view's own lens moves focal lengths and center.
Eigen::Index lens_columns(const GeometryPrior& geometry) {
  constexpr Eigen::Index kCore = 4;
  return std::max(geometry.lens_parameters, geometry.of_view > 6 ? kCore : 0);
}

// Unknowns of normal_system(): the stage's free ones, and poses, bow and lens if they can move.
FreeUnknowns wanted_of(const Problem& data, const Stage& stage) {
  FreeUnknowns wanted{};
  if (data.geometry)
    for (Eigen::Index i = 0; i < lens_columns(*data.geometry); ++i) wanted[unknown::lens + i] = true;
  for_each_unknown([&](const UnknownRow& row, int first) {
    if (row.scope == Scope::paper || first == unknown::lens) return;
    const bool free = row.scope == Scope::geometry
                          ? data.geometry.has_value()
                          : stage.frees(row.group) && (row.scope != Scope::shared || has_unknown(data, row, 0));
    std::fill_n(wanted.begin() + first, row.size, free);
  });
  return wanted;
}

}  // namespace

std::vector<std::vector<PhotoEquations>> equations_of_photos(
    const Problem& data, const Stage& stage, const State& state, const std::vector<ModelData>& models,
    const std::function<void(std::size_t, const PhotoSlopes&)>& look) {
  const FreeUnknowns wanted = wanted_of(data, stage);
  const CarvedStates grooves(data.model);
  const CellGrid tiles = board_tiles(*data.model.board);
  std::vector<std::vector<PhotoEquations>> out(models.size(), std::vector<PhotoEquations>(data.photos.size()));
  each_photo(data, [&](std::size_t k) {
    const PhotoData& photo = data.photos[k];
    const Unknowns x = state.of(photo.photo.light);
    const std::shared_ptr<const Carved> carved = grooves.at(x);
    const PhotoSlopes slopes = photo_slopes(data.model, photo, x, *carved, grooves, wanted);
    if (look) look(k, slopes);
    for (std::size_t m = 0; m < models.size(); ++m) {
      const ModelData& model = models[m];
      if (model.alpha_jitter == data.model.alpha_jitter && model.depth_jitter == data.model.depth_jitter) {
        out[m][k] = photo_equations(model, photo, x, slopes.light, slopes, &tiles);
      } else {
        PhotoData shifted = photo;
        shift_by_grooves(model, x, *carved, shifted);
        out[m][k] = photo_equations(model, shifted, x, slopes.light, slopes, &tiles);
      }
    }
  });
  return out;
}

namespace {

// Indices of the geometry's numbers behind the n unknowns.
struct Layout {
  Eigen::Index n = 0, m = 0, lens = 0, of_view = 6;  // unknowns; the geometry's numbers; the lens'; per view
  Eigen::Index lens_seen = 0;                        // lens_columns()

  Layout(const Problem& data, const State& state) : n(global_count(state.lamps.size())) {
    if (!data.geometry) return;
    m = data.geometry->information.rows();
    lens = data.geometry->lens_parameters;
    of_view = data.geometry->of_view;
    lens_seen = lens_columns(*data.geometry);
  }
  // Number of a photo's unknowns with a place.
  int placed() const { return m > 0 ? unknown::lens + static_cast<int>(lens_seen) : unknown::pose; }
  // Place of one of a photo's unknowns in the whole, with its unit. The lens has two places: the lens of all views, and
  // the photo's own.
  struct Place {
    Eigen::Index at;
    double unit;
  };
  struct Places {
    std::array<Place, 2> all;
    int count;
    const Place* begin() const { return all.data(); }
    const Place* end() const { return all.data() + count; }
  };
  Places places(const PhotoData& photo, int index) const {
    const Eigen::Index first = n + of_view * static_cast<Eigen::Index>(photo.photo.view);
    const auto one = [](Eigen::Index at) { return Places{{{{at, 1}, {at, 1}}}, 1}; };
    if (index < unknown::pose) return one(global_index(index, photo.photo.light));
    if (index < unknown::bow) return one(first + (index - unknown::pose));
    if (index < unknown::lens) return one(n + m - lens - 3 + (index - unknown::bow));
    const Eigen::Index of_lens = index - unknown::lens;
    // Centers are in units of the photo's own focal length.
    const double unit = of_lens == 2 || of_lens == 3 ? 1 / photo.photo.focal_ratio : 1;
    Places out{};
    if (of_lens < lens) out.all[out.count++] = {n + m - lens + of_lens, unit};
    if (of_view > 6 && of_lens < 4) out.all[out.count++] = {first + (of_lens < 2 ? 8 : 4 + of_lens), unit};
    return out;
  }
};

// The photos' equations at their places in the whole: over (unknowns, geometry).
struct WholeEquations {
  std::map<std::size_t, Eigen::MatrixXd> H_view;
  std::vector<Eigen::VectorXd> g_photo;
  Eigen::MatrixXd H, tiles;
  Eigen::VectorXd g;
};

WholeEquations whole_equations(const Problem& data, const Layout& layout, Information information,
                               const std::vector<PhotoEquations>& equations, NormalSystem& system) {
  const Eigen::Index n = layout.n, all = layout.n + layout.m;
  const int count = layout.placed();
  WholeEquations out;
  out.H = Eigen::MatrixXd::Zero(all, all);
  out.g = Eigen::VectorXd::Zero(all);
  system.noise_H = Eigen::MatrixXd::Zero(n, n);
  for (std::size_t k = 0; k < data.photos.size(); ++k) {
    const PhotoData& photo = data.photos[k];
    const PhotoEquations& e = equations[k];
    Eigen::MatrixXd& Hv = out.H_view.try_emplace(photo.photo.view, Eigen::MatrixXd::Zero(all, all)).first->second;
    Eigen::VectorXd gk = Eigen::VectorXd::Zero(all);
    if (out.tiles.size() == 0) out.tiles = Eigen::MatrixXd::Zero(all, e.tile_scores.cols());
    for (int a = 0; a < count; ++a)
      for (const auto& [pa, unit_a] : layout.places(photo, a)) {
        gk[pa] += unit_a * e.Jtr[a];
        out.tiles.row(pa) += unit_a * e.tile_scores.row(a);
        for (int b = 0; b < count; ++b)
          for (const auto& [pb, unit_b] : layout.places(photo, b)) {
            Hv(pa, pb) +=
                unit_a * unit_b * (information == Information::curvature ? e.curvature_JtJ(a, b) : e.JtJ(a, b));
            if (pa < n && pb < n) system.noise_H(pa, pb) += e.noise_JtJ(a, b);
          }
      }
    out.g += gk;
    out.g_photo.push_back(std::move(gk));
    system.cost += e.cost;
    for (const float w : photo.weight) system.pixels += w > 0;
  }
  for (const auto& [view, Hv] : out.H_view) out.H += Hv;
  return out;
}

// Paper belongs to its photo; a tag's albedo is its own in all photos.
void add_paper(const Problem& data, const State& state, Information information, NormalSystem& out) {
  const Eigen::Index n = out.g.size();
  for (const LightSample& sample : data.paper) {
    const auto [r, row] = paper_equation(data, state, sample, out.free);
    const double s = r * r / (kPaperLoss * kPaperLoss), weight = 1 / (1 + s);
    const double counted = information == Information::curvature ? std::max(0.0, 1 - s) * weight * weight : weight;
    const Eigen::MatrixXd outer = counted * row * row.transpose();
    const std::size_t view = data.photos[sample.light_view].photo.view;
    out.noise_H += weight * row * row.transpose();
    out.H_view[view] += outer;
    out.g_view[view] += weight * r * row;
    out.photos.col(static_cast<Eigen::Index>(sample.light_view)).head(n) += weight * r * row;
    out.g += weight * r * row;
    auto [at, fresh] = out.tags.try_emplace(sample.tag, Eigen::VectorXd::Zero(n));
    at->second += weight * r * row;
  }
}

// The priors of the table: information (a diagonal) and scores.
void add_priors(const State& state, NormalSystem& out) {
  const Eigen::Index n = out.g.size();
  out.prior = Eigen::VectorXd::Zero(n);
  out.prior_g = Eigen::VectorXd::Zero(n);
  for_each_unknown([&](const UnknownRow& row, int first) {
    if (!(row.prior_sigma[0] > 0)) return;
    const int begin = row.scope == Scope::paper ? kPaperIndex : first;
    for (int i = 0; i < row.size; ++i) {
      if (!out.free[begin + i]) continue;
      out.prior[begin + i] = 1 / std::pow(row.prior_sigma[i], 2);
      out.prior_g[begin + i] = out.prior[begin + i] * state.block(first)[i];
    }
  });
  out.H.diagonal() += out.prior;
  out.noise_H.diagonal() += out.prior;
  out.g += out.prior_g;
}

}  // namespace

NormalSystem normal_system(const Problem& data, const Stage& stage, const State& state, Information information,
                           const std::vector<PhotoEquations>& equations) {
  const Layout layout(data, state);
  const Eigen::Index n = layout.n, m = layout.m;
  NormalSystem out;
  out.free = free_unknowns(data, stage, state.lamps.size());
  WholeEquations whole = whole_equations(data, layout, information, equations, out);

  Eigen::MatrixXd eliminate = Eigen::MatrixXd::Zero(n, n + m);  // (I, -B A^-1)
  eliminate.leftCols(n).setIdentity();
  out.geometry_information = out.geometry_scatter = Eigen::MatrixXd::Zero(n, n);
  if (data.geometry) {
    const GeometryPrior& prior = *data.geometry;
    const Eigen::MatrixXd weighted = prior.weight * prior.information;
    Eigen::VectorXd off = prior.moved;  // of poses exactly, for views with a photo
    for (const PhotoData& photo : data.photos) {
      const std::size_t view = photo.photo.view;
      off.segment<6>(prior.of_view * static_cast<Eigen::Index>(view)) =
          pose_difference(prior.T_camera_board[view], photo.camera.T_camera_board);
    }
    out.A = whole.H.bottomRightCorner(m, m) + weighted;
    out.B = whole.H.topRightCorner(n, m);
    out.geometry_g = whole.g.tail(m) + weighted * off;
    out.geometry_off = off;
    out.gain = inverse_times(out.A, out.B.transpose()).transpose();
    eliminate.rightCols(m) = -out.gain;
    out.geometry_information = out.gain * weighted * out.gain.transpose();
    out.geometry_scatter = prior.weight * out.geometry_information;
    whole.g.tail(m) = out.geometry_g;
  }
  for (const auto& [view, Hv] : whole.H_view) {
    out.H_view[view] = eliminate * Hv * eliminate.transpose();
    out.g_view[view] = Eigen::VectorXd::Zero(n);
  }
  Eigen::MatrixXd with_geometry(n + m, n + m);
  with_geometry << eliminate, Eigen::MatrixXd::Zero(m, n), Eigen::MatrixXd::Identity(m, m);
  out.photos.resize(n + m, static_cast<Eigen::Index>(data.photos.size()));
  for (std::size_t k = 0; k < data.photos.size(); ++k) {
    const auto column = static_cast<Eigen::Index>(k);
    out.photos.col(column) = with_geometry * whole.g_photo[k];
    out.g_view[data.photos[k].photo.view] += out.photos.col(column).head(n);
  }
  out.tiles = with_geometry * whole.tiles;
  out.g = eliminate * whole.g;
  out.H = out.geometry_information;
  add_paper(data, state, information, out);
  for (const auto& [view, Hv] : out.H_view) out.H += Hv;
  add_priors(state, out);
  return out;
}

namespace {

NormalSystem weighted_system(const Problem& data, const Stage& stage, const State& state) {
  return normal_system(data, stage, state, Information::weights,
                       equations_of_photos(data, stage, state, {data.model}).front());
}

}  // namespace

ViewEquations view_equations(const Problem& data, const Stage& stage, const State& state) {
  const NormalSystem system = weighted_system(data, stage, state);
  ViewEquations out;
  out.free = system.free;
  out.prior = system.prior;
  out.prior_g = system.g;
  out.cost = system.cost;
  for (const auto& [view, H] : system.H_view) {
    out.view.push_back(view);
    out.H.push_back(H);
    out.g.push_back(system.g_view.at(view));
    out.prior_g -= out.g.back();
  }
  out.tiles = system.tiles.topRows(system.H.rows());
  out.prior_information = system.geometry_information;
  out.prior_scatter = system.geometry_scatter;
  out.prior_information.diagonal() += system.prior;
  out.prior_scatter.diagonal() += system.prior;
  return out;
}

namespace {

// Distance between the bounds of each unknown; infinite without bounds.
Eigen::VectorXd widths_of_bounds(const Problem& data, std::size_t lights) {
  Eigen::VectorXd out = Eigen::VectorXd::Constant(global_count(lights), std::numeric_limits<double>::infinity());
  for_each_unknown([&](const UnknownRow& row, int first) {
    double low = 0, high = 0;
    if ((row.scope != Scope::shared && row.scope != Scope::lamp) || !bounds_of(data, row, low, high)) return;
    for (int i = row.bounds.at; i < row.bounds.at + row.bounds.count; ++i)
      for (std::size_t light = 0; light < lights; ++light) out[global_index(first + i, light)] = high - low;
  });
  return out;
}

// A Gauss-Newton step within the bounds. An unknown that would leave its bounds stops there, and the others are solved
// with it held there. If it were only moved back afterwards, the others would still compensate for its earlier value.
// An unknown that photos do not determine within its bounds (flanks of grooves that end before them) stays: rounding
// alone would move it from one bound to the other.
Eigen::VectorXd bounded_step(const Problem& data, const State& state, const NormalSystem& system) {
  std::vector<bool> free = system.free;
  Eigen::VectorXd held = Eigen::VectorXd::Zero(system.g.size());
  const Eigen::VectorXd variance = safe_inverse(system.H, free).diagonal(),
                        width = widths_of_bounds(data, state.lamps.size());
  for (Eigen::Index i = 0; i < width.size(); ++i)
    if (variance[i] > width[i] * width[i]) free[static_cast<std::size_t>(i)] = false;
  for (;;) {
    Eigen::VectorXd step = held - safe_inverse(system.H, free) * (system.g + system.H * held);
    const State moved = moved_state(state, step);
    State kept = moved;
    keep_within_bounds(data, kept);
    const Eigen::VectorXd back = step_between(moved, kept), reached = step_between(state, kept);
    bool within = true;
    for (Eigen::Index i = 0; i < back.size(); ++i) {
      if (!free[static_cast<std::size_t>(i)] || back[i] == 0) continue;
      free[static_cast<std::size_t>(i)] = false;
      held[i] = reached[i];
      within = false;
    }
    if (within) return step;
  }
}

}  // namespace

void joint_step(Problem& data, const Stage& stage, State& state, Bench& bench) {
  const std::vector<PhotoEquations> equations = equations_of_photos(data, stage, state, {data.model}).front();
  NormalSystem system = normal_system(data, stage, state, Information::weights, equations);
  if (data.geometry) {
    const double before = data.geometry->weight;
    data.geometry->weight = tags_weight(system, *data.geometry);
    if (data.geometry->weight != before) system = normal_system(data, stage, state, Information::weights, equations);
  }
  const Eigen::VectorXd step = bounded_step(data, state, system);
  state = moved_state(state, step);
  keep_within_bounds(data, state);  // to the last bit
  if (!data.geometry) return;
  const Eigen::VectorXd by = -inverse_times(system.A, system.geometry_g + system.B.transpose() * step);
  // Views without photos move along: their tags were seen through the same lens, on the same board.
  const Eigen::Index of_view = data.geometry->of_view;
  for (std::size_t v = 0; v < bench.views.size(); ++v) {
    View& view = bench.views[v];
    const Eigen::Index first = of_view * static_cast<Eigen::Index>(v);
    view.T_camera_board = moved_pose(view.T_camera_board, by.segment<6>(first));
    if (of_view > 6)
      view.own_lens = moved_own_lens(view.own_lens.value_or(OwnLens{}), bench.lens, by.segment<3>(first + 6));
  }
  const Eigen::Index lens = data.geometry->lens_parameters;
  bench.bow_mm += by.segment<3>(by.size() - lens - 3);
  data.geometry->moved += by;
  bench.lens = moved_lens(bench.lens, by.tail(lens));
}

}  // namespace burin

// python/module.cpp - pyburin._core: what python/pyburin/*.py calls. Private: its functions take contiguous arrays that
// pyburin has checked, and check sizes again, so that no call can read beyond an array. Frame: board, mm.
#include <nanobind/nanobind.h>
#include <nanobind/ndarray.h>
#include <nanobind/stl/array.h>
#include <nanobind/stl/optional.h>
#include <nanobind/stl/pair.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/tuple.h>
#include <nanobind/stl/vector.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <chrono>
#include <exception>
#include <memory>
#include <numeric>
#include <optional>
#include <string>
#include <thread>
#include <tuple>
#include <utility>
#include <vector>

#include "burin/base/error.h"
#include "burin/base/finding.h"
#include "burin/base/simd_choice.h"
#include "burin/base/threads.h"
#include "burin/render/footprint/footprint_integral.h"
#include "burin/scene/bench_of_board.h"
#include "burin/scene/carve.h"
#include "burin/scene/look_at.h"
#include "design.h"
#ifdef BURIN_JAX
#include "jax.h"
#endif
#include "scene.h"
#include "targets.h"

namespace nb = nanobind;

namespace burin::python {
namespace {

using Doubles = nb::ndarray<const double, nb::ndim<1>, nb::c_contig, nb::device::cpu>;
using Matrix = nb::ndarray<const double, nb::ndim<2>, nb::c_contig, nb::device::cpu>;
using Pictures = nb::ndarray<const float, nb::ndim<4>, nb::c_contig, nb::device::cpu>;  // V H W C
using Picture = nb::ndarray<const float, nb::ndim<3>, nb::c_contig, nb::device::cpu>;   // H W C
using OutDoubles = nb::ndarray<nb::numpy, double, nb::ndim<1>>;
using OutMatrix = nb::ndarray<nb::numpy, double, nb::ndim<2>>;
using OutPictures = nb::ndarray<nb::numpy, float, nb::ndim<4>>;

// Ctrl-C during work without the GIL: asks Python now and then, in the thread that called.
class Interrupts {
 public:
  // Several threads may call it often.
  bool asked() {
    if (std::this_thread::get_id() != caller_ || raised_) return raised_;
    const auto now = std::chrono::steady_clock::now();
    if (now - last_ < std::chrono::milliseconds(100)) return false;
    last_ = now;
    const nb::gil_scoped_acquire acquire;
    if (PyErr_CheckSignals() != 0) {
      error_ = std::make_exception_ptr(nb::python_error());
      raised_ = true;
    }
    return raised_;
  }
  void pass_on() const {
    if (raised_) std::rethrow_exception(error_);
  }

 private:
  const std::thread::id caller_ = std::this_thread::get_id();
  std::chrono::steady_clock::time_point last_ = std::chrono::steady_clock::now();
  std::atomic<bool> raised_ = false;
  std::exception_ptr error_;
};

// NumPy arrays that own what they show.
template <typename Out, typename T>
Out owned(std::vector<T> values, std::initializer_list<std::size_t> shape) {
  auto* kept = new std::vector<T>(std::move(values));
  nb::capsule owner(kept, [](void* p) noexcept { delete static_cast<std::vector<T>*>(p); });
  return Out(kept->data(), shape, owner);
}

OutDoubles array_of(std::vector<double> values) {
  const std::size_t size = values.size();
  return owned<OutDoubles>(std::move(values), {size});
}

OutPictures array_of(const std::vector<Image>& images, std::size_t height, std::size_t width, std::size_t channels) {
  std::vector<float> all;
  all.reserve(images.size() * height * width * channels);
  for (const Image& image : images) all.insert(all.end(), image.data.begin(), image.data.end());
  return owned<OutPictures>(std::move(all), {images.size(), height, width, channels});
}

Image image_of(const float* data, std::size_t height, std::size_t width, std::size_t channels) {
  Image out(static_cast<int>(width), static_cast<int>(height), static_cast<int>(channels));
  std::copy_n(data, out.data.size(), out.data.begin());
  return out;
}

std::vector<Image> images_of(const Pictures& pictures) {
  const std::size_t height = pictures.shape(1), width = pictures.shape(2), channels = pictures.shape(3);
  std::vector<Image> out;
  for (std::size_t v = 0; v < pictures.shape(0); ++v)
    out.push_back(image_of(pictures.data() + v * height * width * channels, height, width, channels));
  return out;
}

template <int N>
Eigen::Vector<double, N> vector_of(const Doubles& values, const char* name) {
  if (values.size() != N) fail(name, "has " + std::to_string(values.size()) + " numbers", "give " + std::to_string(N));
  return Eigen::Map<const Eigen::Vector<double, N>>(values.data());
}

std::vector<double> doubles(const Doubles& values) { return {values.data(), values.data() + values.size()}; }

// A column of `size` numbers, or none.
std::vector<double> column(const std::optional<Doubles>& values, std::size_t size, const char* name) {
  if (!values) return {};
  if (values->size() != size)
    fail(name, "has " + std::to_string(values->size()) + " numbers", "give one a scratch: " + std::to_string(size));
  return doubles(*values);
}

Scratches scratches_of(const Matrix& ends, const std::optional<Doubles>& width, const std::optional<Doubles>& depth,
                       const std::optional<Doubles>& alpha) {
  if (ends.shape(1) != 4) fail("ends_mm", "has not 4 numbers a scratch", "give x0, y0, x1, y1");
  const std::size_t size = ends.shape(0);
  Scratches out;
  for (auto* c : {&out.x0_mm, &out.y0_mm, &out.x1_mm, &out.y1_mm}) c->resize(size);
  for (std::size_t i = 0; i < size; ++i) {
    const double* e = ends.data() + 4 * i;
    out.x0_mm[i] = e[0], out.y0_mm[i] = e[1], out.x1_mm[i] = e[2], out.y1_mm[i] = e[3];
  }
  out.width_um = column(width, size, "width_um");
  out.depth_um = column(depth, size, "depth_um");
  out.alpha = column(alpha, size, "alpha");
  return out;
}

OutMatrix ends_of(const std::vector<double>& x0, const std::vector<double>& y0, const std::vector<double>& x1,
                  const std::vector<double>& y1) {
  std::vector<double> out(4 * x0.size());
  for (std::size_t i = 0; i < x0.size(); ++i)
    out[4 * i] = x0[i], out[4 * i + 1] = y0[i], out[4 * i + 2] = x1[i], out[4 * i + 3] = y1[i];
  return owned<OutMatrix>(std::move(out), {x0.size(), 4});
}

Changes changes_of(const Scene& scene, std::optional<double> base_alpha, const std::optional<Matrix>& lamp_mm,
                   const std::optional<Doubles>& lamp_log_intensity, const std::optional<Matrix>& pose,
                   const std::optional<Doubles>& bow_mm) {
  Changes out;
  out.base_alpha = base_alpha;
  if (lamp_mm) {
    if (lamp_mm->shape(0) != scene.lights() || lamp_mm->shape(1) != 3)
      fail("lamp_mm", "has the wrong shape", "give x, y, z for each light of the scene");
    out.lamp_mm.emplace();
    for (std::size_t k = 0; k < scene.lights(); ++k)
      out.lamp_mm->push_back(Eigen::Map<const Eigen::Vector3d>(lamp_mm->data() + 3 * k));
  }
  if (lamp_log_intensity) {
    if (lamp_log_intensity->size() != scene.lights())
      fail("lamp_log_intensity", "has the wrong size", "give a number for each light of the scene");
    out.lamp_log_intensity = doubles(*lamp_log_intensity);
  }
  if (pose) {
    if (pose->shape(0) != scene.views() || pose->shape(1) != 6)
      fail("pose", "has the wrong shape", "give 6 numbers for each view of the scene");
    out.pose.emplace();
    for (std::size_t v = 0; v < scene.views(); ++v)
      out.pose->push_back(Eigen::Map<const Eigen::Vector<double, 6>>(pose->data() + 6 * v));
  }
  if (bow_mm) out.bow_mm = vector_of<3>(*bow_mm, "bow_mm");
  return out;
}

// A view and a light as pyburin's dataclasses have them.
using ViewFields = std::pair<std::string, Matrix>;  // name, T_camera_board (4, 4)
struct LightFields {
  std::string id, kind;
  Doubles position_mm, intensity, axis;
  double falloff_exponent, disk_mm;
  Doubles panel_mm;
  double panel_turn_deg;
};

// `rest` has what the fields do not say.
Board make_board(const Board* rest, Doubles size_mm, Doubles carve_min_mm, Doubles carve_max_mm, double tool_width_um,
                 std::optional<std::pair<double, double>> bend) {
  Board out = rest != nullptr ? *rest : Board{};
  out.size_mm = vector_of<2>(size_mm, "board.size_mm");
  out.carve_min_mm = vector_of<2>(carve_min_mm, "board.carve_min_mm");
  out.carve_max_mm = vector_of<2>(carve_max_mm, "board.carve_max_mm");
  out.tool_width_um = tool_width_um;
  out.bend.reset();
  if (bend) {
    out.bend = Bend{bend->first, bend->second};
    if (const auto fault = fault_of(*out.bend, out.size_mm)) fail("board." + fault->field, fault->what, fault->remedy);
  }
  return out;
}

Bench make_bench(const Bench* rest, const std::string& model, Doubles intrinsics, std::pair<int, int> size_px,
                 const std::vector<ViewFields>& views, const std::vector<LightFields>& lights, Doubles material,
                 Doubles f0, Doubles ambient, Doubles bow_mm, const std::string& crossings) {
  Bench out = rest != nullptr ? *rest : Bench{};
  out.lens = {model, doubles(intrinsics), size_px.first, size_px.second};
  const std::vector<View> old_views = std::exchange(out.views, {});
  for (const auto& [name, T] : views) {
    if (T.shape(0) != 4 || T.shape(1) != 4) fail("view.T_camera_board", "is not 4 x 4", "give a pose");
    const auto old = std::ranges::find(old_views, name, &View::name);
    View view = old != old_views.end() ? *old : View{};
    view.name = name;
    view.roll_to_middle_deg.reset();
    view.T_camera_board.matrix() = Eigen::Map<const Eigen::Matrix<double, 4, 4, Eigen::RowMajor>>(T.data());
    out.views.push_back(std::move(view));
  }
  const std::vector<Light> old_lights = std::exchange(out.lights, {});
  for (const LightFields& fields : lights) {
    const auto old = std::ranges::find(old_lights, fields.id, &Light::id);
    Light light = old != old_lights.end() ? *old : Light{};
    if (light.is_near() != (fields.kind == "lamp"))
      fail("light \"" + fields.id + "\"", "has the kind \"" + fields.kind + "\"",
           "suns and surroundings come from files: keep id and kind that pyburin.read() gave");
    light.id = fields.id;
    light.position_mm = vector_of<3>(fields.position_mm, "light.position_mm");
    light.intensity = vector_of<3>(fields.intensity, "light.intensity");
    light.axis = vector_of<3>(fields.axis, "light.axis");
    light.falloff_exponent = fields.falloff_exponent;
    light.size.disk_mm = fields.disk_mm;
    light.size.panel_mm = vector_of<2>(fields.panel_mm, "light.panel_mm");
    light.size.turn_deg = fields.panel_turn_deg;
    out.lights.push_back(std::move(light));
  }
  const Eigen::Vector3d m = vector_of<3>(material, "material");
  out.material.alpha = m[0], out.material.depth_um = m[1], out.material.base_alpha = m[2];
  out.material.f0 = vector_of<3>(f0, "material.f0");
  out.ambient = vector_of<3>(ambient, "ambient");
  out.bow_mm = vector_of<3>(bow_mm, "bow_mm");
  const auto rule = std::ranges::find(kCrossingsNames, crossings, &std::pair<Crossings, std::string_view>::second);
  if (rule == kCrossingsNames.end()) fail("crossings", "is \"" + crossings + "\"", "give add, last or deepest");
  out.crossings = rule->first;
  return out;
}

template <typename V>
std::vector<double> list_of(const V& v) {
  return {v.data(), v.data() + v.size()};
}

nb::list sentences(const std::vector<Finding>& findings) {
  nb::list out;
  for (const Finding& finding : findings) out.append(sentence(finding));
  return out;
}

nb::dict board_fields(const Board& board) {
  nb::dict out;
  out["size_mm"] = list_of(board.size_mm);
  out["carve_min_mm"] = list_of(board.carve_min_mm);
  out["carve_max_mm"] = list_of(board.carve_max_mm);
  out["tool_width_um"] = board.tool_width_um;
  out["bend_radius_mm"] = board.bend ? nb::cast(board.bend->radius_mm) : nb::none();
  out["bend_axis_deg"] = board.bend ? board.bend->axis_deg : 0.0;
  out["scratches"] = board.scratches.string();
  return out;
}

nb::dict bench_fields(const Bench& bench) {
  nb::dict out;
  out["lens"] = std::tuple(bench.lens.model, bench.lens.intrinsics, bench.lens.width, bench.lens.height);
  nb::list views, lights;
  for (const View& view : bench.views) {
    const Eigen::Matrix<double, 4, 4, Eigen::RowMajor> T = view.T_camera_board.matrix();
    views.append(std::pair(view.name, list_of(T)));
  }
  for (const Light& light : bench.lights) {
    nb::dict one;
    one["id"] = light.id;
    one["kind"] = light.is_near() ? "lamp" : "far";
    one["position_mm"] = list_of(light.position_mm);
    one["intensity"] = list_of(light.intensity);
    one["axis"] = list_of(light.axis);
    one["falloff_exponent"] = light.falloff_exponent;
    one["disk_mm"] = light.size.disk_mm;
    one["panel_mm"] = list_of(light.size.panel_mm);
    one["panel_turn_deg"] = light.size.turn_deg;
    lights.append(one);
  }
  out["views"] = views;
  out["lights"] = lights;
  out["alpha"] = bench.material.alpha;
  out["depth_um"] = bench.material.depth_um;
  out["base_alpha"] = bench.material.base_alpha;
  out["f0"] = list_of(bench.material.f0);
  out["ambient"] = list_of(bench.ambient);
  out["bow_mm"] = list_of(bench.bow_mm);
  out["crossings"] = std::string(
      std::ranges::find(kCrossingsNames, bench.crossings, &std::pair<Crossings, std::string_view>::first)->second);
  out["findings"] = sentences(bench.findings);
  return out;
}

std::pair<Board, Bench> read_setup(const std::string& board_file, const std::string& bench_file) {
  Board board = read_board(board_file);
  Bench bench = read_bench_of(board, board_file, bench_file);
  return {std::move(board), std::move(bench)};
}

nb::dict scratches_fields(const Scratches& s) {
  nb::dict out;
  out["ends_mm"] = ends_of(s.x0_mm, s.y0_mm, s.x1_mm, s.y1_mm);
  const auto put = [&](const char* name, const std::vector<double>& values) {
    out[name] = values.empty() ? nb::none() : nb::cast(array_of(values));
  };
  put("width_um", s.width_um);
  put("depth_um", s.depth_um);
  put("alpha", s.alpha);
  put("carved", s.carved);
  return out;
}

OutPictures render(Scene& scene, const Matrix& ends, const std::optional<Doubles>& width,
                   const std::optional<Doubles>& depth, const std::optional<Doubles>& alpha,
                   std::optional<double> base_alpha, const std::optional<Matrix>& lamp_mm,
                   const std::optional<Doubles>& lamp_log_intensity, const std::optional<Matrix>& pose,
                   const std::optional<Doubles>& bow_mm, bool carve) {
  std::vector<Image> out;
  {
    const nb::gil_scoped_release release;
    const Scratches rows = scratches_of(ends, width, depth, alpha);
    out = scene.render(rows, changes_of(scene, base_alpha, lamp_mm, lamp_log_intensity, pose, bow_mm), !carve);
  }
  return array_of(out, static_cast<std::size_t>(scene.height()), static_cast<std::size_t>(scene.width()),
                  static_cast<std::size_t>(scene.channels()));
}

template <typename V>
OutMatrix matrix_of(const std::vector<V>& rows) {
  std::vector<double> out;
  for (const V& row : rows) out.insert(out.end(), row.data(), row.data() + row.size());
  return owned<OutMatrix>(std::move(out), {rows.size(), static_cast<std::size_t>(V::RowsAtCompileTime)});
}

nb::dict render_vjp(Scene& scene, const Matrix& ends, const Pictures& dE_dradiance, const std::optional<Doubles>& width,
                    const std::optional<Doubles>& depth, const std::optional<Doubles>& alpha,
                    std::optional<double> base_alpha, const std::optional<Matrix>& lamp_mm,
                    const std::optional<Doubles>& lamp_log_intensity, const std::optional<Matrix>& pose,
                    const std::optional<Doubles>& bow_mm, bool carve) {
  Gradients by;
  {
    const nb::gil_scoped_release release;
    const std::size_t height = dE_dradiance.shape(1), w = dE_dradiance.shape(2), channels = dE_dradiance.shape(3);
    if (dE_dradiance.shape(0) != scene.views() || height != static_cast<std::size_t>(scene.height()) ||
        w != static_cast<std::size_t>(scene.width()) || channels != static_cast<std::size_t>(scene.channels()))
      fail("dE_dradiance", "has another shape than the scene's pictures", "give what render() gives");
    const std::vector<Image> images = images_of(dE_dradiance);
    const Scratches rows = scratches_of(ends, width, depth, alpha);
    by =
        scene.gradients(rows, changes_of(scene, base_alpha, lamp_mm, lamp_log_intensity, pose, bow_mm), !carve, images);
  }
  nb::dict out;
  const ScratchGradients& s = by.scratches;
  out["ends_mm"] = ends_of(s.x0_mm, s.y0_mm, s.x1_mm, s.y1_mm);
  if (width) out["width_um"] = array_of(s.width_um);
  if (depth) out["depth_um"] = array_of(s.depth_um);
  if (alpha) out["alpha"] = array_of(s.alpha);
  if (base_alpha) out["base_alpha"] = by.base_alpha;
  if (lamp_mm) out["lamp_mm"] = matrix_of(by.lamp_mm);
  if (lamp_log_intensity) out["lamp_log_intensity"] = array_of(by.lamp_log_intensity);
  if (pose) out["pose"] = matrix_of(by.pose);
  if (bow_mm) out["bow_mm"] = array_of(list_of(by.bow_mm));
  return out;
}

// Rows of 16 numbers: half vector 3, corners 8, alpha, width_um, depth_um, length_mm. Out: Dhat, area, and with
// derivatives Dhat's by half vector 3, corners 8, alpha, width, depth, length, then the area's by corners 8, width,
// depth, length.
constexpr std::size_t kFootprintIn = 15, kFootprintValues = 2, kFootprintDerivatives = 28;
OutMatrix footprint_integrals(const Matrix& rows, bool derivatives) {
  if (rows.shape(1) != kFootprintIn) fail("footprint_integral", "takes rows of 15 numbers", "call pyburin's own");
  const std::size_t size = rows.shape(0), columns = derivatives ? kFootprintDerivatives : kFootprintValues;
  std::vector<double> out(size * columns);
  {
    const nb::gil_scoped_release release;
    for (std::size_t i = 0; i < size; ++i) {
      const double* in = rows.data() + i * kFootprintIn;
      const Eigen::Vector3d h(in[0], in[1], in[2]);
      Quad corners;
      for (std::size_t k = 0; k < 4; ++k) corners[k] = {in[3 + 2 * k], in[4 + 2 * k]};
      const GrooveSegment groove{in[12], in[13], in[11], in[14]};
      double* to = out.data() + i * columns;
      if (!derivatives) {
        const FootprintValue value = footprint_integral(groove, corners, h);
        to[0] = value.Dhat_mm2, to[1] = value.area_mm2;
        continue;
      }
      const FootprintGradient g = footprint_integral_gradient(groove, corners, h);
      *to++ = g.value.Dhat_mm2, *to++ = g.value.area_mm2;
      for (int k = 0; k < 3; ++k) *to++ = g.dDhat_dhalf[k];
      for (const Eigen::Vector2d& c : g.dDhat_dcorner) *to++ = c.x(), *to++ = c.y();
      *to++ = g.dDhat_dalpha, *to++ = g.dDhat_dwidth_um, *to++ = g.dDhat_ddepth_um, *to++ = g.dDhat_dlength_mm;
      for (const Eigen::Vector2d& c : g.darea_dcorner) *to++ = c.x(), *to++ = c.y();
      *to++ = g.darea_dwidth_um, *to++ = g.darea_ddepth_um, *to++ = g.darea_dlength_mm;
    }
  }
  return owned<OutMatrix>(std::move(out), {size, columns});
}

struct DesignTarget {
  std::string view, light;
  Picture picture;
  double weight;
};

DesignSpec spec_of(const std::vector<DesignTarget>& targets) {
  DesignSpec spec;
  for (const DesignTarget& target : targets) {
    DesignView view;
    view.view = target.view;
    view.light = target.light;
    view.weight = target.weight;
    view.target.image =
        image_of(target.picture.data(), target.picture.shape(0), target.picture.shape(1), target.picture.shape(2));
    spec.views.push_back(std::move(view));
  }
  return spec;
}

nb::dict design_of(const Board& board, const Bench& bench, const std::vector<DesignTarget>& targets, int scratches,
                   int pixels, std::optional<int> iterations, std::uint64_t seed, double seconds,
                   const std::array<double, 3>& loss, const std::optional<Matrix>& from, nb::object on_frame) {
  DesignSpec spec = spec_of(targets);
  spec.scratches = scratches;
  DesignOptions options;
  options.pixels = pixels;
  options.iterations = iterations;
  options.seed = seed;
  options.loss = {loss[0], loss[1], loss[2]};
  options.time_limit_s = seconds;
  if (from) options.from = scratches_of(*from, {}, {}, {});
  const auto watch = [&](const DesignFrame& frame) {
    const nb::gil_scoped_acquire acquire;
    if (PyErr_CheckSignals() != 0) throw nb::python_error();
    if (on_frame.is_none()) return true;
    nb::object answer = on_frame(frame.iteration, frame.loss, frame.view_loss, frame.seconds,
                                 frame.psnr_db ? nb::cast(*frame.psnr_db) : nb::none());
    return !answer.is(nb::bool_(false));
  };
  DesignResult result;
  {
    const nb::gil_scoped_release release;
    Interrupts interrupts;
    result = watched_design(spec, board, bench, options, watch, [&] { return interrupts.asked(); });
    interrupts.pass_on();
  }
  nb::dict out;
  out["scratches"] = scratches_fields(result.scratches);
  nb::list views;
  for (const DesignedView& view : result.views) {
    const auto picture = [&](const Image& image) {
      return owned<nb::ndarray<nb::numpy, float, nb::ndim<3>>>(
          image.data, {static_cast<std::size_t>(image.height), static_cast<std::size_t>(image.width),
                       static_cast<std::size_t>(image.channels)});
    };
    nb::dict one;
    one["view"] = view.view;
    one["light"] = view.light;
    one["target"] = picture(view.target);
    one["shown"] = picture(view.shown);
    one["exposure"] = view.best_exposure;
    one["psnr_db"] = view.psnr_db;
    one["ssim"] = view.ssim;
    views.append(one);
  }
  out["views"] = views;
  out["findings"] = sentences(result.findings);
  out["iterations"] = result.history.size();
  out["loss"] = result.final_loss;
  out["seconds"] = result.total_seconds;
  return out;
}

template <typename Do>
auto without_gil(const Do& work) {
  const nb::gil_scoped_release release;
  return work();
}

DesignOptions options_of(int pixels, const std::array<double, 3>& loss, double lift_blacks) {
  DesignOptions out;
  out.pixels = pixels;
  out.loss = {loss[0], loss[1], loss[2]};
  out.lift_blacks = lift_blacks;
  return out;
}

OutPictures pictures_of(const Targets& targets) {
  std::vector<Image> out;
  for (std::size_t v = 0; v < targets.views(); ++v) out.push_back(targets.picture(v));
  return array_of(out, static_cast<std::size_t>(targets.height()), static_cast<std::size_t>(targets.width()), 1);
}

nb::dict loss_of(Targets& targets, const Pictures& radiance, const Doubles& log_exposure) {
  TargetLoss loss = without_gil([&] { return targets.loss(images_of(radiance), doubles(log_exposure)); });
  nb::dict out;
  out["view_loss"] = array_of(std::move(loss.view_loss));
  out["dE_dradiance"] = array_of(loss.dE_dradiance, radiance.shape(1), radiance.shape(2), 1);
  out["dE_dlog_exposure"] = array_of(std::move(loss.dE_dlog_exposure));
  return out;
}

OutDoubles indices(const std::vector<std::size_t>& rows) { return array_of({rows.begin(), rows.end()}); }

// A search, stopped by Ctrl-C.
template <typename Search>
nb::tuple searched(const Search& search) {
  Interrupts interrupts;
  const Searched out = without_gil([&] {
    Searched found = search([&] { return interrupts.asked(); });
    interrupts.pass_on();
    return found;
  });
  const Scratches& s = out.scratches;
  return nb::make_tuple(ends_of(s.x0_mm, s.y0_mm, s.x1_mm, s.y1_mm), array_of(out.log_exposure), indices(out.rows));
}

// Grooves in the metal, and the scratch of each.
nb::dict carve_of(const Board& board, const Bench& bench, const Matrix& ends, const std::optional<Doubles>& width,
                  const std::optional<Doubles>& depth, const std::optional<Doubles>& alpha) {
  const Carved carved =
      without_gil([&] { return carve(Designed(scratches_of(ends, width, depth, alpha)), bench, board); });
  nb::dict out = scratches_fields(carved.scratches);
  std::vector<double> source(carved.source.begin(), carved.source.end());
  if (carved.source.empty()) {
    source.resize(carved.scratches.size());
    std::iota(source.begin(), source.end(), 0.0);
  }
  out["source"] = array_of(std::move(source));
  return out;
}

}  // namespace
}  // namespace burin::python

NB_MODULE(_core, m) {
  using namespace burin;
  using namespace burin::python;
  m.doc() = "Private: call pyburin.";
  nb::exception<Error>(m, "Error", PyExc_ValueError).attr("__doc__") =
      "Bad input: the message names the argument or the file, and what to do.";

  nb::class_<Board>(m, "Board").def("fields", &board_fields);
  nb::class_<Bench>(m, "Bench").def("fields", &bench_fields);
  nb::class_<LightFields>(m, "Light")
      .def(nb::init<std::string, std::string, Doubles, Doubles, Doubles, double, double, Doubles, double>(),
           nb::arg("id"), nb::arg("kind"), nb::arg("position_mm"), nb::arg("intensity"), nb::arg("axis"),
           nb::arg("falloff_exponent"), nb::arg("disk_mm"), nb::arg("panel_mm"), nb::arg("panel_turn_deg"));
  nb::class_<DesignTarget>(m, "DesignTarget")
      .def(nb::init<std::string, std::string, Picture, double>(), nb::arg("view"), nb::arg("light"), nb::arg("picture"),
           nb::arg("weight"));
  m.def("make_board", &make_board, nb::arg("rest").none(), nb::arg("size_mm"), nb::arg("carve_min_mm"),
        nb::arg("carve_max_mm"), nb::arg("tool_width_um"), nb::arg("bend").none());
  m.def("make_bench", &make_bench, nb::arg("rest").none(), nb::arg("model"), nb::arg("intrinsics"), nb::arg("size_px"),
        nb::arg("views"), nb::arg("lights"), nb::arg("material"), nb::arg("f0"), nb::arg("ambient"), nb::arg("bow_mm"),
        nb::arg("crossings"));
  m.def("lens_parameter_count", &lens_parameter_count, nb::arg("model"));
  m.def("read_setup", &read_setup, nb::arg("board_file"), nb::arg("bench_file"));
  m.def(
      "read_scratches", [](const std::string& file) { return scratches_fields(read_scratches(file)); },
      nb::arg("file"));
  m.def(
      "look_at",
      [](Doubles eye, Doubles aim, double roll_deg) {
        const Eigen::Matrix<double, 4, 4, Eigen::RowMajor> T =
            look_at(vector_of<3>(eye, "eye_mm"), vector_of<3>(aim, "aim_mm"), roll_deg).matrix();
        return owned<OutMatrix>(list_of(T), {4, 4});
      },
      nb::arg("eye_mm"), nb::arg("aim_mm"), nb::arg("roll_deg"));

  nb::class_<Scene>(m, "Scene")
      .def(
          "__init__",
          [](Scene* self, const Bench& bench, const Board& board, const std::vector<std::string>& views,
             const std::vector<std::string>& lights, bool on_board, const std::array<int, 4>& window, int channels,
             bool use_double) {
            const nb::gil_scoped_release release;
            new (self) Scene(bench, board, views, lights, {on_board, {window[0], window[1], window[2], window[3]}},
                             channels, use_double);
          },
          nb::arg("bench"), nb::arg("board"), nb::arg("views"), nb::arg("lights"), nb::arg("on_board"),
          nb::arg("window"), nb::arg("channels"), nb::arg("use_double"))
      .def("render", &python::render, nb::arg("ends_mm"), nb::arg("width_um").none(), nb::arg("depth_um").none(),
           nb::arg("alpha").none(), nb::arg("base_alpha").none(), nb::arg("lamp_mm").none(),
           nb::arg("lamp_log_intensity").none(), nb::arg("pose").none(), nb::arg("bow_mm").none(), nb::arg("carve"))
      .def("render_vjp", &python::render_vjp, nb::arg("ends_mm"), nb::arg("dE_dradiance"), nb::arg("width_um").none(),
           nb::arg("depth_um").none(), nb::arg("alpha").none(), nb::arg("base_alpha").none(), nb::arg("lamp_mm").none(),
           nb::arg("lamp_log_intensity").none(), nb::arg("pose").none(), nb::arg("bow_mm").none(), nb::arg("carve"));

  m.def("footprint_integrals", &footprint_integrals, nb::arg("rows"), nb::arg("derivatives"));
  m.def("design", &design_of, nb::arg("board"), nb::arg("bench"), nb::arg("targets"), nb::arg("scratches"),
        nb::arg("pixels"), nb::arg("iterations"), nb::arg("seed"), nb::arg("seconds"), nb::arg("loss"),
        nb::arg("start").none(), nb::arg("on_frame").none());

  nb::class_<Targets>(m, "Targets")
      .def(
          "__init__",
          [](Targets* self, const Board& board, const Bench& bench, const std::vector<DesignTarget>& targets,
             int pixels, const std::array<double, 3>& loss, double lift_blacks) {
            const nb::gil_scoped_release release;
            new (self) Targets(spec_of(targets), board, bench, options_of(pixels, loss, lift_blacks));
          },
          nb::arg("board"), nb::arg("bench"), nb::arg("targets"), nb::arg("pixels"), nb::arg("loss"),
          nb::arg("lift_blacks"))
      .def("pictures", &pictures_of)
      .def("findings", [](const Targets& targets) { return sentences(targets.findings()); })
      .def("loss", &loss_of, nb::arg("radiance"), nb::arg("log_exposure"))
      .def(
          "fitting",
          [](Targets& targets, const Pictures& radiance, const Doubles& log_exposure) {
            return array_of(without_gil([&] { return targets.fitting(images_of(radiance), doubles(log_exposure)); }));
          },
          nb::arg("radiance"), nb::arg("log_exposure"))
      .def(
          "psnr_db",
          [](Targets& targets, const Pictures& radiance, const Doubles& log_exposure) {
            return array_of(without_gil([&] { return targets.psnr_db(images_of(radiance), doubles(log_exposure)); }));
          },
          nb::arg("radiance"), nb::arg("log_exposure"))
      .def(
          "start",
          [](Targets& targets, std::size_t count, std::uint64_t seed) {
            return searched([&](const Targets::Stop& stop) { return targets.start(count, seed, stop); });
          },
          nb::arg("count"), nb::arg("seed"))
      .def(
          "search",
          [](Targets& targets, const Matrix& ends, const Doubles& log_exposure, double share, std::uint64_t seed) {
            return searched([&](const Targets::Stop& stop) {
              return targets.search(scratches_of(ends, {}, {}, {}), doubles(log_exposure), share, seed, stop);
            });
          },
          nb::arg("ends_mm"), nb::arg("log_exposure"), nb::arg("share"), nb::arg("seed"))
      .def(
          "drop",
          [](Targets& targets, const Matrix& ends, const Doubles& log_exposure, double error, double share) {
            return searched([&](const Targets::Stop& stop) {
              return targets.drop(scratches_of(ends, {}, {}, {}), doubles(log_exposure), error, share, stop);
            });
          },
          nb::arg("ends_mm"), nb::arg("log_exposure"), nb::arg("error"), nb::arg("share"));
  m.def("carve", &carve_of, nb::arg("board"), nb::arg("bench"), nb::arg("ends_mm"), nb::arg("width_um").none(),
        nb::arg("depth_um").none(), nb::arg("alpha").none());

#ifdef BURIN_JAX
  m.def(
      "jax_keep", [](Scene& scene) { return keep_for_jax(scene); }, nb::arg("scene"));
  m.def("jax_handlers", [] {
    nb::dict out;
    for (const auto& [name, handler] : jax_handlers()) out[name.c_str()] = nb::capsule(handler);
    return out;
  });
#endif

  nb::class_<ThreadLimit>(m, "ThreadLimit").def(nb::init<int>(), nb::arg("most_threads"));
  m.def("thread_count", &thread_count);
  m.def("simd", [] { return std::string(name(SimdWidth::best)); });
}

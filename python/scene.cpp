#include "scene.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "burin/base/error.h"
#include "burin/scene/bench_of_board.h"
#include "burin/scene/carve.h"

namespace burin::python {
namespace {

// Shining at once.
Light joined(const std::vector<Light>& lights) {
  Light all = lights.front();
  all.also.assign(lights.begin() + 1, lights.end());
  return all;
}

bool has_area(const std::vector<Light>& lights) {
  return std::ranges::any_of(lights, [](const Light& l) { return !l.size.is_point(); });
}

Eigen::Matrix3d skew(const Eigen::Vector3d& v) {
  return (Eigen::Matrix3d() << 0, -v.z(), v.y(), v.z(), 0, -v.x(), -v.y(), v.x(), 0).finished();
}

Eigen::Matrix3d rotation_of(const Eigen::Vector3d& r) {
  const double angle = r.norm();
  if (angle == 0) return Eigen::Matrix3d::Identity();
  return Eigen::AngleAxisd(angle, r / angle).toRotationMatrix();
}

// exp(r + d) = exp(J d) exp(r) for small d.
Eigen::Matrix3d left_jacobian(const Eigen::Vector3d& r) {
  const double a = r.norm();
  const Eigen::Matrix3d k = skew(r);
  if (a < 1e-4) return Eigen::Matrix3d::Identity() + 0.5 * k + k * k / 6;  // the rest is below a^3 / 24
  return Eigen::Matrix3d::Identity() + (1 - std::cos(a)) / (a * a) * k + (a - std::sin(a)) / (a * a * a) * k * k;
}

Eigen::Isometry3d moved(const Eigen::Isometry3d& T, const Eigen::Vector<double, 6>& pose) {
  const Eigen::Matrix3d R = rotation_of(pose.head<3>());
  Eigen::Isometry3d out = T;
  out.linear() = R * T.linear();
  out.translation() = R * T.translation() + pose.tail<3>();
  return out;
}

double inner(const Image& a, const Image& b) {
  double sum = 0;
  for (std::size_t i = 0; i < a.data.size(); ++i) sum += static_cast<double>(a.data[i]) * b.data[i];
  return sum;
}

}  // namespace

Scene::Scene(Bench bench, Board board, const std::vector<std::string>& views, const std::vector<std::string>& lights,
             const Pixels& pixels, int channels, bool use_double)
    : bench_(std::move(bench)), board_(std::move(board)), pixels_(pixels), tiles_(make_tile_cache()) {
  for (const std::string& name : views) views_.push_back(find_view(bench_, name, "views"));
  for (const std::string& id : lights) lights_.push_back(find_light(bench_, id, "lights"));
  options_.channels = channels;
  options_.use_double = use_double;
  changed({});
  give_back(make_renderers({bench_, views_, lights_}, has_area(lights_)), {});  // refused here, not in the first call
}

// The setup of a call. Throws Error where nothing can be seen of it.
Scene::Setup Scene::changed(const Changes& changes) const {
  Setup out{bench_, views_, lights_};
  if (changes.base_alpha) out.bench.material.base_alpha = *changes.base_alpha;
  if (changes.bow_mm) out.bench.bow_mm = *changes.bow_mm;
  for (std::size_t k = 0; k < out.lights.size(); ++k) {
    Light& light = out.lights[k];
    if ((changes.lamp_mm || changes.lamp_log_intensity) && !light.is_near())
      fail(changes.lamp_mm ? "lamp_mm" : "lamp_log_intensity", "light \"" + light.id + "\" is no near lamp",
           "give scenes of near lamps alone");
    if (changes.lamp_mm) light.position_mm = (*changes.lamp_mm)[k];
    if (changes.lamp_log_intensity) light.intensity *= std::exp((*changes.lamp_log_intensity)[k]);
  }
  if (changes.pose)
    for (std::size_t v = 0; v < out.views.size(); ++v)
      out.views[v].T_camera_board = moved(out.views[v].T_camera_board, (*changes.pose)[v]);
  for (const View& view : out.views) fail_unless_sees(view, board_);
  fail_unless_lights(joined(out.lights), board_);
  return out;
}

CameraView Scene::camera_of(const Setup& setup, std::size_t view) const {
  return make_camera_view(setup.bench, board_, setup.views[view], pixels_.window);
}

ViewScene Scene::scene_of(const Setup& setup, std::size_t view, const Light& light) const {
  if (!pixels_.on_board) return make_scene(setup.bench, board_, camera_of(setup, view), light);
  return make_board_scene(setup.bench, board_, width(), height(),
                          setup.views[view].T_camera_board.inverse().translation(), light);
}

Scene::Renderers Scene::make_renderers(const Setup& setup, bool material) const {
  RenderOptions options = options_;
  options.material_gradients = material;
  Renderers out{material, make_render_workspace(kUsualJacobianBytes, tiles_), {}};
  const Light light = joined(setup.lights);
  for (std::size_t v = 0; v < setup.views.size(); ++v)
    out.views.emplace_back(scene_of(setup, v, light), options, out.workspace);
  return out;
}

Scene::Renderers Scene::take_renderers(const Setup& setup, const Changes& changes, bool material) {
  // Lamps with an area are tabulated where only ends move, and points elsewhere: always points, so that a picture does
  // not depend on which derivatives are wanted.
  material = material || has_area(lights_);
  if (!changes.any()) {
    const std::lock_guard lock(mutex_);
    const auto it = std::ranges::find(kept_, material, &Renderers::material);
    if (it != kept_.end()) {
      Renderers out = std::move(*it);
      kept_.erase(it);
      return out;
    }
  }
  return make_renderers(setup, material);
}

void Scene::give_back(Renderers renderers, const Changes& changes) {
  if (changes.any()) return;
  const std::lock_guard lock(mutex_);
  kept_.push_back(std::move(renderers));
}

std::vector<Image> Scene::render(const Scratches& rows, const Changes& changes, bool carved) {
  const Setup setup = changed(changes);
  const Carved metal = carved ? in_metal(rows) : carve(Designed(rows), setup.bench, board_);
  Renderers renderers = take_renderers(setup, changes, false);
  std::vector<Image> out(views());
  for (std::size_t v = 0; v < views(); ++v) renderers.views[v].forward(metal, out[v]);
  give_back(std::move(renderers), changes);
  return out;
}

Gradients Scene::gradients(const Scratches& rows, const Changes& changes, bool carved,
                           const std::vector<Image>& dE_dradiance) {
  const Setup setup = changed(changes);
  const Designed designed(rows);
  const Carved metal = carved ? in_metal(rows) : carve(designed, setup.bench, board_);
  // carve() may give grooves a depth and roughness by their place, which ends then depend on.
  const bool material = changes.base_alpha.has_value() || !metal.scratches.width_um.empty() ||
                        !metal.scratches.depth_um.empty() || !metal.scratches.alpha.empty();
  Renderers renderers = take_renderers(setup, changes, material);
  Gradients out;
  Image radiance;
  for (std::size_t v = 0; v < views(); ++v) {
    renderers.views[v].forward_with_jacobian(metal, radiance);
    renderers.views[v].backward(dE_dradiance[v], out.scratches);
  }
  give_back(std::move(renderers), changes);
  out.base_alpha = out.scratches.shared_base_alpha;
  if (!carved) out.scratches = pull_back(metal, designed, setup.bench, board_, std::move(out.scratches));
  if (changes.lamp_mm || changes.lamp_log_intensity || changes.pose || changes.bow_mm)
    add_scene_gradients(setup, changes, metal, dE_dradiance, out);
  return out;
}

void Scene::add_scene_gradients(const Setup& setup, const Changes& changes, const Carved& carved,
                                const std::vector<Image>& dE_dradiance, Gradients& out) const {
  const bool of_camera = changes.pose || changes.bow_mm;
  const std::string name = changes.pose      ? "pose"
                           : changes.bow_mm  ? "bow_mm"
                           : changes.lamp_mm ? "lamp_mm"
                                             : "lamp_log_intensity";
  if (!board_.mesh.empty()) fail(name, "has no derivative on a board with a mesh", "leave it out");
  if (of_camera && pixels_.on_board)
    fail(name, "has no derivative where pixels lie on the board", "make the scene with pixels=None, a photo's");
  std::vector<SceneParameter> parameters;
  const auto add = [&](SceneParameter first, int count) {
    for (int k = 0; k < count; ++k) parameters.push_back(static_cast<SceneParameter>(static_cast<int>(first) + k));
    return parameters.size() - static_cast<std::size_t>(count);
  };
  const std::size_t lamp = changes.lamp_mm ? add(SceneParameter::light_x_mm, 3) : 0;
  const std::size_t intensity = changes.lamp_log_intensity ? add(SceneParameter::log_intensity, 1) : 0;
  const std::size_t pose = changes.pose ? add(SceneParameter::pose_rx, 6) : 0;
  const std::size_t bow = changes.bow_mm ? add(SceneParameter::bow_0_mm, 3) : 0;
  out.lamp_mm.assign(setup.lights.size(), Eigen::Vector3d::Zero());
  out.lamp_log_intensity.assign(setup.lights.size(), 0);
  out.pose.assign(views(), Eigen::Vector<double, 6>::Zero());
  const auto workspace = make_render_workspace(kUsualJacobianBytes, tiles_);
  for (std::size_t v = 0; v < views(); ++v) {
    Eigen::Vector<double, 6> by_pose = Eigen::Vector<double, 6>::Zero();
    for (std::size_t k = 0; k < setup.lights.size(); ++k) {
      const Light& light = setup.lights[k];
      if (!light.is_near())
        fail(name, "has no derivative under light \"" + light.id + "\", which is no near lamp", "leave it out");
      ViewScene scene = scene_of(setup, v, light);
      if (setup.lights.size() > 1) scene.hidden_from_light.clear();  // as ViewRenderer has it
      const RadianceDerivatives by =
          render_with_derivatives(scene, camera_of(setup, v), carved, parameters, options_, workspace);
      const auto sum = [&](std::size_t parameter) { return inner(by.d_radiance[parameter], dE_dradiance[v]); };
      for (std::size_t a = 0; changes.lamp_mm && a < 3; ++a) out.lamp_mm[k][static_cast<int>(a)] += sum(lamp + a);
      if (changes.lamp_log_intensity) out.lamp_log_intensity[k] += sum(intensity);
      for (std::size_t a = 0; changes.pose && a < 6; ++a) by_pose[static_cast<int>(a)] += sum(pose + a);
      for (std::size_t a = 0; changes.bow_mm && a < 3; ++a) out.bow_mm[static_cast<int>(a)] += sum(bow + a);
    }
    if (!changes.pose) continue;
    // by_pose turns the pose as it is, its translation included; the argument's translation is added after the turn.
    const Eigen::Vector<double, 6>& at = (*changes.pose)[v];
    const Eigen::Vector3d by_turn = by_pose.head<3>() + by_pose.tail<3>().cross(at.tail<3>());
    out.pose[v].head<3>() = left_jacobian(at.head<3>()).transpose() * by_turn;
    out.pose[v].tail<3>() = by_pose.tail<3>();
  }
}

}  // namespace burin::python

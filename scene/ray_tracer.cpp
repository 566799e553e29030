#include "burin/scene/ray_tracer.h"

#include <limits>

#include "burin/base/error.h"
#ifdef BURIN_EMBREE
#include "burin/scene/embree_rays.h"
#endif

namespace burin {

#ifdef BURIN_EMBREE

namespace {

struct Release {
  void operator()(RTCScene scene) const { rtcReleaseScene(scene); }
  void operator()(RTCDevice device) const { rtcReleaseDevice(device); }
};

RTCRay make_ray(const Eigen::Vector3d& origin, const Eigen::Vector3d& direction, double reach) {
  RTCRay ray{};
  ray.org_x = static_cast<float>(origin.x());
  ray.org_y = static_cast<float>(origin.y());
  ray.org_z = static_cast<float>(origin.z());
  ray.dir_x = static_cast<float>(direction.x());
  ray.dir_y = static_cast<float>(direction.y());
  ray.dir_z = static_cast<float>(direction.z());
  ray.tnear = 0;
  ray.tfar = static_cast<float>(reach);
  ray.mask = 0xffffffffU;
  return ray;
}

}  // namespace

struct RayTracer::State {
  std::string name;
  std::unique_ptr<RTCDeviceTy, Release> device{};
  std::unique_ptr<RTCSceneTy, Release> scene{};
};

RayTracer::RayTracer(const std::string& name) : state_(std::make_unique<State>()) {
  state_->name = name;
  state_->device.reset(rtcNewDevice(nullptr));
  if (!state_->device) fail(name, "Embree cannot start", "check its installation (package libembree)");
  state_->scene.reset(rtcNewScene(state_->device.get()));
  rtcSetSceneFlags(state_->scene.get(), RTC_SCENE_FLAG_ROBUST);  // no ray slips between two triangles
}

void RayTracer::add(std::size_t vertices, const std::function<Eigen::Vector3d(std::size_t)>& position_of,
                    std::span<const std::array<std::uint32_t, 3>> triangles) {
  RTCGeometry geometry = rtcNewGeometry(state_->device.get(), RTC_GEOMETRY_TYPE_TRIANGLE);
  auto* v = static_cast<float*>(
      rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3, 3 * sizeof(float), vertices));
  auto* t = static_cast<std::uint32_t*>(rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3,
                                                                3 * sizeof(std::uint32_t), triangles.size()));
  if (!v || !t) {
    rtcReleaseGeometry(geometry);
    fail(state_->name, "Embree has no memory for " + std::to_string(triangles.size()) + " triangles",
         "use a coarser mesh");
  }
  for (std::size_t i = 0; i < vertices; ++i) {
    const Eigen::Vector3d p = position_of(i);
    for (int k = 0; k < 3; ++k) v[3 * i + k] = static_cast<float>(p[k]);
  }
  for (std::size_t i = 0; i < triangles.size(); ++i)
    for (int k = 0; k < 3; ++k) t[3 * i + k] = triangles[i][k];
  rtcCommitGeometry(geometry);
  rtcAttachGeometry(state_->scene.get(), geometry);
  rtcReleaseGeometry(geometry);
}

void RayTracer::build() {
  rtcCommitScene(state_->scene.get());
  if (rtcGetDeviceError(state_->device.get()) != RTC_ERROR_NONE)
    fail(state_->name, "Embree could not build its tree over the mesh", "use a coarser mesh");
}

std::optional<RayTracer::Hit> RayTracer::first_hit(const Eigen::Vector3d& origin,
                                                   const Eigen::Vector3d& direction) const {
  RTCRayHit query{};
  query.ray = make_ray(origin, direction, std::numeric_limits<double>::infinity());
  query.hit.geomID = RTC_INVALID_GEOMETRY_ID;
  query.hit.instID[0] = RTC_INVALID_GEOMETRY_ID;
  burin::first_hit(state_->scene.get(), query);
  if (query.hit.geomID == RTC_INVALID_GEOMETRY_ID) return std::nullopt;
  return Hit{query.hit.geomID, query.hit.primID};
}

bool RayTracer::is_blocked(const Eigen::Vector3d& origin, const Eigen::Vector3d& way) const {
  RTCRay ray = make_ray(origin, way, 1);
  QueryContext context;
  init_query(context);
  any_hit(state_->scene.get(), context, false, ray);
  return ray.tfar < 0;
}

#else

struct RayTracer::State {};

RayTracer::RayTracer(const std::string& name) {
  fail(name, "this build of Burin has no Embree, which boards given as meshes need",
       "bend the board by \"bend\" in board.json, or build with Embree");
}
void RayTracer::add(std::size_t, const std::function<Eigen::Vector3d(std::size_t)>&,
                    std::span<const std::array<std::uint32_t, 3>>) {}
void RayTracer::build() {}
std::optional<RayTracer::Hit> RayTracer::first_hit(const Eigen::Vector3d&, const Eigen::Vector3d&) const { return {}; }
bool RayTracer::is_blocked(const Eigen::Vector3d&, const Eigen::Vector3d&) const { return false; }

#endif

RayTracer::~RayTracer() = default;
RayTracer::RayTracer(RayTracer&&) noexcept = default;
RayTracer& RayTracer::operator=(RayTracer&&) noexcept = default;

}  // namespace burin

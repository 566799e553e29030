// burin/scene/ray_tracer.h - rays through triangles, by Embree in float.
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>

namespace burin {

/// Triangles in groups, numbered from 0 as they are added. Queries follow build() and may run in several threads.
class RayTracer {
 public:
  /// `name` is the mesh that errors name. Throws Error if Embree cannot start, or if this build has none.
  explicit RayTracer(const std::string& name);
  ~RayTracer();
  RayTracer(RayTracer&&) noexcept;
  RayTracer& operator=(RayTracer&&) noexcept;

  /// Adds a group of triangles between `vertices` places. Throws Error without memory for them.
  void add(std::size_t vertices, const std::function<Eigen::Vector3d(std::size_t)>& position_of,
           std::span<const std::array<std::uint32_t, 3>> triangles);
  void build();

  struct Hit {
    unsigned group, triangle;
  };
  /// The first triangle on a ray.
  std::optional<Hit> first_hit(const Eigen::Vector3d& origin, const Eigen::Vector3d& direction) const;
  /// Whether any triangle lies between origin and origin + way.
  bool is_blocked(const Eigen::Vector3d& origin, const Eigen::Vector3d& way) const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace burin

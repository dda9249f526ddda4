// Shared by the tests that trace scenes: a scene that is built and uploaded once, rays made from
// origin and direction, random points, and meshes of subdivided squares.
#pragma once

#include <cmath>
#include <limits>
#include <numbers>
#include <random>
#include <utility>
#include <vector>

#include "dapple/render.hpp"

namespace dapple::scene_test {

inline constexpr float kInfinity = std::numeric_limits<float>::infinity();
inline constexpr double kPi = std::numbers::pi;

/// The device, opened once per process because compiling kernels takes longer than most tests.
inline const Device& device() {
  static const Device device;
  return device;
}

/// A scene with its BVH, uploaded to the device. Its instances are not merged.
class SceneOnDevice {
 public:
  explicit SceneOnDevice(Scene scene_to_build, const UploadOptions& options = {})
      : scene(std::move(scene_to_build)),
        bvh(build_bvh(scene)),
        uploaded(upload(device(), scene, bvh, options)) {}
  SceneOnDevice(const SceneOnDevice&) = delete;
  SceneOnDevice& operator=(const SceneOnDevice&) = delete;

  [[nodiscard]] std::vector<Occlusion> trace(const std::vector<Ray>& rays, Estimator estimator,
                                             float footprint = 1.0f) const {
    return dapple::trace(device(), uploaded, rays, estimator, footprint);
  }
  [[nodiscard]] float occlusion_at(const V3f& point, const V3f& normal,
                                   const OcclusionOptions& options) const {
    return occlusion(device(), uploaded, std::vector{point}, std::vector{normal}, options)[0];
  }

  const Scene scene;
  const SceneBvh bvh;
  const DeviceScene uploaded;
};

inline Ray make_ray(const V3f& origin, const V3f& direction, float solid_angle = 0,
                    float t_max = kInfinity) {
  const V3f unit = direction.normalized();
  Ray ray{};
  for (int axis = 0; axis < 3; ++axis) {
    ray.origin[axis] = origin[axis];
    ray.direction[axis] = unit[axis];
  }
  ray.t_max = t_max;
  ray.solid_angle = solid_angle;
  return ray;
}

inline double mean_transmittance(const std::vector<Occlusion>& found) {
  double sum = 0;
  for (const Occlusion& one : found) sum += one.transmittance;
  return sum / static_cast<double>(found.size());
}

/// Pseudo-random points, the same with every standard library: only the engine's bits are used.
class Points {
 public:
  explicit Points(std::uint32_t seed) : bits_(seed) {}
  float unit() { return static_cast<float>(bits_() >> 8) * (1.0f / 16777216.0f); }
  V3f in_cube(float half) {
    const float x = unit(), y = unit(), z = unit();
    return V3f(2 * x - 1, 2 * y - 1, 2 * z - 1) * half;
  }
  V3f on_sphere() {
    const float z = 2 * unit() - 1;
    const float angle = 2 * static_cast<float>(kPi) * unit();
    const float r = std::sqrt(std::max(0.0f, 1 - z * z));
    return {r * std::cos(angle), r * std::sin(angle), z};
  }

 private:
  std::mt19937 bits_;
};

/// `count` rays from a sphere of `radius` around the middle of `box` towards random points in it.
inline std::vector<Ray> rays_through(const Box3f& box, std::size_t count, float radius,
                                     float solid_angle, std::uint32_t seed) {
  Points points(seed);
  std::vector<Ray> rays;
  for (std::size_t i = 0; i < count; ++i) {
    const V3f at(box.min.x + points.unit() * (box.max.x - box.min.x),
                 box.min.y + points.unit() * (box.max.y - box.min.y),
                 box.min.z + points.unit() * (box.max.z - box.min.z));
    const V3f from = box.center() + points.on_sphere() * radius;
    rays.push_back(make_ray(from, at - from, solid_angle));
  }
  return rays;
}

/// `count` rays through the ball around `box`: random directions, uniform over the ball's cross
/// section. Their mean opacity is the occluding area, which prefiltering must not change.
inline std::vector<Ray> rays_across(const Box3f& box, std::size_t count, float solid_angle,
                                    std::uint32_t seed) {
  Points points(seed);
  const float radius = box.size().length() / 2;
  std::vector<Ray> rays;
  while (rays.size() < count) {
    const V3f direction = points.on_sphere();
    const float x = (2 * points.unit() - 1) * radius, y = (2 * points.unit() - 1) * radius;
    if (x * x + y * y > radius * radius) continue;
    const V3f u =
        direction.cross(std::fabs(direction.x) < 0.5f ? V3f(1, 0, 0) : V3f(0, 1, 0)).normalized();
    const V3f v = direction.cross(u);
    const V3f at = box.center() + u * x + v * y;
    rays.push_back(make_ray(at - direction * (2 * radius), direction, solid_angle));
  }
  return rays;
}

inline Material material_of(float opacity) {
  Material material;
  material.name = "material_" + std::to_string(opacity);
  material.alpha_mode = AlphaMode::blend;
  material.alpha = opacity;
  return material;
}

/// Appends the parallelogram corner + [0,1] u + [0,1] v, made of `divisions` x `divisions` quads.
inline void append_grid(Mesh& mesh, const V3f& corner, const V3f& u, const V3f& v, int divisions,
                        std::uint32_t material) {
  const auto first = static_cast<std::uint32_t>(mesh.positions.size());
  const auto row = static_cast<std::uint32_t>(divisions + 1);
  const float step = 1.0f / static_cast<float>(divisions);
  for (int j = 0; j <= divisions; ++j) {
    for (int i = 0; i <= divisions; ++i) {
      mesh.positions.push_back(corner + u * (step * static_cast<float>(i)) +
                               v * (step * static_cast<float>(j)));
    }
  }
  for (std::uint32_t j = 0; j + 1 < row; ++j) {
    for (std::uint32_t i = 0; i + 1 < row; ++i) {
      const std::uint32_t a = first + j * row + i;
      mesh.indices.insert(mesh.indices.end(), {a, a + 1, a + row + 1, a, a + row + 1, a + row});
      mesh.materials.insert(mesh.materials.end(), {material, material});
    }
  }
}

/// Adds `mesh` and an instance of it; returns the instance's index.
inline std::size_t place(Scene& scene, Mesh mesh, const M44f& to_world = {}, int light = -1) {
  scene.instances.push_back({static_cast<std::uint32_t>(scene.meshes.size()), to_world, light});
  scene.meshes.push_back(std::move(mesh));
  return scene.instances.size() - 1;
}

/// A horizontal square of `side` at `height`, facing up.
inline Mesh square_mesh(float side, float height, int divisions, std::uint32_t material) {
  Mesh mesh;
  append_grid(mesh, {-side / 2, height, side / 2}, {side, 0, 0}, {0, 0, -side}, divisions,
              material);
  return mesh;
}

/// One slanted opaque square that a ray along +Y hits just beyond `distance`. Its node contains the
/// ray's end, so it must be opened at every footprint, and the square must not count.
struct SquareBeyond {
  Scene scene;
  V3f origin;  ///< of the ray

  explicit SquareBeyond(float distance) {
    scene.materials.push_back(material_of(1));
    const float half = 0.05f * distance, tilt = 0.02f * distance;
    Mesh mesh;
    append_grid(mesh, {-half, 1.001f * distance - tilt, -half}, {2 * half, 2 * tilt, 0},
                {0, 0, 2 * half}, 1, 0);
    place(scene, std::move(mesh));
    origin = V3f(1e-3f * half, 0, 2e-3f * half);
  }
};

/// Appends 1000 triangles at z >= 9, behind cameras that look along -z from a smaller z. With them
/// a mesh is large enough to stay an instance.
inline void add_triangles_out_of_sight(Mesh& mesh) {
  for (int i = 0; i < 1000; ++i) {
    const auto first = static_cast<std::uint32_t>(mesh.positions.size());
    for (const V3f& corner : {V3f(0, 0, 9), V3f(0, 1, 9), V3f(1, 0, 9)})
      mesh.positions.push_back(corner + V3f(0, 0, static_cast<float>(i)));
    mesh.uvs.resize(mesh.positions.size(), V2f(0.0f));
    mesh.indices.insert(mesh.indices.end(), {first, first + 1, first + 2});
    mesh.materials.push_back(0);
  }
}

}  // namespace dapple::scene_test

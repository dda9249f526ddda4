#include "points/periodic.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "dapple/error.hpp"

namespace dapple {
namespace {

constexpr double kMaxInstances = 4e6;

/// The scene and its period along one axis.
struct Interval {
  Interval(const Box3f& scene, int axis, float metres)
      : period(metres), middle((double{scene.min[axis]} + double{scene.max[axis]}) / 2) {
    if (scene.isEmpty()) middle = 0;
    half = std::max(period, double{scene.max[axis]} - double{scene.min[axis]}) / 2.0;
  }

  [[nodiscard]] float inside(float x) const {
    const double from_middle = double{x} - middle;
    if (!(std::fabs(from_middle) > half)) return x;
    return static_cast<float>(double{x} - period * std::round(from_middle / period));
  }

  /// To each side, for rays that go as far as `reach` from points in `points`.
  [[nodiscard]] double copies(double reach, float points_min, float points_max) const {
    const double farthest =
        std::max({half, middle - double{points_min}, double{points_max} - middle});
    return std::ceil((reach + farthest + half) / period);
  }

  double period, middle, half;
};

}  // namespace

bool has_placed_light(const Scene& scene) {
  return std::any_of(scene.lights.begin(), scene.lights.end(), [](const Light& light) {
    return light.kind != LightKind::sun && light.kind != LightKind::dome;
  });
}

std::vector<V3f> points_in_period(const Scene& scene, float period_x, float period_z,
                                  std::span<const V3f> points) {
  std::vector<V3f> moved(points.begin(), points.end());
  const Box3f bounds = scene_bounds(scene);
  const Interval x(bounds, 0, period_x), z(bounds, 2, period_z);
  for (V3f& point : moved) point = V3f(x.inside(point.x), point.y, z.inside(point.z));
  return moved;
}

void repeat(Scene& scene, float period_x, float period_z, std::span<const V3f> points) {
  const Box3f bounds = scene_bounds(scene);
  if (bounds.isEmpty()) return;
  Box3f around = bounds;
  for (const V3f& point : points) around.extendBy(point);
  const double reach =  // the tangent of the angle to the zenith, times the height
      std::sqrt(1 / (kLowestPeriodic * kLowestPeriodic) - 1) * double{around.size().y};
  const auto copies = [&](int axis, float period) {
    return Interval(bounds, axis, period).copies(reach, around.min[axis], around.max[axis]);
  };
  const double x = copies(0, period_x), z = copies(2, period_z);
  const double all = (2 * x + 1) * (2 * z + 1) * static_cast<double>(scene.instances.size());
  if (!(all <= kMaxInstances))
    throw Error(
        ErrorKind::usage,
        fmt::format("--periodic is {},{}; scene and points are {:.3g} m high (the scene from y = "
                    "{:.4g} to {:.4g}, all from {:.4g} to {:.4g}) and {:.3g} by {:.3g} m wide, "
                    "which takes {:.3g} instances (at most {:.3g}); repeat a larger part of the "
                    "scene, as one mesh, or measure high or far points apart",
                    period_x, period_z, around.size().y, bounds.min.y, bounds.max.y, around.min.y,
                    around.max.y, around.size().x, around.size().z, all, kMaxInstances));
  const std::vector<Instance> once = scene.instances;
  const int last_x = static_cast<int>(x), last_z = static_cast<int>(z);
  for (int i = -last_x; i <= last_x; ++i) {
    for (int j = -last_z; j <= last_z; ++j) {
      if (i == 0 && j == 0) continue;
      const M44f move = M44f().setTranslation(
          V3f(static_cast<float>(i) * period_x, 0, static_cast<float>(j) * period_z));
      for (Instance copy : once) {
        copy.to_world = copy.to_world * move;
        copy.light = -1;
        scene.instances.push_back(copy);
      }
    }
  }
}

}  // namespace dapple

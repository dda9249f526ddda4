#include "points/periodic.hpp"

#include <fmt/format.h>

#include <cmath>

#include "dapple/error.hpp"

namespace dapple {
namespace {

/// Tangent of 85 degrees from the zenith.
constexpr double kReach = 11.43;
constexpr double kMaxInstances = 4e6;

}  // namespace

void repeat(Scene& scene, float period_x, float period_z) {
  const Box3f bounds = scene_bounds(scene);
  const double reach = kReach * double{bounds.size().y};
  const auto copies = [&](float period) { return std::ceil(reach / double{period}) + 1; };
  const double x = copies(period_x), z = copies(period_z);
  const double all = (2 * x + 1) * (2 * z + 1) * static_cast<double>(scene.instances.size());
  if (!(all <= kMaxInstances))
    throw Error(ErrorKind::usage,
                fmt::format("--periodic is {},{}; for a scene {:.3g} m high that takes {:.3g} "
                            "instances (at most {:.3g}); repeat a larger part of it",
                            period_x, period_z, bounds.size().y, all, kMaxInstances));
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

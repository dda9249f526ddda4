#include "points/option_notes.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "points/periodic.hpp"
#include "points/point_sets.hpp"
#include "points/ring_rays.hpp"

namespace dapple {
namespace {

using Notes = std::vector<std::string>;

void note_overlaps(const PointOptions& options, const Box3f& bounds, Notes& notes) {
  constexpr float kOverlap = 1.25f;  // leaves reach over a little
  const auto note = [&](char axis, float width, float period) {
    if (period > 0 && width >= kOverlap * period)
      notes.push_back(fmt::format(
          "the scene is {:.4g} m wide along {}, and its period {:.4g} m: copies overlap", width,
          axis, period));
  };
  note('X', bounds.size().x, options.period_x);
  note('Z', bounds.size().z, options.period_z);
}

/// Of rings and suns whose rays leave the copies of a periodic scene (repeat()).
void note_low_rays(const PointOptions& options, Notes& notes) {
  const std::vector<ZenithRing> rings = zenith_rings(options.rings);
  const auto low_rings = std::ranges::count_if(
      rings, [](const ZenithRing& ring) { return ring.cos_outer < kLowestPeriodic; });
  if (low_rings > 0)
    notes.push_back(
        fmt::format("{} of {} rings reach{} lower than 5 degrees above the horizon, "
                    "where rays leave the copies of --periodic: too much sky",
                    low_rings, rings.size(), low_rings == 1 ? "es" : ""));
  const auto low_suns = std::ranges::count_if(options.suns, [](const SunDirection& sun) {
    return sun.irradiance > 0 && sun.direction.y > 0 && sun.direction.y < kLowestPeriodic;
  });
  if (low_suns > 0)
    notes.push_back(
        fmt::format("{} of {} suns {} lower than 5 degrees above the horizon, where "
                    "rays leave the copies of --periodic: too much light",
                    low_suns, options.suns.size(), low_suns == 1 ? "is" : "are"));
}

}  // namespace

std::vector<std::string> option_notes(const PointOptions& options, const Scene& scene,
                                      std::span<const V3f> points) {
  Notes notes;
  if (options.rays % kPointSets != 0)
    notes.push_back(fmt::format("--rays is {}; {} are traced, a multiple of {}", options.rays,
                                options.rays / kPointSets * kPointSets, kPointSets));
  const bool is_periodic = options.period_x > 0;
  if (!options.ground && !is_periodic) return notes;
  const Box3f bounds = scene_bounds(scene);
  if (bounds.isEmpty()) return notes;
  const auto below =
      std::ranges::count_if(points, [&](const V3f& point) { return point.y < bounds.min.y; });
  if (options.ground && below > 0)
    notes.push_back(fmt::format("{} of {} points lie below the ground, which is at y = {:.4g}",
                                below, points.size(), bounds.min.y));
  if (!is_periodic) return notes;
  note_overlaps(options, bounds, notes);
  note_low_rays(options, notes);
  return notes;
}

}  // namespace dapple

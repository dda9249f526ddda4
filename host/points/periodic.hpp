// A scene that repeats itself in the plane, as copies of its instances. In: a scene, and the points
// to measure at. Out: the scene with its copies, and points inside it.
#pragma once

#include <span>
#include <vector>

#include "dapple/scene.hpp"

namespace dapple {

/// The cosine to the zenith of the lowest rays that meet copies all the way: five degrees above the
/// horizon.
inline constexpr double kLowestPeriodic = 0.08715;

/// Whether a light is neither a sun nor a dome. Copies do not emit, so points below other copies of
/// such scenes are not alike.
bool has_placed_light(const Scene& scene);

/// Moves points that lie beyond the scene, and beyond one period around its middle, into that
/// period.
std::vector<V3f> points_in_period(const Scene& scene, float period_x, float period_z,
                                  std::span<const V3f> points);

/// Adds copies of all instances at multiples of the periods, so far that rays from the points leave
/// the height of scene and points before they leave the copies, but for those below
/// kLowestPeriodic. Throws Error usage if that takes too many copies.
void repeat(Scene& scene, float period_x, float period_z, std::span<const V3f> points);

}  // namespace dapple

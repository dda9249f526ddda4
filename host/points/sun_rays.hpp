// Makes rays from points towards the disks of suns. Of many suns each ray represents several that
// are near each other. In: suns, a point with its normal. Out: rays, all of which bring the same
// irradiance if nothing occludes them.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "dapple/points.hpp"
#include "dapple/shared/ray.h"

namespace dapple {

/// Solid angle of the sun, 0.533 degrees wide.
inline constexpr float kSunSolidAngle = 6.797e-5f;

/// A direction towards the disk of a sun whose middle is at `direction`, evenly by solid angle.
/// u, v: [0,1).
V3f direction_to_disk(const V3f& direction, double u, double v);

/// Stratified samples of suns, which are ordered so that neighbours have similar directions; the
/// probability of each is in proportion to what it brings (Cochran, "Sampling Techniques", 1977,
/// chapters 5 and 9A). The suns of a stratum spread over a cap of the sphere: a ray's footprint.
class SunRays {
 public:
  explicit SunRays(std::span<const SunDirection> suns);

  /// Irradiance without occlusion, W/m^2.
  [[nodiscard]] double unoccluded(const V3f& normal) const;

  /// Fills `rays` with `sets` sets of the same size; ray r is of set r % sets. Each set is a sample
  /// of its own, and all together are a better one than if they were independent. Where no sun
  /// shines on the surface, rays end at once.
  void sample(const V3f& point, const V3f& normal, std::size_t sets, std::uint32_t random,
              std::span<Ray> rays) const;

 private:
  /// Of the cap over which suns `first` to `last` spread.
  [[nodiscard]] float solid_angle(std::size_t first, std::size_t last) const;
  /// Irradiance without occlusion of the suns before each, and of all.
  [[nodiscard]] std::vector<double> sums_of_irradiance(const V3f& normal) const;

  std::vector<SunDirection> suns_;
  /// Of the suns before each, and of all.
  std::vector<double> irradiance_before_;
  std::vector<Imath::V3d> vectors_before_;  ///< directions times irradiances
};

}  // namespace dapple

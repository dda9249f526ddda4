// An independent reference for tests: Embree intersects all triangles and strands in world space,
// and oracle_primitives.hpp computes their opacity. In: a scene and rays; out: transmittances and
// first hits.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>

#include "dapple/scene.hpp"

namespace dapple::oracle {

/// Splitmix64 (Steele, Lea, Flood, "Fast Splittable Pseudorandom Number Generators", 2014).
class Random {
 public:
  explicit Random(std::uint64_t seed) : state_(seed) {}
  std::uint64_t bits();
  /// Uniform in [0,1).
  double real() { return static_cast<double>(bits() >> 11) * 0x1p-53; }
  /// Uniform in [low, high).
  double between(double low, double high) { return low + (high - low) * real(); }
  /// Unit vector, uniform over the sphere.
  V3d direction();

 private:
  std::uint64_t state_;
};

/// A ray from `origin` along the unit vector `direction`, in world space, up to `t_max` metres.
struct Segment {
  V3f origin;
  V3f direction;
  float t_max = std::numeric_limits<float>::infinity();
};

/// Where a segment hits a surface. Both normals are on the side from which the segment comes.
struct Hit {
  V3d position;
  V3d normal;          ///< of the shading: that of the mesh, interpolated; geometric if it has none
  V3d facet;           ///< geometric
  V3d start;           ///< where rays start: `position`, or the smooth surface above it
  bool hides = false;  ///< the facet itself hides what goes below it
};

class EmbreeOracle {
 public:
  /// Copies what it needs of `scene`, whose instances may be merged or not.
  explicit EmbreeOracle(const Scene& scene);
  ~EmbreeOracle();

  /// Product of (1 - opacity) over the triangles that the segment hits, each taken once, and over
  /// the strand segments through which it enters a strand.
  [[nodiscard]] double transmittance(const Segment& segment) const;

  /// The closest surface that stops the segment; none: nullopt. A surface of opacity a stops it
  /// with probability a, independently of other surfaces and of calls with other values of `key`.
  [[nodiscard]] std::optional<Hit> first_hit(const Segment& segment, std::uint64_t key) const;

 private:
  struct Embree;
  std::unique_ptr<Embree> embree_;
};

}  // namespace dapple::oracle

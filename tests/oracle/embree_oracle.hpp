// An independent renderer's view of a scene, for tests to compare with: Embree finds the
// triangles and strands, all flattened into world space; opacity is looked up here, in double,
// without a line of the product's own lookup.
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
  /// In [0,1).
  double real() { return static_cast<double>(bits() >> 11) * 0x1p-53; }
  /// In [low, high).
  double between(double low, double high) { return low + (high - low) * real(); }
  /// Unit vector, uniform over the sphere.
  V3d direction();

 private:
  std::uint64_t state_;
};

/// From `origin` along unit vector `direction`, both in world space, up to `t_max` metres.
struct Segment {
  V3f origin;
  V3f direction;
  float t_max = std::numeric_limits<float>::infinity();
};

/// Where a segment met a surface; the normal is geometric and turned against the segment.
struct Hit {
  V3d position;
  V3d normal;
};

class EmbreeOracle {
 public:
  /// Copies what it needs; `scene` may be as it was loaded or with its instances merged.
  explicit EmbreeOracle(const Scene& scene);
  ~EmbreeOracle();

  /// Product of (1 - opacity) over the triangles on the segment, each taken once, and the segments
  /// of strands through which it enters one.
  [[nodiscard]] double transmittance(const Segment& segment) const;

  /// The nearest surface that stops the segment; one of opacity a does so with probability a,
  /// independently of others and of calls with other values of `key`.
  [[nodiscard]] std::optional<Hit> first_hit(const Segment& segment, std::uint64_t key) const;

 private:
  struct Embree;
  std::unique_ptr<Embree> embree_;
};

}  // namespace dapple::oracle

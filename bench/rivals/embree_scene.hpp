// Embree's acceleration structure of a scene, at one build quality. Traced by embree_trace.hpp.
#pragma once

#include <embree3/rtcore.h>

#include <atomic>
#include <cstdint>

#include "rivals/embree_geometry.hpp"

namespace dapple::bench {

class EmbreeScene {
 public:
  /// One RTCScene a mesh, instanced where the scene has several placements. `geometry` must
  /// outlive it. Throws Error failed when Embree reports an error.
  EmbreeScene(const EmbreeGeometry& geometry, RTCBuildQuality quality);
  ~EmbreeScene();
  EmbreeScene(const EmbreeScene&) = delete;
  EmbreeScene& operator=(const EmbreeScene&) = delete;

  [[nodiscard]] RTCScene top() const { return top_; }
  [[nodiscard]] const EmbreeGeometry& geometry() const { return geometry_; }
  /// Whether a triangle may be in several leaves, and so be reported several times.
  [[nodiscard]] bool has_spatial_splits() const { return quality_ == RTC_BUILD_QUALITY_HIGH; }

  /// Wall time from the first geometry to the last commit.
  [[nodiscard]] double build_seconds() const { return build_seconds_; }
  /// What Embree holds once built; positions, indices and opacities are not among it.
  [[nodiscard]] std::size_t bytes() const { return bytes_; }

 private:
  void attach_meshes(RTCScene scene, const EmbreeMesh& mesh);
  void attach_placements();
  RTCScene new_scene();
  void check() const;

  const EmbreeGeometry& geometry_;
  RTCBuildQuality quality_;
  RTCDevice device_;
  RTCScene top_ = nullptr;
  std::vector<RTCScene> objects_;
  double build_seconds_ = 0;
  std::size_t bytes_ = 0;
  std::atomic<std::int64_t> held_bytes_ = 0;
};

}  // namespace dapple::bench

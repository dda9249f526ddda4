// Embree's BVH of a scene at one build quality. In: EmbreeGeometry. Out: an RTCScene, which
// embree_trace.hpp traces, its build time and its memory.
#pragma once

#include <embree3/rtcore.h>

#include <atomic>
#include <cstdint>

#include "rivals/embree/embree_geometry.hpp"

namespace dapple::bench {

class EmbreeScene {
 public:
  /// Builds one RTCScene per mesh, instanced unless the geometry is flat. `geometry` must outlive
  /// this object. Throws Error failed when Embree reports an error.
  EmbreeScene(const EmbreeGeometry& geometry, RTCBuildQuality quality);
  ~EmbreeScene();
  EmbreeScene(const EmbreeScene&) = delete;
  EmbreeScene& operator=(const EmbreeScene&) = delete;

  [[nodiscard]] RTCScene top() const { return top_; }
  [[nodiscard]] const EmbreeGeometry& geometry() const { return geometry_; }
  /// Whether a triangle may be in several leaves, so that Embree may report it several times.
  [[nodiscard]] bool has_spatial_splits() const { return quality_ == RTC_BUILD_QUALITY_HIGH; }

  /// Wall time of building.
  [[nodiscard]] double build_seconds() const { return build_seconds_; }
  /// Memory that Embree uses after building, without positions, indices and opacities.
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

// Traces batches of rays with Embree: single rays or packets, with each alpha and build quality.
// In: an EmbreeScene and rays. Out: transmittances, or closest hits.
#pragma once

#include <string>
#include <vector>

#include "rivals/embree/alpha_filter.hpp"
#include "rivals/embree/embree_scene.hpp"
#include "rivals/embree/ray_batch.hpp"

namespace dapple::bench {

/// A scene at both build qualities. High quality has spatial splits.
struct EmbreeScenes {
  explicit EmbreeScenes(const EmbreeGeometry& geometry)
      : medium(geometry, RTC_BUILD_QUALITY_MEDIUM), high(geometry, RTC_BUILD_QUALITY_HIGH) {}
  EmbreeScene medium, high;
};

/// One way to trace.
struct EmbreeMethod {
  Alpha alpha = Alpha::stochastic;
  int width = 1;          ///< rays per call: 1, 8 or 16
  bool high = false;      ///< build quality
  bool coherent = false;  ///< packets traversed together instead of split into single rays

  /// For example "stochastic 8 coherent high".
  [[nodiscard]] std::string name() const;
  [[nodiscard]] const EmbreeScene& scene(const EmbreeScenes& scenes) const {
    return high ? scenes.high : scenes.medium;
  }
};

/// Rays of contestants end below this transmittance, which is far below all measured errors.
inline constexpr float kContestBlack = 1e-3f;
/// The same for the reference, whose bias is at most this.
inline constexpr float kReferenceBlack = 1e-5f;

/// Every combination of alpha, width and quality; with `coherent` also coherent packets. Scenes
/// with instances must not use these: Embree 3.13.5's rtcOccluded16 sometimes never returns from
/// them.
std::vector<EmbreeMethod> occlusion_methods(bool coherent);
/// The same for camera rays, which are always stochastic.
std::vector<EmbreeMethod> camera_methods(bool coherent);

/// Traces the rays of one thread.
class EmbreeTracer {
 public:
  EmbreeTracer(const EmbreeScenes& scenes, float black) : scenes_(scenes), black_(black) {}

  void occlusion(const EmbreeMethod& method, const RayBatch& rays, TransmittanceBatch& found);
  /// The closest surface that stops each ray. A surface of opacity a stops it with probability a.
  void intersection(const EmbreeMethod& method, const RayBatch& rays, HitBatch& found);

 private:
  AlphaContext context(const EmbreeMethod& method, const RayBatch& rays, float* transmittance);

  const EmbreeScenes& scenes_;
  float black_;
  HitTriangles hit_[kMaxLanes];
};

/// While an object of this class exists, its thread treats denormal numbers as zero, as Embree
/// recommends.
class FlushDenormals {
 public:
  FlushDenormals();
  ~FlushDenormals();
  FlushDenormals(const FlushDenormals&) = delete;
  FlushDenormals& operator=(const FlushDenormals&) = delete;

 private:
  unsigned before_ = 0;
};

}  // namespace dapple::bench

// Tracing batches of rays through an EmbreeScene, in the ways that Embree offers.
#pragma once

#include <string>
#include <vector>

#include "rivals/alpha_filter.hpp"
#include "rivals/embree_scene.hpp"
#include "rivals/ray_batch.hpp"

namespace dapple::bench {

/// Both build qualities of a scene. HIGH has spatial splits.
struct EmbreeScenes {
  explicit EmbreeScenes(const EmbreeGeometry& geometry)
      : medium(geometry, RTC_BUILD_QUALITY_MEDIUM), high(geometry, RTC_BUILD_QUALITY_HIGH) {}
  EmbreeScene medium, high;
};

/// One way to trace.
struct EmbreeMethod {
  Alpha alpha = Alpha::stochastic;
  int width = 1;          ///< rays a call: 1, 8 or 16
  bool high = false;      ///< build quality
  bool coherent = false;  ///< packets traversed together instead of split into single rays

  /// "stochastic 8 coherent high"
  [[nodiscard]] std::string name() const;
  [[nodiscard]] const EmbreeScene& scene(const EmbreeScenes& scenes) const {
    return high ? scenes.high : scenes.medium;
  }
};

/// Below this transmittance contestants' rays count as black, far under any error measured.
inline constexpr float kContestBlack = 1e-3f;
/// The reference's: its bias is no more than this.
inline constexpr float kReferenceBlack = 1e-5f;

/// Every alpha, width and quality; also coherent packets where `coherent`. Not at instances: there
/// Embree 3.13.5's rtcOccluded16 does not always come back from coherent rays.
std::vector<EmbreeMethod> occlusion_methods(bool coherent);
/// The same of camera rays, which are stochastic.
std::vector<EmbreeMethod> camera_methods(bool coherent);

/// What one thread needs to trace.
class EmbreeTracer {
 public:
  EmbreeTracer(const EmbreeScenes& scenes, float black) : scenes_(scenes), black_(black) {}

  void occlusion(const EmbreeMethod& method, const RayBatch& rays, TransmittanceBatch& found);
  /// Nearest surface that stops each ray, one of opacity a with probability a.
  void intersection(const EmbreeMethod& method, const RayBatch& rays, HitBatch& found);

 private:
  AlphaContext context(const EmbreeMethod& method, const RayBatch& rays, float* transmittance);

  const EmbreeScenes& scenes_;
  float black_;
  MetTriangles met_[kMaxLanes];
};

/// Denormals count as zero on this thread while it lives, as Embree advises.
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

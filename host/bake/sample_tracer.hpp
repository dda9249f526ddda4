// AO and bent normals of samples. In: samples of a mesh and the matrices of its placements. Out: a
// value for each sample and side. What traces the rays is a function, so that others than dapple
// can be compared.
#pragma once

#include <functional>
#include <span>
#include <vector>

#include "bake/surface_samples.hpp"
#include "render/point_occlusion.hpp"

namespace dapple {

/// AO, and the sum of unoccluded directions if asked for, at points with unit normals.
using TracePoints =
    std::function<PointOcclusion(std::span<const V3f> positions, std::span<const V3f> normals,
                                 const OcclusionOptions& options, bool bent)>;

/// AO and the sum of unoccluded directions, in object space, seen from one side of a sample.
struct SideValue {
  float ao = 0;
  V3f bent{0, 0, 0};
};

/// Placements of a mesh: their matrices and the inverses.
struct Placements {
  std::vector<M44f> to_world, to_object;
  void add(const M44f& matrix);
};

/// Values of samples; zero for sides that are not traced.
struct TracedSamples {
  std::vector<SideValue> front, back;
};

class SampleTracer {
 public:
  SampleTracer(TracePoints trace, const BakeOptions& options, BakeStatistics& statistics)
      : trace_(std::move(trace)), options_(options), statistics_(statistics) {}

  /// `placement`: of each sample, index into `placements`. `rays`: of each sample and side. `hash`:
  /// random bits that differ between calls.
  TracedSamples trace(std::span<const SurfaceSample> samples,
                      std::span<const std::uint32_t> placement, const Placements& placements,
                      int rays, std::uint32_t hash);

 private:
  std::vector<SideValue> trace_side(std::span<const SurfaceSample> samples,
                                    std::span<const std::uint32_t> placement,
                                    const Placements& placements, int rays, std::uint32_t hash,
                                    bool back);

  TracePoints trace_;
  const BakeOptions& options_;
  BakeStatistics& statistics_;
};

}  // namespace dapple

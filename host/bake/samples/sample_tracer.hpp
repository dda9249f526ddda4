// Traces samples: AO with bent normals, or lights. In: samples of a mesh, and the matrices of its
// placements. Out: a value for each sample and side. The rays are traced by a function that the
// caller gives, so that other ray tracers can be compared.
#pragma once

#include <functional>
#include <span>
#include <vector>

#include "bake/samples/surface_samples.hpp"
#include "render/queries/point_occlusion.hpp"

namespace dapple {

/// AO, and the sum of unoccluded directions if requested, at points with unit normals.
using TracePoints = std::function<PointOcclusion(const QueryPoints& points,
                                                 const OcclusionOptions& options, bool bent)>;

/// What is seen from one side of a sample.
struct SideValue {
  float scalar = 0;   ///< AO; of lights the brightness of all of them together
  V3f bent{0, 0, 0};  ///< sum of unoccluded directions, in object space
};

/// Placements of a mesh: their matrices and the inverses.
struct Placements {
  std::vector<M44f> to_world, to_object;
  void add(const M44f& matrix);
};

/// Values of samples; zero for sides that are not traced.
struct TracedSamples {
  std::vector<SideValue> front, back;
  /// Irradiance by each light, those of a sample one after the other; empty for AO.
  std::vector<V3f> front_light, back_light;
  /// 1 for samples inside closed geometry, which do not count; empty: there are none.
  std::vector<std::uint8_t> inside;
  float largest = 1;  ///< scalar of a sample that nothing occludes, at most
  std::uint64_t points = 0, rays = 0;
  [[nodiscard]] bool is_inside(std::size_t sample) const {
    return !inside.empty() && inside[sample] != 0;
  }
};

/// Traces samples. `placement`: of each sample, index into `placements`. `rays`: of each sample and
/// side. `hash`: random bits that differ between calls.
using TraceSamples = std::function<TracedSamples(
    std::span<const SurfaceSample> samples, std::span<const std::uint32_t> placement,
    const Placements& placements, int rays, std::uint32_t hash)>;

/// The samples of which one side is traced, as points of the world.
class WorldPoints {
 public:
  /// `back`: which side.
  WorldPoints(std::span<const SurfaceSample> samples, std::span<const std::uint32_t> placement,
              const Placements& placements, bool back);
  std::vector<std::uint32_t> sample;
  [[nodiscard]] QueryPoints query() const {
    return {positions_, normals_, geometric_, shifts_, has_planes_, reaches_};
  }

 private:
  std::vector<V3f> positions_, normals_;
  std::vector<V3f> geometric_, shifts_;  ///< empty: all samples are flat
  std::vector<V3f> reaches_;
  bool has_planes_ = true;
};

/// AO and, with bake.bent, bent normals. `bake` must outlive the function.
TraceSamples ao_tracer(TracePoints trace, const BakeOptions& bake);

}  // namespace dapple

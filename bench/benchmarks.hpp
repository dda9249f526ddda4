// What is measured of a scene; each function registers benchmarks named KIND/scene that
// live as long as `scene` does.
#pragma once

#include "bench_scene.hpp"

namespace dapple::bench {

/// Occlusion/exact and Occlusion/prefiltered: the occlusion kernel on AO rays.
void register_occlusion(BenchScene& scene);
/// ClosestHit: the camera pass's traversal.
void register_closest_hit(BenchScene& scene);
/// Build: all of build_bvh(). Prefilter: the part of it that makes opacities.
void register_build(BenchScene& scene);

}  // namespace dapple::bench

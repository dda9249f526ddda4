// Protocol "bake": AO at the vertices of a model, as `dapple bake` computes it. In: a scene. Out:
// contestants that bake the same vertices with the same rounds of samples, but trace the rays with
// different programs.
#pragma once

#include "rivals/contest.hpp"
#include "rivals/protocols/baked_parts.hpp"
#include "rivals/rival_scene.hpp"

namespace dapple::bench {

/// AO at the compared vertices by Embree with `rays` rays for each triangle and side, as two
/// independent halves.
Truth bake_truth(const RivalScene& scene, const std::vector<BakedPart>& parts, int rays);

/// The same by dapple's exact estimator, not in halves.
std::vector<double> bake_exactly(const RivalScene& scene, const std::vector<BakedPart>& parts,
                                 int rays);

/// Embree's `methods`, with as many rays for every triangle and with the samples that dapple would
/// take, and dapple's exact and prefiltered. With effort e a side of a triangle has 8 e rays, or a
/// value the standard error 0.32 / sqrt(e).
std::vector<Contestant> bake_contestants(const RivalScene& scene,
                                         const std::vector<BakedPart>& parts,
                                         const std::vector<EmbreeMethod>& methods);

}  // namespace dapple::bench

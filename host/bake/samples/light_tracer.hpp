// Irradiance of lights at samples of a mesh. In: a scene on the device with its lights. Out: a
// function that traces samples.
#pragma once

#include "bake/occluder_scene.hpp"
#include "bake/samples/sample_tracer.hpp"

namespace dapple {

/// The irradiance of each of the scene's lights, linear RGB, and of all together the brightness
/// (mean of R, G and B). `bake` and `occluders` must outlive the function.
TraceSamples light_tracer(const BakeOptions& bake, const OccluderScene& occluders);

}  // namespace dapple

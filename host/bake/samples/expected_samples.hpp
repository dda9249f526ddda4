// How many samples a bake takes, before it is known: for the first guess of the time left.
#pragma once

#include "dapple/bake.hpp"

namespace dapple {

/// Of all that `options` ask for; those of lights count, too.
double expected_samples(const Scene& scene, const BakeOptions& options);

}  // namespace dapple

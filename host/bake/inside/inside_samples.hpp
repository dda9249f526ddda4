// Samples that lie inside closed geometry, such as those of a floor below a box. In: a tracer of
// samples. Out: a tracer that also tells which of them do not count.
#pragma once

#include "bake/inside/closed_geometry.hpp"
#include "bake/samples/sample_tracer.hpp"

namespace dapple {

/// `trace`, and TracedSamples::inside: 1 for each sample of which all traced sides are inside. Only
/// samples that see little are tested. `closed` must outlive the function.
TraceSamples telling_inside(TraceSamples trace, ClosedGeometry& closed);

}  // namespace dapple

// The colour space of an EXR file. In: its header. Out: a matrix to the primaries and the white of
// ITU-R BT.709, in which dapple computes.
#pragma once

#include <ImathMatrix.h>
#include <ImfForward.h>

namespace dapple {

/// For row vectors (r, g, b) of linear light. The identity without the attribute `chromaticities`.
/// Another white is adapted by the Bradford method (Lam 1985), so that grey stays grey. A matrix
/// that is not finite: the primaries lie on a line.
Imath::M33f to_bt709(const Imf::Header& header);

/// Whether the attribute `envmap` says that the image shows the six sides of a cube.
bool is_cube_map(const Imf::Header& header);

}  // namespace dapple

// A picture of a baked scene in flat shades of grey: its AO and nothing else. In: a scene, what was
// baked and a camera. Out: pixels.
#pragma once

#include "dapple/bake.hpp"
#include "film/preview/png.hpp"

namespace dapple {

/// Draws the scene's triangles with the AO of their vertices, texels or instances, whichever
/// `result` has, as sRGB grey on a dark background. Cut-outs are tested at half opacity; triangles
/// that reach behind the camera are clipped.
ByteImage draw_preview(const Scene& scene, const BakeResult& result, const Camera& camera,
                       int width, int height);

}  // namespace dapple

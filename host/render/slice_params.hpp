// What the passes of a picture's slices are given, but for the slice itself. In: view, options and
// the layout of the film. Out: the size of a slice, and parameters.
#pragma once

#include "camera/view.hpp"
#include "dapple/device.hpp"
#include "dapple/options.hpp"
#include "dapple/shared/pass_params.h"
#include "film/sums/film_sums.hpp"

namespace dapple {

/// Samples of a slice, at most kMaxSliceSamples. `lights`: number of light passes.
/// `rays_in_flight`: rays of a sample that are traced together. `pixels`: of the picture.
std::uint32_t samples_of_slice(const DeviceInfo& device, const RenderOptions& options,
                               std::size_t lights, std::size_t rays_in_flight, std::size_t pixels);

/// Without `slice` and what differs from pass to pass.
ResolveParams resolve_params(const View& view, const FilmLayout& layout, uint splitting_bits);

/// Of so many samples one has its back traced, a power of two: RenderOptions::back_every, or as
/// many as every pixel has.
unsigned back_group(const RenderOptions& options);

/// Without resolve.slice. `resolve`: resolve_params(). `options`: by_sample().
BackParams back_params(const View& view, const RenderOptions& options, const FilmLayout& layout,
                       const ResolveParams& resolve);

}  // namespace dapple

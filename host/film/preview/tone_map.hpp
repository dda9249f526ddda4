// A picture for the eye from linear light: exposure, tone mapping, background. In: a film. Out:
// linear values of a display, [0,1].
#pragma once

#include "dapple/film.hpp"

namespace dapple {

/// The factor that scales RGBA to a medium brightness. The mean luminance of what is seen, in the
/// middle above all, becomes 0.35 sqrt(2 albedo), halfway (in stops) between what makes every
/// subject a middle grey and what shows it as dark as it is; but at most a hundredth of it is
/// brighter than white. 1 where nothing is seen.
float automatic_exposure(const Film& film);

/// Compresses what is brighter than 0.76, and takes its saturation away, so that highlights become
/// white at last; darker colours stay as they are. After Khronos's PBR Neutral tone mapper (2024),
/// without its allowance for reflections.
V3f tone_mapped(V3f color);

/// The colour of a sky above a grey plain, linear; `elevation` is the sine of the angle above the
/// horizon, [-1,1].
V3f backdrop_color(float elevation);

}  // namespace dapple

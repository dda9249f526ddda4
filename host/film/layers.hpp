// The layers of an EXR file: their names, channels and values. To add or rename one, change
// develop() and docs/layers.md; for its preview tone_of() in png.cpp; whether it is a colour and
// may be half, exr_parts.cpp; for its memory the counts in film_memory.cpp. Groups of lights are
// named in light_layers.cpp, Cryptomattes in cryptomatte.cpp. In: sums and sample counts. Out:
// named planes and statistics.
#pragma once

#include <vector>

#include "dapple/film.hpp"
#include "dapple/render.hpp"

namespace dapple {

struct FilmLayout;
struct TracedPicture;

/// A name for each light, all different: the part of its layers' names after "light.". Defined in
/// light_layers.cpp.
std::vector<std::string> light_names(const std::vector<Light>& lights);

/// Makes the film's planes from the means of the sums; docs/layers.md lists their channels. Stores
/// the numbers of rays, visits and tests, and the errors, in `statistics`.
std::vector<Plane> develop(const TracedPicture& picture, const FilmLayout& layout,
                           const RenderOptions& options, const std::vector<Light>& lights,
                           RenderStatistics& statistics);

}  // namespace dapple

// What the arguments of `dapple render` mean, and which do not go together. In: the arguments as
// typed. Out: RenderOptions, the format of the EXR, and the times of frames and shutters.
#pragma once

#include <string>

#include "commands/render/render_arguments.hpp"
#include "dapple/film.hpp"
#include "dapple/options.hpp"

namespace dapple {

/// Throws Error usage if options of the PNG are wrong, or there is none that they are for.
void check_png(const RenderArguments& arguments);

/// Whether the file is a part, FILE.dapple, and not an image.
bool is_part_path(const std::string& path);

double frames_per_second(const RenderArguments& arguments);

/// Moments of the open shutter: 1 without --shutter.
int shutter_times(const RenderArguments& arguments);

/// The k-th moment of a frame at `seconds`: the middle of the k-th part of the shutter interval.
double shutter_seconds(const RenderArguments& arguments, double seconds, int k);

/// Both throw Error usage naming the option.
RenderOptions to_options(const RenderArguments& arguments);
ExrFormat to_format(const RenderArguments& arguments);

}  // namespace dapple

// The frames of a render: one, or those of a sequence, each with its time and its files.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "commands/render_arguments.hpp"

namespace dapple {

struct Frame {
  std::optional<double> seconds;  ///< none: at rest
  std::string title;              ///< "frame 3 of 24"; empty outside of a sequence
  std::string output, png, visits_png, stats_json;  ///< empty: not written
};

/// Throws Error usage for files of a sequence whose names have no place for the number, and for
/// checkpoints of one.
std::vector<Frame> list_frames(const RenderArguments& arguments);

/// Before anything is read, so that a picture is never lost for want of a place, nor a file
/// that is to be read. Throws Error usage.
void check_files(const std::vector<Frame>& frames, const RenderArguments& arguments);

/// The same for the files that a scene turned out to be made of.
void check_files_spare(const std::vector<Frame>& frames, const RenderArguments& arguments,
                       const std::vector<std::string>& inputs);

}  // namespace dapple

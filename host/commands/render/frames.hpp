// The frames of a render: one, or those of a sequence, each with its time and its files.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "commands/render/render_arguments.hpp"

namespace dapple {

struct Frame {
  std::optional<double> seconds;  ///< none: at rest
  std::int64_t number = 0;        ///< of a sequence
  std::string title;              ///< "frame 3 of 24"; empty outside of a sequence
  std::string output, png, visits_png, deep, stats_json;  ///< empty: not written
};

/// Throws Error usage if a sequence's file names have no run of # for the number, and for
/// checkpoints of a sequence.
std::vector<Frame> list_frames(const RenderArguments& arguments);

/// Path of the heat map beside a preview: tree_visits.png for tree.png.
std::string visits_path(const std::string& png);

/// Checks, before anything is read, that every output can be written and that none is an input.
/// Throws Error usage.
void check_files(const std::vector<Frame>& frames, const RenderArguments& arguments);

/// The same for `inputs`, the files that the scene consists of.
void check_files_spare(const std::vector<Frame>& frames, const RenderArguments& arguments,
                       const std::vector<std::string>& inputs);

}  // namespace dapple

// The files that a command is about to write: each can be written, and none is a file that the
// command reads or writes as well, by whatever name or link.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace dapple {

/// A file to be written, and the option that names it.
struct OutputPath {
  std::string flag;
  std::string path;
};

/// Whether a path names a file for each frame: its file name has a run of '#'.
bool has_frame_digits(const std::string& path);

/// "out.####.exr" as "out.0007.exr": the last run of '#' is the frame's number in at least as many
/// digits.
std::string frame_path(const std::string& pattern, std::int64_t number);

/// Throws Error usage, naming the flag, for a path that cannot be written (not a regular file,
/// read-only, in a folder that is missing) and for two outputs that are one file.
void check_outputs(const std::vector<OutputPath>& outputs);

/// Throws Error usage, naming the flag, when an output is one of `inputs`.
void check_outputs_spare(const std::vector<OutputPath>& outputs,
                         const std::vector<std::string>& inputs);

}  // namespace dapple

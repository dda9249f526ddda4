// Checks the output files of a command before it runs: each can be written, and none is also an
// input or another output, by any name or link.
#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <utility>
#include <vector>

namespace dapple {

/// An output file and the option that names it.
struct OutputPath {
  std::string flag;
  std::string path;
};

/// Whether the file name has a run of '#' for the frame number.
bool has_frame_digits(const std::string& path);

/// "out.####.exr" becomes "out.0007.exr": the last run of '#' is replaced by the frame's number, in
/// at least as many digits.
std::string frame_path(const std::string& pattern, std::int64_t number);

/// Throws Error usage, naming the flag, for a path that cannot be written (not a regular file,
/// read-only, in a folder that is missing) and for two outputs that are one file.
/// Folders::tidy: also removes what runs that were killed left in the outputs' folders.
enum class Folders { tidy, leave };
void check_outputs(const std::vector<OutputPath>& outputs, Folders folders = Folders::tidy);

/// Files that are read: also by other names, as through links.
class InputFiles {
 public:
  explicit InputFiles(const std::vector<std::string>& paths);
  /// The file of the list that this path names; null: none.
  [[nodiscard]] const std::string* same_as(const std::string& path) const;

 private:
  std::map<std::pair<std::uint64_t, std::uint64_t>, std::string> paths_;  ///< by device and inode
  std::map<std::string, std::string> missing_;                            ///< by whole path
};

/// Throws Error usage, naming the flag, when an output is one of `inputs`.
void check_spares(const OutputPath& output, const InputFiles& inputs);
void check_outputs_spare(const std::vector<OutputPath>& outputs,
                         const std::vector<std::string>& inputs);

}  // namespace dapple

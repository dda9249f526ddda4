// Checks the files beside a .gltf before they are made: copies of buffers and images, and new ones.
// In: from where to where. Out: an error for one that cannot be made, or would replace another
// file.
#pragma once

#include <string>
#include <utility>
#include <vector>

namespace dapple {

/// Throws Error usage, naming --output, for a copy over a file with other content that an earlier
/// output of that name does not have as its own, where a file is in the way of a folder, or a
/// folder in the way of a file, and where nothing can be written.
void check_side_copies(const std::string& output,
                       const std::vector<std::pair<std::string, std::string>>& copies);

/// The same for new files beside the output: other files than those that an earlier bake wrote
/// there are not replaced, whatever they hold.
void check_new_sides(const std::string& output, const std::vector<std::string>& paths);

}  // namespace dapple

// Checks the copies of buffers and images beside a .gltf before they are made. In: from where to
// where. Out: an error for a copy that cannot be made, or that would replace another file.
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

}  // namespace dapple

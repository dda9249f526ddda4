// What made a tree: two builders that say the same make the same bits of the same mesh.
#pragma once

#include <string_view>

namespace dapple {

/// A checksum over this folder's sources, the layouts that it fills and the compiler with its
/// flags, so that no one has to remember to count a version up.
std::string_view builder_version();

}  // namespace dapple

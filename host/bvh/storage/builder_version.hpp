// The version of the BVH builder: builders with the same version make the same bits from the same
// mesh.
#pragma once

#include <string_view>

namespace dapple {

/// A checksum over the sources of host/bvh, the layouts that it fills, and the compiler with its
/// flags. So nobody has to increase a version number.
std::string_view builder_version();

}  // namespace dapple

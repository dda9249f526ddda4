// The builder's name where its sources are compiled for fuzzing.
#include "bvh/builder_version.hpp"

namespace dapple {
std::string_view builder_version() { return "fuzz"; }
}  // namespace dapple

# Writes a C++ file that defines dapple::builder_version(): a checksum of the files in SOURCES,
# which make BVHs, and of COMPILER. Trees that another builder cached are told by it.
set(all "${COMPILER}")
foreach(source IN LISTS SOURCES)
  file(SHA256 ${source} checksum)
  string(APPEND all " ${checksum}")
endforeach()
string(SHA256 all "${all}")
file(WRITE ${OUTPUT} "// Generated from host/bvh/ by cmake/builder_version.cmake.
#include \"bvh/storage/builder_version.hpp\"

namespace dapple {
std::string_view builder_version() { return \"${all}\"; }
}  // namespace dapple
")

// The one place where tinygltf's implementation is compiled, against the system's JSON
// library.
#include <fstream>  // its writers need it even without a file system
#include <nlohmann/json.hpp>

#define TINYGLTF_IMPLEMENTATION
#include "scene/gltf/tinygltf.hpp"

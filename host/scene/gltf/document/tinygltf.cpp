// Compiles tinygltf's implementation, once for the whole program, with the system's JSON library.
#include <fstream>  // tinygltf's writers need it even without a file system
#include <nlohmann/json.hpp>

#define TINYGLTF_IMPLEMENTATION
#include "scene/gltf/document/tinygltf.hpp"

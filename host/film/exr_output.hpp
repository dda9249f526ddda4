// How the program, whose process it is, has EXR files written.
#pragma once

#include <string>

#include "dapple/film.hpp"
#include "files/output_file.hpp"

namespace dapple {

/// Threads that OpenEXR may use besides the caller's, in the whole process; 0, the default: none.
/// For programs, not for libraries in somebody else's. Files are the same whatever the number.
void use_exr_threads(int count);

/// write_exr(), which is durable. An interrupted render does not wait for a slow disk.
void write_exr(const Film& film, const std::string& path, Durable durable);

}  // namespace dapple

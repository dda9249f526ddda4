// Writes EXR files for dapple's own program: with a choice of durability, and of the number of
// OpenEXR's threads. In: a film, a format, and whether to wait for the disk. Out: an EXR file.
#pragma once

#include <string>

#include "dapple/film.hpp"
#include "files/output_file.hpp"

namespace dapple {

/// Sets how many threads OpenEXR may use besides the caller's, in the whole process; 0 by default.
/// Programs may call this; a library must not change the process of others. The number does not
/// change the files.
void use_exr_threads(int count);

/// As write_exr() in film.hpp, which waits until the disk has the file, and verifies it by reading
/// it back (Durable::yes). An interrupted render must end soon and uses Durable::no, which does
/// neither.
void write_exr(const Film& film, const std::string& path, const ExrFormat& format, Durable durable);

/// The same for a file that gets its name later. Throws Error usage or failed.
void write_exr(const Film& film, PendingFile& file, const ExrFormat& format, Durable durable);

/// The metadata of a file that write_exr() wrote, without reading its pixels. Throws Error input.
FilmMetadata read_exr_metadata(const std::string& path);

}  // namespace dapple

// The check of a film that every writer of films makes before it encodes anything. In: a film. Out:
// its defect, in words.
#pragma once

#include <string>

#include "dapple/film.hpp"

namespace dapple {

/// Why `film` cannot be written (a plane of the wrong size, a channel named twice, ...);
/// empty when it can.
std::string film_defect(const Film& film);

}  // namespace dapple

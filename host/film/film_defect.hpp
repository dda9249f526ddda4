// What every writer of films asks first.
#pragma once

#include <string>

#include "dapple/film.hpp"

namespace dapple {

/// Why `film` cannot be written (a plane of the wrong size, a channel named twice, ...);
/// empty when it can.
std::string film_defect(const Film& film);

}  // namespace dapple

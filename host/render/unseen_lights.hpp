// Notes about lights that a picture does not show. In: a film and its lights; out: lines for the
// user.
#pragma once

#include <string>
#include <vector>

#include "dapple/film.hpp"
#include "dapple/scene.hpp"

namespace dapple {

/// One note for each layer of lights that are not dark and reach nothing that is seen.
std::vector<std::string> notes_of_unseen_lights(const Film& film, const std::vector<Light>& lights);

}  // namespace dapple

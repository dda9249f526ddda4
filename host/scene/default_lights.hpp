// What a user is told of the lights that a scene without its own gets: daylight() of scene.hpp.
#pragma once

#include <string>

namespace dapple {

/// `on_ground`: --ground was given, so that plants do not stand on nothing.
std::string default_light_note(bool on_ground);

}  // namespace dapple

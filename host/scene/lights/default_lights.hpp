// What a user is told of the lights that a scene without its own gets: daylight() of scene.hpp.
#pragma once

#include <string>

namespace dapple {

/// `on_ground`: the scene has the default ground; else the note tells how to get it.
std::string default_light_note(bool on_ground);

}  // namespace dapple

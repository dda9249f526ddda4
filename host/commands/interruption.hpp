// Handles SIGINT, SIGTERM and SIGXCPU (ulimit -t): a render that has results finishes its slice and
// saves them; otherwise the process ends at once. Only this file sets signal handlers.
#pragma once

#include <string>

#include "dapple/render.hpp"

namespace dapple {

/// Installs the handlers. The signals end the process with exit code 128 + signal (130, 143, 152):
/// at once until the function of save_when_interrupted() is called for the second time. Ignored
/// signals stay ignored.
void catch_interruptions();

/// Returns a function for RenderControl that tells whether a signal came. After its second call
/// only a second SIGINT ends the process at once, and a signal that it does not notice for long: a
/// driver hangs. That is twenty seconds.
Stop save_when_interrupted();

/// For a render that writes checkpoints, so that little is lost: a slice ends two seconds after
/// SIGTERM or SIGXCPU, if it has not before. Returns a function that is to be called after each
/// slice, and calls `progress`.
Progress end_hanging_slices_early(Progress progress);

/// The file is removed if a signal ends the process at once. Empty: none. Longer paths than 4,095
/// bytes are not remembered.
void remove_when_interrupted(const std::string& path);

/// Whether SIGTERM or SIGXCPU came so long ago that little should be done but what is not done yet
/// of saving: process managers kill what does not end soon. Nobody waits for SIGINT but a person.
bool is_late();

/// The exit code for the signal that came, or 0.
int interruption_code();

}  // namespace dapple

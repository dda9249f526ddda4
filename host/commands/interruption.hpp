// Handles SIGINT, SIGTERM, SIGHUP and SIGXCPU (ulimit -t): a render that has results finishes its
// slice and saves them; otherwise the process ends at once. Only this file sets signal handlers.
#pragma once

#include <string>

#include "dapple/render.hpp"

namespace dapple {

/// Installs the handlers. The signals end the process with exit code 128 + signal (129 to 152):
/// at once until the function of save_when_interrupted() is called for the second time. Ignored
/// signals stay ignored.
void catch_interruptions();

/// Returns a function for RenderControl that tells whether a signal came. After its second call
/// only a second SIGINT ends the process at once. A signal that the function has not noticed after
/// twenty seconds ends it too: a driver hangs.
Stop save_when_interrupted();

/// For a render or bake that writes checkpoints to `path`, so that little is lost: the process is
/// gone within two seconds of SIGTERM or SIGXCPU where a slice does not end, or where there is a
/// checkpoint of this run, or of the file `resumed`, and the next is not written. Returns a
/// function to be called after each slice, and again where another slice does not follow the
/// question whether to stop, with the fraction done; it calls `progress`.
Progress end_early(const std::string& path, const std::string& resumed, Progress progress);

/// For RenderControl::warn.
void warn_of_checkpoint(const std::string& reason);

/// All slices of a picture or bake are traced: until the next question whether to stop, a signal no
/// longer ends the process after twenty seconds, since writing what is finished may take longer.
void slices_are_traced();

/// The file or empty folder is removed if a signal ends the process at once. Empty: none. Longer
/// paths than 4,095 bytes are not remembered.
void remove_when_interrupted(const std::string& path);

/// Called once an interrupted render is saved: whether more than 0.8 s have passed since SIGTERM or
/// SIGXCPU. Then the picture should be skipped, because process managers kill programs that do not
/// end soon. Always false after SIGINT, which a person sends.
bool is_late();

/// The exit code for the signal that came, or 0.
int interruption_code();

}  // namespace dapple

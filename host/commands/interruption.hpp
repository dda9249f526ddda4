// SIGINT and SIGTERM: a render that has something to save finishes its slice and saves it, any
// other ends at once. The process's signal handlers are set here and nowhere else.
#pragma once

#include "dapple/render.hpp"

namespace dapple {

/// From now on both signals end the process with 128 + signal: 130, 143; at once until
/// save_when_interrupted() is first asked. Signals that are ignored stay so.
void catch_interruptions();

/// For RenderControl: whether a signal came. Once asked there is something to save, and only a
/// second SIGINT ends the process at once.
Stop save_when_interrupted();

/// Exit code of the signal that came, 0 if none.
int interruption_code();

}  // namespace dapple

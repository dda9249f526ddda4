// What OpenCL drivers need of the process: files, stacks, a linker. Without them they abort or
// report no device. Out: an Error that names what is missing.
#pragma once

namespace dapple {

/// Throws Error failed where drivers may open too few files, or have too small stacks, to start.
void check_process_limits();

/// PoCL links each kernel with `ld`. Throws Error device if no folder of PATH has it.
void require_linker();

}  // namespace dapple

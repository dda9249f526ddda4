// dapple-bench rivals: Embree and dapple side by side, in one run, on the same camera, points,
// directions and threads.
#pragma once

namespace dapple::bench {

/// argv[0] is the subcommand. Returns the exit code; throws Error.
int run_rivals(int argc, char** argv);

}  // namespace dapple::bench

// dapple-bench rivals: measures Embree and dapple in one run, with the same camera, points,
// directions and number of threads. In: scenes and protocols. Out: tables, JSON and plots.
#pragma once

namespace dapple::bench {

/// argv[0] is the subcommand. Returns the exit code; throws Error.
int run_rivals(int argc, char** argv);

}  // namespace dapple::bench

// dapple-bench accuracy: measures the errors of prefiltered occlusion. In: a scene. Out: tables,
// JSON and plots of the errors of nodes and of pictures.
#pragma once

namespace dapple::bench {

/// argv[0] is the subcommand. Returns the exit code; throws Error.
int run_accuracy(int argc, char** argv);

}  // namespace dapple::bench

// dapple-bench accuracy: how far prefiltered occlusion is from exact, node by node and
// picture by picture.
#pragma once

namespace dapple::bench {

/// argv[0] is the subcommand. Returns the exit code; throws Error.
int run_accuracy(int argc, char** argv);

}  // namespace dapple::bench

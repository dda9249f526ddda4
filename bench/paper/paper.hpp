// dapple-bench paper: repeats the experiment of Lacewell, Burley, Boulos and Shirley, "Raytracing
// Prefiltered Occlusion for Aggregate Geometry", 2008.
#pragma once

namespace dapple::bench {

/// argv[0] is the subcommand. Returns the exit code; throws Error.
int run_paper(int argc, char** argv);

}  // namespace dapple::bench

// Chooses a footprint with which the bias of single values is not much beside their standard
// errors. Their correction takes out the mean bias, but some points lie under leaves, others under
// a roof. In: some values, exact and with any footprint. Out: a footprint scale.
#pragma once

#include "sampling/footprint_choice.hpp"

namespace dapple {

/// The largest of `footprint`, a half of it, a quarter, ... a sixteenth and 0 (exact rays) with
/// which the RMSE over tiles of no quantity is clearly larger than the standard error of values of
/// `rays` rays.
FootprintChoice choose_local_footprint(BiasSource& source, float footprint, int rays);

}  // namespace dapple

// A comparison as one HTML file that needs nothing else: pictures and heat maps inside, A and
// B under a line that moves, the figures as a table, light and dark.
#pragma once

#include <string>

#include "compare/difference.hpp"

namespace dapple {

struct PageOptions {
  double scale = 10.0;  ///< of the heat maps, see hottest_difference
  std::string failure;  ///< see failure(); empty: passed
};

/// `pairs` are the layers of `comparison`, in its order; both are of `a` and `b`. A and B are
/// shown with B's tone, so that equal shades are equal values. Throws Error failed when a
/// picture is too large.
std::string comparison_page(const Film& a, const Film& b, const std::vector<LayerPair>& pairs,
                            const Comparison& comparison, const PageOptions& options);

}  // namespace dapple

// A comparison as one HTML file without other files. In: two films and their Comparison. Out: a
// page with the pictures of both, separated by a line that the reader moves, heat maps, and the
// figures as a table, in light or dark colours.
#pragma once

#include <string>

#include "compare/difference.hpp"

namespace dapple {

struct PageOptions {
  double scale = 10.0;  ///< of the heat maps, see hottest_difference()
  std::string failure;  ///< see failure(); empty: passed
};

/// The text of the page. `pairs` are the layers of `comparison`, in its order; both were made of
/// `a` and `b`. A and B are shown with B's tone, so that equal shades mean equal values. Throws
/// Error failed when a picture is too large.
std::string comparison_page(const Film& a, const Film& b, const std::vector<LayerPair>& pairs,
                            const Comparison& comparison, const PageOptions& options);

}  // namespace dapple

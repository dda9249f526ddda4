// Plots as one small SVG file. In: lines of points with labels. Out: the text of the file, with
// logarithmic axes.
#pragma once

#include <string>
#include <vector>

namespace dapple::bench {

struct PlotPoint {
  double x, y;        ///< points are only drawn if both are positive
  std::string label;  ///< drawn next to the point; may be empty
};

struct PlotLine {
  std::string name;
  std::vector<PlotPoint> points;
  bool dashed = false;
  int color = 0;  ///< index into the plot's palette
};

struct Plot {
  std::string title, x_name, y_name;
  std::vector<PlotLine> lines;
  bool decimal_x = false;  ///< ticks at 1, 2, 5, 10... instead of powers of two
};

/// The text of the SVG file. An empty plot has only its title and axes.
std::string svg_text(const Plot& plot);
/// The same for several plots, one below the other.
std::string svg_text(const std::vector<Plot>& plots);

}  // namespace dapple::bench

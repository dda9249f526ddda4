// A plot as one small SVG file: logarithmic axes, lines with points, texts at the points.
#pragma once

#include <string>
#include <vector>

namespace dapple::bench {

struct PlotPoint {
  double x, y;        ///< positive; others are left out
  std::string label;  ///< beside the point; may be empty
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

/// The SVG file's text; an empty plot still has its title.
std::string svg_text(const Plot& plot);
/// Plots one below the other.
std::string svg_text(const std::vector<Plot>& plots);

}  // namespace dapple::bench

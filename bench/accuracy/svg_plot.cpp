#include "accuracy/svg_plot.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace dapple::bench {
namespace {

constexpr double kWidth = 770, kHeight = 440;
constexpr double kLeft = 70, kRight = 240, kTop = 40, kBottom = 50;

/// Colours of Okabe and Ito, which colour-blind readers can distinguish.
constexpr const char* kPalette[] = {"#0072b2", "#d55e00", "#009e73",
                                    "#cc79a7", "#e69f00", "#56b4e9"};

const char* color_of(const PlotLine& line) {
  return kPalette[static_cast<std::size_t>(line.color) % std::size(kPalette)];
}

std::string escaped(const std::string& text) {
  std::string out;
  for (const char c : text) {
    switch (c) {
      case '&':
        out += "&amp;";
        break;
      case '<':
        out += "&lt;";
        break;
      case '>':
        out += "&gt;";
        break;
      default:
        out += c;
    }
  }
  return out;
}

/// A logarithmic axis: converts values to pixels.
class LogAxis {
 public:
  LogAxis(double first_pixel, double last_pixel) : first_(first_pixel), last_(last_pixel) {}
  void include(double value) {
    low_ = std::min(low_, std::log10(value));
    high_ = std::max(high_, std::log10(value));
  }
  /// Extends the axis to whole ticks. An axis without values becomes 0.1 to 1.
  void round_out(double ticks_a_decade) {
    if (low_ > high_) low_ = -1, high_ = 0;
    low_ = std::floor(low_ * ticks_a_decade) / ticks_a_decade;
    high_ = std::ceil(high_ * ticks_a_decade) / ticks_a_decade;
    if (high_ <= low_) high_ = low_ + 1 / ticks_a_decade;
  }
  [[nodiscard]] double pixel(double value) const {
    return first_ + (last_ - first_) * (std::log10(value) - low_) / (high_ - low_);
  }
  [[nodiscard]] bool shows(double value) const {
    const double at = std::log10(value);
    return at >= low_ - 1e-9 && at <= high_ + 1e-9;
  }

 private:
  double first_, last_;
  double low_ = 1e300, high_ = -1e300;
};

bool is_drawn(const PlotPoint& point) { return point.x > 0 && point.y > 0; }

std::string text_at(double x, double y, const std::string& anchor, const std::string& text) {
  return fmt::format("<text x=\"{:.1f}\" y=\"{:.1f}\" text-anchor=\"{}\">{}</text>\n", x, y, anchor,
                     escaped(text));
}

std::string grid_line(double x0, double y0, double x1, double y1) {
  return fmt::format(
      "<line x1=\"{:.1f}\" y1=\"{:.1f}\" x2=\"{:.1f}\" y2=\"{:.1f}\" stroke=\"#ddd\"/>\n", x0, y0,
      x1, y1);
}

class PlotWriter {
 public:
  explicit PlotWriter(const Plot& plot) : plot_(plot) {
    for (const PlotLine& line : plot.lines) {
      for (const PlotPoint& point : line.points) {
        if (!is_drawn(point)) continue;
        x_.include(point.x);
        y_.include(point.y);
      }
    }
    x_.round_out(plot.decimal_x ? 1 : 10);
    y_.round_out(1);
  }

  /// The content of the svg element for this plot, moved down by `top` pixels.
  std::string write(double top) {
    std::string out = fmt::format("<g transform=\"translate(0,{})\">\n", top);
    out += text_at(kLeft, 22, "start", plot_.title) + grid();
    double row = kTop + 10;
    for (const PlotLine& line : plot_.lines) {
      out += drawn(line) + legend(line, row);
      row += 18;
    }
    return out + "</g>\n";
  }

 private:
  std::string grid() const {
    std::string out;
    for (int power = -20; power <= 20; ++power) {
      if (!plot_.decimal_x) out += column(std::exp2(power));
      for (const double digit : {1.0, 2.0, 5.0}) {
        if (plot_.decimal_x) out += column(digit * std::pow(10.0, power));
        const double y = digit * std::pow(10.0, power);
        if (!y_.shows(y)) continue;
        out += grid_line(kLeft, y_.pixel(y), kWidth - kRight, y_.pixel(y)) +
               text_at(kLeft - 6, y_.pixel(y) + 4, "end", fmt::format("{:g}", y));
      }
    }
    return out + text_at(0.5 * (kLeft + kWidth - kRight), kHeight - 12, "middle", plot_.x_name) +
           text_at(12, kTop - 6, "start", plot_.y_name);
  }

  /// A vertical line of the grid with its number, or "" if x is outside of the axis.
  std::string column(double x) const {
    if (!x_.shows(x)) return "";
    return grid_line(x_.pixel(x), kTop, x_.pixel(x), kHeight - kBottom) +
           text_at(x_.pixel(x), kHeight - kBottom + 16, "middle", fmt::format("{:g}", x));
  }

  std::string drawn(const PlotLine& line) const {
    std::string path, marks;
    for (const PlotPoint& point : line.points) {
      if (!is_drawn(point)) continue;
      const double x = x_.pixel(point.x), y = y_.pixel(point.y);
      path += fmt::format("{}{:.1f},{:.1f}", path.empty() ? "" : " ", x, y);
      marks += fmt::format("<circle cx=\"{:.1f}\" cy=\"{:.1f}\" r=\"3\" fill=\"{}\"/>\n", x, y,
                           color_of(line));
      if (!point.label.empty()) marks += text_at(x + 5, y - 6, "start", point.label);
    }
    return fmt::format(
               "<polyline points=\"{}\" fill=\"none\" stroke=\"{}\" stroke-width=\"2\"{}/>\n", path,
               color_of(line), dashes(line)) +
           marks;
  }

  static std::string legend(const PlotLine& line, double row) {
    const double x = kWidth - kRight + 12;
    return fmt::format(
               "<line x1=\"{:.1f}\" y1=\"{:.1f}\" x2=\"{:.1f}\" y2=\"{:.1f}\" stroke=\"{}\" "
               "stroke-width=\"2\"{}/>\n",
               x, row - 4, x + 24, row - 4, color_of(line), dashes(line)) +
           text_at(x + 30, row, "start", line.name);
  }

  static const char* dashes(const PlotLine& line) {
    return line.dashed ? " stroke-dasharray=\"5 4\"" : "";
  }

  const Plot& plot_;
  LogAxis x_{kLeft, kWidth - kRight};
  LogAxis y_{kHeight - kBottom, kTop};
};

}  // namespace

std::string svg_text(const std::vector<Plot>& plots) {
  const double height = kHeight * static_cast<double>(std::max<std::size_t>(1, plots.size()));
  std::string out = fmt::format(
      "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{0}\" height=\"{1}\" "
      "viewBox=\"0 0 {0} {1}\" font-family=\"sans-serif\" font-size=\"11\">\n"
      "<rect width=\"{0}\" height=\"{1}\" fill=\"#fff\"/>\n",
      kWidth, height);
  double top = 0;
  for (const Plot& plot : plots) {
    out += PlotWriter(plot).write(top);
    top += kHeight;
  }
  return out + "</svg>\n";
}

std::string svg_text(const Plot& plot) { return svg_text(std::vector<Plot>{plot}); }

}  // namespace dapple::bench

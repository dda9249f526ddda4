#include "compare/page.hpp"

#include <fmt/format.h>

#include <cassert>

#include "compare/data_uri.hpp"
#include "compare/figures_text.hpp"
#include "compare/heat_map.hpp"
#include "compare/page_text.hpp"

namespace dapple {
namespace {

constexpr int kSmallWidth = 512;  // narrower pictures are enlarged pixel by pixel

std::string layer_id(std::size_t index) { return fmt::format("layer-{}", index); }

// The content security policy forbids every request, which shows that the page works offline.
std::string head(const Comparison& c) {
  return fmt::format(
      "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n"
      "<meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n"
      "<meta http-equiv=\"Content-Security-Policy\" content=\"default-src 'none'; img-src data:; "
      "style-src 'unsafe-inline'; script-src 'unsafe-inline'\">\n"
      "<link rel=\"icon\" href=\"data:,\">\n"
      "<title>{} and {} compared</title>\n<style>{}</style>\n</head>\n",
      escape_html(c.name_a), escape_html(c.name_b), kPageStyle);
}

std::string only_in(const char* film, const std::vector<std::string>& layers) {
  if (layers.empty()) return {};
  std::string names;
  for (const std::string& layer : layers) names += fmt::format("{} ", escape_html(layer));
  return fmt::format("<dt>Only in {}</dt><dd>{}</dd>\n", film, names);
}

std::string summary(const Comparison& c, const std::string& failure) {
  std::string verdict;
  if (!failure.empty()) {
    verdict = fmt::format("<p class=\"fails\">{}</p>\n", escape_html(failure));
  }
  return fmt::format(
      "<header>\n<h1>Two renders "
      "compared</h1>\n<dl>\n<dt>A</dt><dd>{}</dd>\n<dt>B</dt><dd>{}</dd>\n"
      "<dt>Size</dt><dd>{} x {} pixels</dd>\n{}{}</dl>\n{}</header>\n",
      escape_html(c.name_a), escape_html(c.name_b), c.width, c.height, only_in("A", c.only_a),
      only_in("B", c.only_b), verdict);
}

std::string controls(const Comparison& c) {
  std::string options;
  for (std::size_t i = 0; i < c.layers.size(); ++i) {
    options += fmt::format("<option value=\"{}\">{}</option>", layer_id(i),
                           escape_html(c.layers[i].layer));
  }
  return fmt::format(
      "<p class=\"controls\"><label>Layer <select id=\"layer\" autocomplete=\"off\">{}</select>"
      "</label>\n<label>A left of the line, B right of it <input type=\"range\" id=\"swipe\" "
      "min=\"0\" max=\"100\" step=\"1\" value=\"50\" autocomplete=\"off\"></label></p>\n",
      options);
}

std::string image(const ByteImage& pixels, const std::string& css_class, const std::string& alt) {
  return fmt::format("<img class=\"{}{}\" width=\"{}\" height=\"{}\" alt=\"{}\" src=\"{}\">\n",
                     css_class, pixels.width < kSmallWidth ? " small" : "", pixels.width,
                     pixels.height, escape_html(alt), png_data_uri(encode_png(pixels, "the page")));
}

std::string ramp_gradient() {
  std::string stops;
  for (const Rgb& c : kHeatRamp) stops += fmt::format(", #{:02x}{:02x}{:02x}", c[0], c[1], c[2]);
  return "linear-gradient(to right" + stops + ")";
}

std::string legend(const LayerDifference& d, double hottest) {
  const std::string no_number =
      d.nans + d.infinity_mismatches > 0 ? " Green: NaN, or infinity in one picture alone." : "";
  return fmt::format(
      "<figcaption>|A - B|, the largest of the channels, from 0 to {:.4g} and more.{}"
      "<span class=\"ramp\" style=\"background:{}\"></span>"
      "<span class=\"ends\"><span>0</span><span>{:.4g}</span></span></figcaption>\n",
      hottest, no_number, ramp_gradient(), hottest);
}

std::string pictures(const Film& a, const Film& b, const LayerPair& pair, const LayerDifference& d,
                     std::size_t index, double scale) {
  const std::string picture = picture_of(pair);
  const Tone tone = layer_tone(b, picture);
  const double hottest = hottest_difference(tone, scale);
  std::string html = fmt::format(
      "<section class=\"layer\" id=\"{0}\" aria-labelledby=\"{0}-name\">\n<h3 id=\"{0}-name\">{1}"
      "</h3>\n<div class=\"pictures\">\n<figure>\n<div class=\"swipe\">\n",
      layer_id(index), escape_html(d.layer));
  html += image(layer_image(a, picture, tone), "over", d.layer + " of A");
  html += image(layer_image(b, picture, tone), "under", d.layer + " of B");
  html += "</div>\n<figcaption>A and B, both with B's tone.</figcaption>\n</figure>\n<figure>\n";
  html += image(heat_map(pair, b.data_window, hottest), "heat",
                fmt::format("Difference of {}, RMSE {:.6g}, largest at {}, {}", d.layer, d.rmse,
                            d.max_x, d.max_y));
  return html + legend(d, hottest) + "</figure>\n</div>\n</section>\n";
}

std::string table(const Comparison& c) {
  std::string html =
      "<div class=\"scroll\" tabindex=\"0\" role=\"region\" "
      "aria-labelledby=\"figures\">\n<table>\n<thead><tr>";
  for (const FigureColumn& column : figure_columns()) {
    html += fmt::format("<th scope=\"col\">{}</th>", escape_html(column.heading));
  }
  html += "</tr></thead>\n<tbody>\n";
  for (std::size_t i = 0; i < c.layers.size(); ++i) {
    html += fmt::format("<tr data-layer=\"{}\">", layer_id(i));
    for (const FigureColumn& column : figure_columns()) {
      const bool is_name = &column == &figure_columns().front();
      html += is_name ? "<th scope=\"row\">" : "<td>";
      html += escape_html(column.cell(c.layers[i]));
      html += is_name ? "</th>" : "</td>";
    }
    html += "</tr>\n";
  }
  return html + "</tbody>\n</table>\n</div>\n";
}

std::string meanings() {
  std::string html = "<dl class=\"notes\">\n";
  for (const FigureColumn& column : figure_columns().subspan(1)) {
    html += fmt::format("<dt>{}</dt><dd>{}</dd>\n", escape_html(column.heading),
                        escape_html(column.meaning));
  }
  return html + "</dl>\n";
}

}  // namespace

std::string comparison_page(const Film& a, const Film& b, const std::vector<LayerPair>& pairs,
                            const Comparison& comparison, const PageOptions& options) {
  assert(pairs.size() == comparison.layers.size());
  std::string html = head(comparison) + "<body>\n" + summary(comparison, options.failure);
  html += "<main>\n<h2>Pictures</h2>\n" + controls(comparison);
  for (std::size_t i = 0; i < pairs.size(); ++i) {
    html += pictures(a, b, pairs[i], comparison.layers[i], i, options.scale);
  }
  html += "<h2 id=\"figures\">Figures</h2>\n" + table(comparison) + meanings();
  return html + "</main>\n<script>" + kPageScript + "</script>\n</body>\n</html>\n";
}

}  // namespace dapple

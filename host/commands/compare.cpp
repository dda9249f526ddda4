// dapple compare: reads two EXR files, prints their differences, and writes a heat map and a page.
#include <fmt/format.h>

#include <cmath>
#include <memory>
#include <optional>

#include "commands/arguments/output_name.hpp"
#include "commands/arguments/output_paths.hpp"
#include "commands/command.hpp"
#include "commands/tell.hpp"
#include "compare/difference.hpp"
#include "compare/figures_text.hpp"
#include "compare/heat_map.hpp"
#include "compare/page.hpp"
#include "dapple/error.hpp"
#include "dapple/film.hpp"
#include "files/output_file.hpp"

namespace dapple {
namespace {

struct CompareArguments {
  std::string a, b, layer, png, html;
  std::optional<double> max_rmse;
  double scale = 10.0;
  bool json = false;
};

void check(const CompareArguments& a) {
  if (!std::isfinite(a.scale) || a.scale <= 0) {
    throw Error(ErrorKind::usage, "--scale must be a number above 0");
  }
  if (a.max_rmse && (!std::isfinite(*a.max_rmse) || *a.max_rmse < 0)) {
    throw Error(ErrorKind::usage, "--max-rmse must be a number, 0 or more");
  }
  std::vector<OutputPath> outputs;
  check_png_name(a.png);
  if (!a.png.empty()) outputs.push_back({"--png", a.png});
  if (!a.html.empty()) outputs.push_back({"--html", a.html});
  check_outputs(outputs);
  check_outputs_spare(outputs, {a.a, a.b});
}

/// A layer that the first file lacks is too large a difference where there is a limit.
void require_layer(const LayerMatch& match, const std::string& layer, bool is_limited) {
  std::string names;
  for (const LayerPair& pair : match.pairs) {
    if (pair.name == layer) return;
    names += " " + pair.name;
  }
  const auto& others = match.only_b;
  if (is_limited && std::find(others.begin(), others.end(), layer) != others.end())
    throw Error(ErrorKind::different, "--layer " + layer + ": the first file lacks it");
  throw Error(ErrorKind::usage, "--layer " + layer + ": no such layer in both; there are:" + names);
}

LayerMatch choose_layers(const CompareArguments& arguments, const Film& a, const Film& b) {
  const LayerMatch match = match_layers(a, b);
  if (match.pairs.empty()) {
    throw Error(ErrorKind::input, arguments.a + " and " + arguments.b + " have no layer in common");
  }
  if (arguments.layer.empty()) return match;
  require_layer(match, arguments.layer, arguments.max_rmse.has_value());
  return match_layers(a, b, arguments.layer);
}

void write_heat_map(const LayerPair& layer, const Film& b, const CompareArguments& a) {
  const double hottest = hottest_difference(layer_tone(b, picture_of(layer)), a.scale);
  write_whole_file(a.png, encode_png(heat_map(layer, b.data_window, hottest), a.png));
}

void print_figures(const Comparison& comparison, const std::string& reason, bool json) {
  using Json = nlohmann::ordered_json;
  constexpr auto kRepair = Json::error_handler_t::replace;  // EXR's channel names are bytes
  put("{}", json ? comparison_json(comparison, reason).dump(2, ' ', false, kRepair) + "\n"
                 : comparison_text(comparison));
}

void run_compare(const CompareArguments& arguments) {
  check(arguments);
  const Film a = read_exr(arguments.a);
  const Film b = read_exr(arguments.b);
  require_same_windows(a, b, arguments.a, arguments.b);

  const LayerMatch match = choose_layers(arguments, a, b);
  const PixelRect& window = a.data_window;
  Comparison comparison{arguments.a, arguments.b,  window.width(), window.height(),
                        {},          match.only_a, match.only_b};
  for (const LayerPair& pair : match.pairs) comparison.layers.push_back(measure(pair, window));
  const std::string reason = failure(comparison, arguments.max_rmse);

  if (!arguments.png.empty()) write_heat_map(match.pairs.front(), b, arguments);
  if (!arguments.html.empty()) {
    write_whole_file(arguments.html,
                     comparison_page(a, b, match.pairs, comparison, {arguments.scale, reason}));
  }
  print_figures(comparison, reason, arguments.json);
  if (!reason.empty()) throw Error(ErrorKind::different, reason);
}

}  // namespace

Run add_compare_command(CLI::App& app) {
  auto a = std::make_shared<CompareArguments>();
  app.add_option("A", a->a, "OpenEXR file")->required();
  app.add_option("B", a->b, "OpenEXR file to compare it with: the reference")->required();
  app.add_option("--layer", a->layer, "Compare only this layer: RGBA, ao, light.key, ...");
  app.add_option("--png", a->png, "Write a heat map of |A - B|, of --layer or the first layer");
  app.add_option("--html", a->html, "Write a page with the images, heat maps and figures");
  app.add_option("--max-rmse", a->max_rmse,
                 "Exit with 5 if a layer's RMSE is larger, or A lacks one; Z, P, motion, samples, "
                 "visits and Cryptomattes count only with --layer");
  app.add_option(
         "--scale", a->scale,
         "The last colour of heat maps is a difference of the layer's range divided by "
         "this. The range is 1 for ao, the largest value in B for a light; docs/guide.md has all")
      ->capture_default_str();
  app.add_flag("--json", a->json, "Print JSON");
  app.footer(
      "Example:\n  dapple compare fast.exr exact.exr --html difference.html --max-rmse 0.02\n\n"
      "Figures are over all of a layer's channels. Equal infinite values do not differ; NaN always "
      "fails.");
  return [a] { run_compare(*a); };
}

}  // namespace dapple

#include "accuracy/report.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "accuracy/svg_plot.hpp"
#include "files/output_file.hpp"

namespace dapple::bench {
namespace {

std::string footprint_text(float footprint) {
  return footprint > 0 ? fmt::format("{:g}", footprint) : "exact";
}

}  // namespace

std::string table_text(const std::vector<std::vector<std::string>>& rows) {
  std::vector<std::size_t> widths;
  for (const auto& row : rows) {
    widths.resize(std::max(widths.size(), row.size()));
    for (std::size_t c = 0; c < row.size(); ++c) widths[c] = std::max(widths[c], row[c].size());
  }
  std::string text;
  for (const auto& row : rows) {
    for (std::size_t c = 0; c < row.size(); ++c) {
      text += c == 0 ? fmt::format("{:<{}}", row[c], widths[c])
                     : fmt::format("  {:>{}}", row[c], widths[c]);
    }
    text += '\n';
  }
  return text;
}

std::string nodes_text(const std::vector<NodeAccuracyRow>& rows) {
  const std::vector<std::string> names = model_names();
  std::vector<std::vector<std::string>> cells{{"triangles"}, {"nodes"}, {"true opacity"}};
  for (const std::string& name : names) cells.push_back({name});
  for (const NodeAccuracyRow& row : rows) {
    cells[0].push_back(fmt::format("{}", row.triangles));
    cells[1].push_back(fmt::format("{}", row.nodes));
    cells[2].push_back(fmt::format("{:.3f}", row.true_opacity));
    for (std::size_t m = 0; m < names.size(); ++m)
      cells[3 + m].push_back(fmt::format("{:+.3f}/{:.3f}", row.errors[m].bias, row.errors[m].rms));
  }
  return "Opacity of nodes minus that of traced rays: bias/rms, without the noise of the rays\n" +
         table_text(cells);
}

nlohmann::json nodes_json(const std::vector<NodeAccuracyRow>& rows) {
  const std::vector<std::string> names = model_names();
  nlohmann::json out = nlohmann::json::array();
  for (const NodeAccuracyRow& row : rows) {
    nlohmann::json models;
    for (std::size_t m = 0; m < names.size(); ++m)
      models[names[m]] = {{"bias", row.errors[m].bias}, {"rms", row.errors[m].rms}};
    out.push_back({{"triangles", row.triangles},
                   {"nodes", row.nodes},
                   {"true_opacity", row.true_opacity},
                   {"models", models}});
  }
  return out;
}

std::string images_text(const std::vector<ImageAccuracyRow>& rows) {
  std::vector<std::vector<std::string>> cells{{"pass", "footprint", "bias", "converged RMSE",
                                               "noise", "noise of mean", "occlusion s",
                                               "all passes s"}};
  for (std::size_t i = 0; i < rows[0].passes.size(); ++i) {
    for (const ImageAccuracyRow& row : rows) {
      const ImageError& error = row.passes[i];
      cells.push_back(
          {error.pass, footprint_text(row.footprint), fmt::format("{:+.4f}", error.bias),
           fmt::format("{:.4f}", error.converged_rmse), fmt::format("{:.4f}", error.noise),
           fmt::format("{:.5f}", error.noise_of_mean), fmt::format("{:.3f}", error.seconds),
           fmt::format("{:.3f}", row.trace_seconds)});
    }
  }
  return "Images, prefiltered minus exact; noise is that of one image\n" + table_text(cells);
}

nlohmann::json images_json(const std::vector<ImageAccuracyRow>& rows) {
  nlohmann::json out = nlohmann::json::array();
  for (const ImageAccuracyRow& row : rows) {
    nlohmann::json passes;
    for (const ImageError& error : row.passes) {
      passes[error.pass] = {{"bias", error.bias},
                            {"converged_rmse", error.converged_rmse},
                            {"noise", error.noise},
                            {"noise_of_mean", error.noise_of_mean},
                            {"occlusion_seconds", error.seconds}};
    }
    out.push_back(
        {{"footprint", row.footprint}, {"trace_seconds", row.trace_seconds}, {"passes", passes}});
  }
  return out;
}

std::string images_svg(const std::vector<ImageAccuracyRow>& rows, const std::string& title) {
  Plot plot{title, "footprint scale (s: occlusion rays of one image)", "error", {}};
  for (std::size_t i = 0; i < rows[0].passes.size(); ++i) {
    const std::string pass = rows[0].passes[i].pass;
    PlotLine bias{pass + ", converged", {}, false, static_cast<int>(i)};
    PlotLine noise{pass + ", noise", {}, true, static_cast<int>(i)};
    for (const ImageAccuracyRow& row : rows) {
      const ImageError& error = row.passes[i];
      bias.points.push_back({row.footprint, error.converged_rmse, ""});
      noise.points.push_back({row.footprint, error.noise, fmt::format("{:.2f} s", error.seconds)});
    }
    plot.lines.push_back(bias);
    plot.lines.push_back(noise);
  }
  return svg_text(plot);
}

void write_report(const std::string& path, const std::string& text) {
  if (!path.empty()) write_whole_file(path, text);
}

}  // namespace dapple::bench

#include "commands/bake/bake_report.hpp"

#include <fmt/format.h>

#include <cmath>
#include <nlohmann/json.hpp>

#include "commands/statistics_text.hpp"
#include "commands/tell.hpp"
#include "files/output_file.hpp"
#include "scene/message.hpp"

namespace dapple {
namespace {

/// Smaller shares of texels that overlap are told as less than this.
constexpr double kLeastTold = 1e-4;

/// The share of values that see nothing above which the summary says so.
constexpr double kNotedDark = 0.01;

/// Root mean square of the standard errors of all values that have samples. `squares`: their sum.
double standard_error(const BakeStatistics& s, double squares) {
  return s.sampled_values > 0 ? std::sqrt(squares / static_cast<double>(s.sampled_values)) : 0.0;
}

nlohmann::ordered_json target_json(const TargetStatistics& counts) {
  return {{"values", counts.values}, {"above", counts.above}};
}

/// What has values, counted.
std::string values_text(const BakeStatistics& s) {
  if (s.texels > 0) return fmt::format("{} texels", s.texels);
  if (s.instances > 0) return fmt::format("{} instances", s.instances);
  return fmt::format("{} vertices", s.vertices);
}

}  // namespace

std::string texture_note(const BakedTexture& texture) {
  const std::size_t count = texture.layout.charts;
  const std::string charts = count == 0   ? std::string("triangles cover ")
                             : count == 1 ? std::string("1 chart covers ")
                                          : fmt::format("{} charts cover ", count);
  const std::string overlap =
      texture.overlap > 0 ? fmt::format("; triangles overlap in {} % of these",
                                        texture.overlap < kLeastTold
                                            ? fmt::format("less than {:.2f}", 100 * kLeastTold)
                                            : fmt::format("{:.2f}", 100 * texture.overlap))
                          : std::string();
  return fmt::format("{}{:.0f} % of the {} x {} texels{}", charts, 100 * texture.coverage,
                     texture.size, texture.size, overlap);
}

std::string replaced_note(std::size_t replaced) {
  if (replaced == 0) return {};
  return fmt::format(
      "{} had an occlusion texture, which is replaced; strength and extras stay",
      replaced == 1 ? std::string("1 material") : fmt::format("{} materials", replaced));
}

std::string unlit_note(std::size_t primitives) {
  if (primitives == 0) return {};
  return fmt::format(
      "{} of KHR_materials_unlit: viewers ignore their occlusion texture; --to vertex darkens them",
      primitives == 1 ? std::string("1 primitive is")
                      : fmt::format("{} primitives are", primitives));
}

void write_statistics(const BakeResult& result, const BakeSeconds& seconds,
                      const std::string& path) {
  const BakeStatistics& s = result.statistics;
  nlohmann::ordered_json json = {
      {"seconds",
       {{"load", seconds.load},
        {"prepare", s.seconds.prepare},
        {"build", s.seconds.build},
        {"upload", s.seconds.upload},
        {"kernel_build", s.seconds.kernel_build},
        {"trace", s.seconds.trace},
        {"write", seconds.write},
        {"total", seconds.total}}},
      {"pass_seconds", s.pass_seconds},
      {"triangles", s.triangles},
      {"vertices", s.vertices},
      {"texels", s.texels},
      {"instances", s.instances},
      {"points", s.points},
      {"rays", s.rays},
      {"standard_error", standard_error(s, s.squared_errors)},
      {"standard_error_light", standard_error(s, s.squared_light_errors)},
      {"ao_target", target_json(s.ao_target)},
      {"light_target", target_json(s.light_target)},
      {"bias", bias_json(s.bias)},
      {"footprint", s.footprint},
      {"inside_samples", s.inside_samples},
      {"enclosed_vertices", s.enclosed_vertices},
      {"enclosed_texels", s.enclosed_texels},
      {"dark_vertices", s.dark_vertices},
      {"dark_texels", s.dark_texels},
      {"device", s.device},
      {"notes", s.notes}};
  if (result.texture.size > 0)
    json["texture"] = {{"size", result.texture.size},
                       {"charts", result.texture.layout.charts},
                       {"coverage", result.texture.coverage},
                       {"overlap", result.texture.overlap}};
  write_whole_file(path, json_text(json));
}

void print_summary(const BakeStatistics& s, const BakeSeconds& seconds, const std::string& output) {
  for (const std::string& note : s.notes) tell("note: {}\n", one_line(note));
  put("{} triangles, {}, {} rays from {} points ({:.1f} million rays per second)\n"
      "seconds: load {:.2f}, prepare {:.2f}, build {:.2f}, upload {:.2f}, kernel build {:.2f}, "
      "trace {:.2f}, write {:.2f}, total {:.2f}\n",
      s.triangles, values_text(s), s.rays, s.points,
      s.seconds.trace > 0 ? static_cast<double>(s.rays) / s.seconds.trace * 1e-6 : 0.0,
      seconds.load, s.seconds.prepare, s.seconds.build, s.seconds.upload, s.seconds.kernel_build,
      s.seconds.trace, seconds.write, seconds.total);
  if (s.sampled_values > 0)
    put("standard error of an AO value {:.3f}{} (root mean square)\n",
        standard_error(s, s.squared_errors),
        s.squared_light_errors > 0
            ? fmt::format(", of light {:.3f}", standard_error(s, s.squared_light_errors))
            : "");
  put("{}", bias_lines(s.bias));
  if (s.inside_samples > 0)
    put("{} samples lie inside closed geometry and do not count\n", s.inside_samples);
  if (s.enclosed_vertices > 0)
    put("{} vertices lie inside closed geometry and have their neighbours' values\n",
        s.enclosed_vertices);
  if (s.enclosed_texels > 0)
    put("{} texels lie inside closed geometry and have the nearest value\n", s.enclosed_texels);
  const std::size_t dark = s.dark_vertices + s.dark_texels, values = s.vertices + s.texels;
  if (static_cast<double>(dark) > kNotedDark * static_cast<double>(values))
    put("{} of {} {} see nothing: AO below 0.001. In closed rooms --ao-distance limits what "
        "occludes\n",
        dark, values, s.texels > 0 ? "texels" : "vertices");
  put("wrote {}\n", output);
}

}  // namespace dapple

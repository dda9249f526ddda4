// dapple merge: adds up parts of an image that dapple render --shard or --crop made, and writes the
// image, or their sum as a part.
#include "render/partial/merge.hpp"

#include <fmt/format.h>

#include <memory>
#include <thread>

#include "commands/arguments/option_text.hpp"
#include "commands/arguments/output_name.hpp"
#include "commands/arguments/output_paths.hpp"
#include "commands/arguments/shared_options.hpp"
#include "commands/command.hpp"
#include "commands/interruption.hpp"
#include "commands/render/frames.hpp"
#include "commands/render/render_arguments.hpp"
#include "commands/render/render_values.hpp"
#include "commands/statistics_text.hpp"
#include "commands/tell.hpp"
#include "dapple/error.hpp"
#include "files/output_file.hpp"
#include "film/exr/exr_output.hpp"
#include "film/exr/exr_parts.hpp"

namespace dapple {
namespace {

struct MergeArguments {
  std::vector<std::string> parts;
  RenderArguments files;  ///< only those about the files that are written
};

void check(const MergeArguments& a) {
  const RenderArguments& files = a.files;
  std::vector<OutputPath> outputs{{"--output", files.output}};
  if (!files.png.empty()) outputs.push_back({"--png", files.png});
  if (!files.png.empty()) outputs.push_back({"--png", visits_path(files.png)});  // if parts have it
  if (!files.stats_json.empty()) outputs.push_back({"--stats-json", files.stats_json});
  const RenderArguments defaults;
  if (is_part_path(files.output) &&
      (!files.half.empty() || files.multipart || files.compression != defaults.compression))
    throw Error(ErrorKind::usage,
                fmt::format("-o {}: --half, --multipart and --compression are for an image (.exr)",
                            files.output));
  check_outputs(outputs);
  check_exr_name("--output", files.output);
  check_outputs_spare(outputs, a.parts);
  check_png(files);
}

bool has_heat_map(const Merge& merge, const RenderArguments& files) {
  return !files.png.empty() && merge.result.film.find("visits.nodes");
}

void print(const Merge& merge, const MergeArguments& a) {
  for (const std::string& note : merge.result.statistics.notes) tell("note: {}\n", note);
  put("merged {} part{}, {} of {} samples per pixel; wrote {}{}{}\n", a.parts.size(),
      a.parts.size() == 1 ? "" : "s", merge.missing.empty() ? "all" : "not all", merge.spp,
      a.files.output, a.files.png.empty() ? "" : " and " + a.files.png,
      has_heat_map(merge, a.files) ? " and " + visits_path(a.files.png) : "");
}

/// The statistics of a render. Parts do not know the scene, nor the seconds of their renders: these
/// are left out.
nlohmann::ordered_json merge_json(const Merge& merge, std::size_t parts) {
  const RenderStatistics& statistics = merge.result.statistics;
  nlohmann::ordered_json json = statistics_json(statistics);
  for (const char* of_scene : {"triangles", "segments", "nodes", "bvh"}) json.erase(of_scene);
  for (const auto& [name, value] : merge.result.film.metadata.settings)
    if (name == "estimator") json["estimator"] = value;
  json["seconds"] = {{"total", statistics.seconds.total}};
  json["bytes"] = {{"film", statistics.bytes.film}};
  json["parts"] = parts;
  json["samples_per_pixel"] = merge.spp;
  json["missing"] = merge.missing;
  return json;
}

void run_merge(const MergeArguments& a) {
  const RenderArguments& files = a.files;
  ExrFormat format = to_format(files);
  const PngOptions png = parse_png_options(files.exposure, files.background);
  check(a);
  catch_interruptions();
  Merge merge = merge_parts(a.parts, is_part_path(files.output) ? files.output : "");
  RenderResult& result = merge.result;
  for (const std::string& name : half_layers_without_planes(result.film, format))
    result.statistics.notes.push_back(fmt::format("--half {}: there is no such layer", name));
  use_exr_threads(static_cast<int>(std::thread::hardware_concurrency()));
  if (!is_part_path(files.output)) write_exr(result.film, files.output, format);
  if (!files.png.empty()) write_png(result.film, files.png, "", png);
  if (has_heat_map(merge, files))
    write_heat_map(result.film, visits_path(files.png), "visits.nodes");
  if (!files.stats_json.empty())
    write_whole_file(files.stats_json, json_text(merge_json(merge, a.parts.size())));
  if (!files.quiet)
    print(merge, a);
  else if (!merge.missing.empty())
    tell("note: parts are missing: {}\n", merge.missing);
}

}  // namespace

Run add_merge_command(CLI::App& app) {
  auto a = std::make_shared<MergeArguments>();
  app.add_option("PARTS", a->parts, "Files that dapple render -o FILE.dapple wrote, in any order")
      ->required();
  app.add_option("-o,--output", a->files.output,
                 "OpenEXR file to write; FILE.dapple: their sum, to merge or resume again")
      ->required();
  add_file_options(app, a->files);
  add_report_options(app, a->files.stats_json, a->files.quiet);
  app.footer(
      "Example:\n  for i in 1 2 3 4; do\n    dapple render tree.glb --spp 64 --shard $i/4 -o "
      "part_$i.dapple\n  done\n  dapple merge part_*.dapple -o tree.exr\n\n"
      "The result equals that of one render, bit for bit.\nParts of an image may be shards of its "
      "samples "
      "(--shard), "
      "of\nits pixels (--crop), or both.");
  return [a] { run_merge(*a); };
}

}  // namespace dapple

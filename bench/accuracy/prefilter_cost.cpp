// Peaks are the peak resident set size that Linux reports and resets on request (proc(5),
// clear_refs). They count whole pages, so the values of small scenes are too large.
#include "accuracy/prefilter_cost.hpp"

#include <fmt/format.h>
#include <malloc.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <fstream>
#include <limits>
#include <span>

#include "accuracy/report.hpp"
#include "bvh/build/object_bvh.hpp"

namespace dapple::bench {
namespace {

constexpr int kRepetitions = 3;

/// The value of a line of /proc/self/status in bytes; 0 if there is no such line.
double status_bytes(const std::string& name) {
  std::ifstream status("/proc/self/status");
  for (std::string line; std::getline(status, line);) {
    if (line.starts_with(name + ":")) return 1024 * std::stod(line.substr(name.size() + 1));
  }
  return 0;
}

double seconds_since(std::chrono::steady_clock::time_point start) {
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

template <class Values>
double bytes(const Values& values) {
  return static_cast<double>(std::span(values).size_bytes());
}

double mesh_bytes(const Mesh& mesh) {
  return bytes(mesh.positions) + bytes(mesh.indices) + bytes(mesh.materials) + bytes(mesh.uvs) +
         bytes(mesh.vertex_alpha);
}

/// Runs `work`. Returns its seconds, and the peak of resident bytes.
template <class Work>
std::pair<double, double> cost_of(const Work& work) {
  malloc_trim(0);
  std::ofstream("/proc/self/clear_refs") << "5";
  const auto start = std::chrono::steady_clock::now();
  work();
  return {seconds_since(start), status_bytes("VmHWM")};
}

/// Measures the two steps of build_bvh() separately, for the first mesh.
void measure_once(const Scene& scene, PrefilterCostRow& row) {
  malloc_trim(0);
  const double before = status_bytes("VmRSS");
  BuiltObject built;
  const auto [building, build_peak] =
      cost_of([&] { built = build_object(scene, OpaqueTexels(scene), scene.meshes[0]); });
  const auto [prefiltering, prefilter_peak] =
      cost_of([&] { prefilter(built, TextureIntegrals(scene, built.object.textured)); });
  const ObjectBvh& object = built.object;
  row.triangles = object.primitive_count;
  row.bvh_bytes = bytes(object.nodes) + bytes(object.blocks) + bytes(object.textured);
  row.build_seconds = std::min(row.build_seconds, building);
  row.prefilter_seconds = std::min(row.prefilter_seconds, prefiltering);
  row.build_peak_bytes = std::max(row.build_peak_bytes, build_peak - before);
  row.prefilter_peak_bytes = std::max(row.prefilter_peak_bytes, prefilter_peak - before);
}

PrefilterCostRow measure_cloud(std::size_t leaves) {
  const Scene scene = make_procedural(fmt::format("scene:cloud?leaves={}", leaves));
  PrefilterCostRow row;
  row.scene_bytes = mesh_bytes(scene.meshes[0]);
  row.build_seconds = row.prefilter_seconds = std::numeric_limits<double>::infinity();
  for (int i = 0; i < kRepetitions; ++i) measure_once(scene, row);
  return row;
}

/// The ratio that ten times the triangles would have had.
double ratio_per_ten(const PrefilterCostRow& row, const PrefilterCostRow& before) {
  const double tens =
      std::log10(static_cast<double>(row.triangles) / static_cast<double>(before.triangles));
  return std::pow(row.prefilter_seconds / before.prefilter_seconds, 1 / tens);
}

}  // namespace

std::vector<PrefilterCostRow> measure_prefilter_cost(bool quick) {
  std::vector<PrefilterCostRow> rows;
  for (const std::size_t leaves : {100'000, 1'000'000, 4'000'000}) {
    rows.push_back(measure_cloud(quick ? leaves / 10 : leaves));
    if (rows.size() > 1) rows.back().ratio = ratio_per_ten(rows.back(), rows[rows.size() - 2]);
  }
  return rows;
}

std::string cost_text(const std::vector<PrefilterCostRow>& rows) {
  std::vector<std::vector<std::string>> cells{{"triangles", "build s", "prefilter s", "per 10x",
                                               "scene B/tri", "BVH B/tri", "build peak",
                                               "prefilter peak"}};
  for (const PrefilterCostRow& row : rows) {
    const auto triangles = static_cast<double>(row.triangles);
    cells.push_back({fmt::format("{}", row.triangles), fmt::format("{:.3f}", row.build_seconds),
                     fmt::format("{:.3f}", row.prefilter_seconds),
                     row.ratio > 0 ? fmt::format("{:.1f}", row.ratio) : "",
                     fmt::format("{:.1f}", row.scene_bytes / triangles),
                     fmt::format("{:.1f}", row.bvh_bytes / triangles),
                     fmt::format("{:.2f}", row.build_peak_bytes / row.bvh_bytes),
                     fmt::format("{:.2f}", row.prefilter_peak_bytes / row.bvh_bytes)});
  }
  return "Prefiltering clouds; per 10x: by what the time grows over ten times the triangles;\n"
         "peaks: most memory resident at once, over that of the finished BVH, without the scene\n" +
         table_text(cells);
}

}  // namespace dapple::bench

#include "bake/texture/texture_layout.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <set>
#include <utility>

#include "bake/mesh_placements.hpp"
#include "bake/texture/charts.hpp"
#include "bake/texture/packing.hpp"
#include "bake/texture/texel_cover.hpp"
#include "dapple/error.hpp"
#include "scene/check/invertible.hpp"

namespace dapple {
namespace {

/// Part of a chart's mean width that is left free beside it, in texels kMinGap at least.
constexpr double kGapShare = 0.05;
constexpr std::uint32_t kMinGap = 2;

/// Exporters compute texture coordinates in floats: 1.0000001 is the border.
constexpr float kOutside = 1e-5f;

/// By mesh, the first placement that is not scaled to zero; the identity if there is none.
std::vector<M44f> first_placements(const Scene& scene) {
  std::vector<M44f> first(scene.meshes.size());
  for (auto instance = scene.instances.rbegin(); instance != scene.instances.rend(); ++instance)
    if (is_invertible(instance->to_world)) first[instance->mesh] = instance->to_world;
  return first;
}

/// Lengths in the world over lengths of a mesh.
float scale_of(const M44f& to_world) {
  return static_cast<float>(std::cbrt(std::fabs(double{to_world.determinant()})));
}

/// Twice the area of a triangle in the world; 0 where it is not finite.
double world_area(const Mesh& mesh, std::size_t triangle, const M44f& to_world) {
  const std::uint32_t* corner = &mesh.indices[3 * triangle];
  V3f a, b;
  to_world.multDirMatrix(mesh.positions[corner[1]] - mesh.positions[corner[0]], a);
  to_world.multDirMatrix(mesh.positions[corner[2]] - mesh.positions[corner[0]], b);
  const double area = double{a.cross(b).length()};
  return std::isfinite(area) ? area : 0;
}

/// A chart of a mesh.
struct PlacedChart {
  Chart chart;
  std::uint32_t mesh;
  float scale;  ///< of the mesh
};

using PlacedCharts = std::vector<PlacedChart>;

PlacedCharts charts_of_scene(const Scene& scene, const std::vector<bool>& textured) {
  const std::vector<M44f> placements = first_placements(scene);
  PlacedCharts charts;
  for (std::uint32_t m = 0; m < scene.meshes.size(); ++m) {
    if (!textured[m]) continue;
    const float scale = scale_of(placements[m]);
    for (Chart& chart : make_charts(scene.meshes[m]))
      charts.push_back({std::move(chart), m, scale});
  }
  return charts;
}

/// Divides charts longer than the side of a square as large as all of them together, such as
/// trunks, which alone would decide how small the others are, and large ones that fill little of
/// their rectangles.
PlacedCharts divided(const PlacedCharts& whole) {
  double area = 0;
  for (const PlacedChart& c : whole)
    area += double{c.chart.size.x * c.scale} * double{c.chart.size.y * c.scale};
  const auto length = static_cast<float>(std::sqrt(area));
  const auto mean = static_cast<float>(area / static_cast<double>(whole.size()));
  PlacedCharts charts;
  for (const auto& [chart, mesh, scale] : whole)
    for (Chart& part : divide_chart(chart, {length / scale, mean / (scale * scale)}))
      charts.push_back({std::move(part), mesh, scale});
  return charts;
}

/// Packs the charts into the texture.
Packing pack_charts(const PlacedCharts& charts, const BakeOptions& options) {
  std::vector<V2f> sizes;
  sizes.reserve(charts.size());
  for (const PlacedChart& chart : charts) sizes.push_back(chart.chart.size * chart.scale);
  const double width =
      options.texture_size / std::sqrt(static_cast<double>(std::max<std::size_t>(1, sizes.size())));
  const std::uint32_t gap =
      std::clamp(static_cast<std::uint32_t>(kGapShare * width), kMinGap,
                 std::max(kMinGap, static_cast<std::uint32_t>(options.margin)));
  return pack(sizes, options.texture_size, gap);
}

/// Triangles without a chart are a point in the texture, too: that of another triangle with one of
/// their vertices, or 0, 0.
void place_triangles_without_area(const Mesh& mesh, std::size_t m, TextureLayout& layout) {
  std::vector<std::optional<V2f>> of_vertex(mesh.positions.size());
  std::vector<V2f>& corners = layout.corners[m];
  for (std::size_t i = 0; i < corners.size(); ++i)
    if (layout.chart_of[m][i / 3] != TextureLayout::kNoChart)
      of_vertex[mesh.indices[i]] = corners[i];
  for (std::size_t t = 0; t < mesh.primitive_count(); ++t) {
    if (layout.chart_of[m][t] != TextureLayout::kNoChart) continue;
    V2f point(0, 0);
    for (std::size_t k = 0; k < 3; ++k) point = of_vertex[mesh.indices[3 * t + k]].value_or(point);
    std::fill_n(corners.begin() + static_cast<std::ptrdiff_t>(3 * t), 3, point);
  }
}

/// The texture coordinates of the vertices of mesh `m`. Throws Error usage unless each has some, in
/// [0,1] where triangles use it.
const std::vector<V2f>& given_uvs(const Scene& scene, const BakeOptions& options, std::size_t m) {
  const Mesh& mesh = scene.meshes[m];
  static const std::vector<V2f> none;
  const std::vector<V2f>& uvs = m < options.texture_uvs.size() ? options.texture_uvs[m] : none;
  const std::string of_mesh = fmt::format("texture coordinates: mesh {} (\"{}\")", m, mesh.name);
  if (uvs.size() != mesh.positions.size())
    throw Error(ErrorKind::usage, fmt::format("{} has {} for {} vertices", of_mesh, uvs.size(),
                                              mesh.positions.size()));
  for (const std::uint32_t vertex : mesh.indices) {
    const V2f& uv = uvs[vertex];
    if (!texture_point(uv))
      throw Error(ErrorKind::usage,
                  fmt::format("{} has ({}, {}) at vertex {}; the texture is [0, 1]", of_mesh, uv.x,
                              uv.y, vertex));
  }
  return uvs;
}

}  // namespace

std::vector<bool> textured_meshes(const Scene& scene, BakePlacement kind) {
  const std::vector<std::size_t> placements = placement_counts(scene, kind);
  std::set<std::pair<std::uint32_t, std::uint32_t>> seen;
  std::vector<bool> textured;
  for (std::size_t m = 0; m < scene.meshes.size(); ++m) {
    const Mesh& mesh = scene.meshes[m];
    const bool is_baked = !mesh.has_strands() && placements[m] > 0;
    bool is_new = is_baked;
    for (const VertexSource& source : mesh.sources)
      if (is_baked) is_new = seen.insert({source.mesh, source.primitive}).second && is_new;
    textured.push_back(is_new);
  }
  return textured;
}

std::optional<V2f> texture_point(const V2f& uv) {
  const auto is_near = [](float x) { return x >= -kOutside && x <= 1 + kOutside; };
  if (!is_near(uv.x) || !is_near(uv.y)) return std::nullopt;
  return V2f(std::clamp(uv.x, 0.0f, 1.0f), std::clamp(uv.y, 0.0f, 1.0f));
}

TextureLayout make_layout(const Scene& scene, const BakeOptions& options) {
  const std::vector<bool> textured = textured_meshes(scene, options.placement);
  PlacedCharts charts = charts_of_scene(scene, textured);
  Packing packing = pack_charts(charts, options);
  const std::uint32_t size = options.texture_size;
  if (packing.rects.size() != charts.size())
    throw Error(ErrorKind::usage,
                fmt::format("--size is {}; the {} charts of this scene need at least {}", size,
                            charts.size(), smallest_size(charts.size(), kMinGap)));
  if (charts.size() > 1) {
    PlacedCharts parts = divided(charts);
    Packing packing_of_parts = pack_charts(parts, options);
    if (packing_of_parts.scale > packing.scale) {
      charts = std::move(parts);
      packing = std::move(packing_of_parts);
    }
  }
  TextureLayout layout;
  layout.charts = charts.size();
  layout.corners.resize(scene.meshes.size());
  layout.chart_of.resize(scene.meshes.size());
  for (std::size_t m = 0; m < scene.meshes.size(); ++m) {
    if (!textured[m]) continue;
    layout.corners[m].resize(scene.meshes[m].indices.size(), V2f(0, 0));
    layout.chart_of[m].resize(scene.meshes[m].primitive_count(), TextureLayout::kNoChart);
  }
  for (std::uint32_t c = 0; c < charts.size(); ++c) {
    const auto& [chart, mesh, scale] = charts[c];
    const V2f first(static_cast<float>(packing.rects[c].x) + 0.5f,
                    static_cast<float>(packing.rects[c].y) + 0.5f);
    for (std::size_t t = 0; t < chart.triangles.size(); ++t) {
      const std::uint32_t triangle = chart.triangles[t];
      layout.chart_of[mesh][triangle] = c;
      for (std::size_t k = 0; k < 3; ++k)
        layout.corners[mesh][3 * triangle + k] =
            (first + chart.corners[3 * t + k] * (scale * packing.scale)) / static_cast<float>(size);
    }
  }
  for (std::size_t m = 0; m < scene.meshes.size(); ++m)
    if (textured[m]) place_triangles_without_area(scene.meshes[m], m, layout);
  return layout;
}

TextureLayout given_layout(const Scene& scene, const BakeOptions& options) {
  const std::vector<bool> textured = textured_meshes(scene, options.placement);
  TextureLayout layout;
  layout.corners.resize(scene.meshes.size());
  for (std::size_t m = 0; m < scene.meshes.size(); ++m) {
    if (!textured[m]) continue;
    const std::vector<V2f>& uvs = given_uvs(scene, options, m);
    for (const std::uint32_t vertex : scene.meshes[m].indices)
      layout.corners[m].push_back(texture_point(uvs[vertex]).value());
  }
  return layout;
}

double share_without_texels(const Scene& scene, const std::vector<std::vector<V2f>>& uvs,
                            std::uint32_t size, BakePlacement placement) {
  const std::vector<bool> textured = textured_meshes(scene, placement);
  const std::vector<M44f> placements = first_placements(scene);
  double all = 0, without = 0;
  for (std::uint32_t m = 0; m < scene.meshes.size(); ++m) {
    const Mesh& mesh = scene.meshes[m];
    if (!textured[m]) continue;
    const M44f& to_world = placements[m];
    for (std::size_t t = 0; t < mesh.primitive_count(); ++t) {
      V2f uv[3];
      for (std::size_t k = 0; k < 3; ++k) {
        const V2f& given = uvs.at(m).at(mesh.indices[3 * t + k]);
        uv[k] = texture_point(given).value_or(given);
      }
      const double area = world_area(mesh, t, to_world);
      all += area;
      if (!has_texel_area(uv, size)) without += area;
    }
  }
  return all > 0 ? without / all : 0.0;
}

}  // namespace dapple

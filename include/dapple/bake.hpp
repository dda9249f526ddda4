// Baking: ambient occlusion, bent normals and irradiance at the vertices of a scene's meshes or in
// a texture, and the mean ambient occlusion and irradiance of each instance. In: a scene and
// options. Out: values, no files.
#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "dapple/options.hpp"
#include "dapple/render.hpp"
#include "dapple/scene.hpp"

namespace dapple {

/// The side of a surface that a value describes.
enum class BakeSides : std::uint8_t {
  automatic,  ///< max for small double-sided sheets, such as leaves, front for others
  front,      ///< the side from which the triangle's vertices are counterclockwise
  max,        ///< the side with the larger AO, chosen for a small sheet as a whole, else by vertex
  mean,       ///< the mean of both
};

/// Which placements of a mesh the values at its vertices describe.
enum class BakePlacement : std::uint8_t {
  together,  ///< the mean over all placements, each in its surroundings
  /// The mesh without the rest of the scene and without occluders, as it is in object space:
  /// `distance` is in the mesh's own units there; vertices and texels have no ground.
  alone,
};

struct BakeOptions {
  bool vertices = true;    ///< bake values at vertices
  bool instances = false;  ///< bake a value for each instance
  bool texture = false;    ///< bake a texture that all meshes share
  bool bent = false;       ///< bent normals too, at vertices and in the texture
  bool light = false;      ///< irradiance of each light too
  std::optional<std::vector<Light>> lights = {};  ///< in place of the scene's; none: those
  int light_rays = 8;  ///< per light, for each sample and side, [1, 4096]
  /// Standard error of each AO value to aim at, [0,1], and of the brightness of all lights
  /// together, relative to the largest unoccluded one; 0: `rays` for every value.
  float target_error = 0.03f;
  /// Of each triangle (at_vertices: vertex; texture: texel; instances: instance) and side, [8,
  /// 65536]; with a target, at most. Without one, they are divided over samples of eight or more:
  /// up to 64, or 16 for each placement if these are more. Lights have as many samples of
  /// `light_rays`.
  int rays = 1024;
  Estimator estimator = Estimator::prefiltered;
  /// As RenderOptions::footprint, [0, 1e6], for the rays of one point.
  float footprint = 1.5f;
  float report_bias = kDefaultReportBias;  ///< as RenderOptions::report_bias
  /// The footprint is the largest of `footprint`, a half of it, a quarter and so on with which the
  /// bias is at most this, [0,1]; exact rays if none is; 0: `footprint`.
  float max_bias = 0;
  /// Metres, or with BakePlacement::alone the mesh's own units; surfaces farther away do not
  /// occlude; [0, 1e30], 0: no limit.
  float distance = 0;
  float falloff = 0;  ///< as RenderOptions::ao_falloff
  Normals normals = Normals::shading;
  bool at_vertices = false;  ///< rays start at the vertices, not from points of the triangles
  BakeSides sides = BakeSides::automatic;
  BakePlacement placement = BakePlacement::together;
  std::uint32_t texture_size = 1024;  ///< texels along each side, [1, 16384]
  int margin = 16;  ///< texels by which values extend over the border of charts, [0, 1024]
  /// Texture coordinates to use, for each mesh and vertex, in [0,1] up to rounding errors of 1e-5;
  /// empty: a layout of our own.
  std::vector<std::vector<V2f>> texture_uvs = {};
  std::uint32_t seed = 0;
  bool ground = false;  ///< an opaque plane under the scene occludes
  std::vector<std::pair<std::string, float>> opacity = {};  ///< of materials by name, [0,1]
  std::string device = {}, kernel_dir = {}, cache = {};     ///< as in RenderOptions
};

/// Throws Error usage, naming the command line's flag, when a value is out of range.
void validate(const BakeOptions& options);

/// Values of Scene::meshes[i], one for each vertex. Empty for strands, and if no values at vertices
/// were requested. Vertices that no triangle of positive area uses have AO 1 and no bent normal.
struct BakedMesh {
  std::vector<float> ao;  ///< [0,1], 1: unoccluded
  std::vector<V3f> bent;  ///< mean unoccluded direction, a unit vector in object space; or zero
  /// Irradiance by light, as BakeResult::light_names, and vertex, W/m^2, linear RGB.
  std::vector<std::vector<V3f>> light;
};

/// Where triangles lie in a texture.
struct TextureLayout {
  static constexpr std::uint32_t kNoChart = ~0u;
  /// For each mesh the texture coordinates of its triangles' corners, three a triangle, in [0,1];
  /// v = 0 is the top, as in glTF. Empty for strands, and for meshes that show the same primitives
  /// of a file as an earlier one, in another pose.
  std::vector<std::vector<V2f>> corners;
  /// For each mesh and triangle its chart; kNoChart for triangles without area. Empty where
  /// BakeOptions::texture_uvs were used: there no vertex has several places.
  std::vector<std::vector<std::uint32_t>> chart_of;
  std::size_t charts = 0;
};

/// Values of texels, row by row from the top.
struct BakedTexture {
  std::uint32_t size = 0;  ///< texels along each side
  std::vector<float> ao;   ///< [0,1]; 1 in texels beyond the margin
  std::vector<V3f> bent;   ///< unit vectors in object space, or zero; empty if not requested
  std::vector<std::vector<V3f>> light;  ///< as BakedMesh::light, by light and texel
  TextureLayout layout;
  double coverage = 0;  ///< share of the texels that triangles cover, without the margin
  double overlap = 0;   ///< share of these in which triangles overlap, as uv_overlap() counts
};

/// Values that were sampled to a target error. Vertices that share a value count once.
struct TargetStatistics {
  std::size_t values = 0;
  std::size_t above = 0;  ///< those with a larger error, because BakeOptions::rays is the maximum
};

struct BakeStatistics {
  struct {
    double prepare = 0, build = 0, upload = 0, kernel_build = 0, trace = 0, total = 0;
  } seconds;
  /// Of the rays' passes, from the device's own clock, by name as in RenderStatistics; the host's
  /// work is most of the rest of seconds.trace.
  std::map<std::string, double> pass_seconds;
  std::size_t triangles = 0, vertices = 0, texels = 0, instances = 0, points = 0;
  std::uint64_t rays = 0;
  /// Values that have samples: not those of vertices that no triangle uses, nor of texels and
  /// vertices all of whose samples lie inside closed geometry.
  std::size_t sampled_values = 0;
  double squared_errors = 0;        ///< of AO, estimated; the sum over all sampled values
  double squared_light_errors = 0;  ///< of all lights together, relative as target_error
  /// Of AO, and of all lights together, at vertices, in the texture and of instances.
  TargetStatistics ao_target, light_target;
  /// Of the prefiltered samples: the bias of "ao", and of "light", all lights together, relative to
  /// the largest unoccluded one. Empty if it is not reported.
  std::map<std::string, Bias> bias;
  /// BakeOptions::footprint, or what max_bias chose. With meshes alone that of the instances, if
  /// they are baked, else of the last mesh.
  float footprint = 0;
  std::size_t inside_samples = 0;     ///< inside closed geometry; they count for no value
  std::size_t enclosed_vertices = 0;  ///< inside closed geometry; they get their neighbours' value
  std::size_t enclosed_texels = 0;    ///< the same in the texture
  /// See nothing, as in a closed room: AO below 0.001. Those inside closed geometry are no part.
  std::size_t dark_vertices = 0;
  std::size_t dark_texels = 0;  ///< the same in the texture
  std::string device;
  std::vector<std::string> notes;
};

struct BakeResult {
  std::vector<BakedMesh> meshes;         ///< as Scene::meshes
  std::vector<std::string> light_names;  ///< lights of a group are added up under its name
  BakedTexture texture;                  ///< size 0 if not requested
  std::vector<float> instance_ao;        ///< as Scene::instances, [0,1]; empty if not requested
  std::vector<std::vector<V3f>> instance_light;  ///< by light and instance
  BakeStatistics statistics;
  bool interrupted = false;  ///< RenderControl::stop returned true; the values are incomplete
  /// Why the last checkpoint could not be written, or empty. The checkpoint before it is kept.
  std::string checkpoint_failure;
};

/// Bakes `scene`. Its instances and meshes must be as the reader returned them. `occluders` are
/// scenes that occlude and are not baked. A vertex's value is the mean of the AO at points of the
/// triangles around it, weighted by area and by the vertex's barycentric coordinate (the lumped
/// form of Kavan, Bargteil and Sloan, "Least Squares Vertex Baking", 2011). Points inside closed
/// opaque geometry, such as those of a floor below a box, do not count. Vertices at the same
/// position with normals of triangles within 45 degrees share one value. A bake that is
/// resumed from a checkpoint of `control` must have the same arguments as the first one. Throws
/// Error usage, input, device or failed; usage also for `occluders` with BakePlacement::alone,
/// unless only instances are baked. The same arguments give the same bits, but for seconds and the
/// reported bias: how many samples are compared depends on the time that comparing takes.
BakeResult bake(const Scene& scene, const BakeOptions& options = {},
                const RenderControl& control = {}, const std::vector<Scene>& occluders = {});

/// The share of the covered texels of a `size` x `size` texture that lie in several triangles at
/// their centre, or in small triangles whose areas add up to more than the texel, [0,1], for
/// texture coordinates as BakeOptions::texture_uvs; infinity if some are more than 1e-5 outside of
/// [0,1]. Of the meshes that a bake with `placement` bakes. Where many triangles are large it is
/// that of a coarser texture, so that it takes less than a second or two.
double uv_overlap(const Scene& scene, const std::vector<std::vector<V2f>>& uvs, std::uint32_t size,
                  BakePlacement placement = BakePlacement::together);

}  // namespace dapple

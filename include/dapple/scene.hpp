// A scene as plain values: meshes, instances, materials, opacity textures, lights, cameras. The
// readers in host/scene fill it; the BVH builder and upload() read it. World space is right-handed,
// +Y up, metres, as in glTF.
#pragma once

#include <Imath/ImathBox.h>
#include <Imath/ImathMatrix.h>
#include <Imath/ImathVec.h>

#include <cstdint>
#include <limits>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace dapple {

using Imath::Box3f;
using Imath::M44f;
using Imath::V2f;
using Imath::V3d;
using Imath::V3f;

/// glTF's `alphaMode`: how an alpha becomes an opacity.
enum class AlphaMode : std::uint8_t {
  opaque,  ///< alpha is ignored, opacity is 1
  mask,    ///< opacity is 1 where alpha >= cutoff, else 0
  blend,   ///< opacity is alpha
};

enum class Wrap : std::uint8_t { repeat, clamp, mirror };

/// An 8-bit alpha image, row 0 at v = 0, looked up bilinearly (texel centres at
/// half-integers). Value / 255 is alpha in [0,1].
struct Texture {
  std::string name;  ///< for messages: file or image name
  std::uint32_t width = 0;
  std::uint32_t height = 0;
  std::vector<std::uint8_t> alpha;  ///< width * height
  Wrap wrap_s = Wrap::repeat;
  Wrap wrap_t = Wrap::repeat;
  bool nearest = false;  ///< glTF magFilter NEAREST
};

/// An 8-bit colour image, encoded as sRGB, in the layout of Texture.
struct ColorTexture {
  std::string name;
  std::uint32_t width = 0;
  std::uint32_t height = 0;
  std::vector<std::uint8_t> rgb;    ///< 3 * width * height
  std::vector<std::uint8_t> alpha;  ///< weights of texels in means; empty: all the same
  Wrap wrap_s = Wrap::repeat;
  Wrap wrap_t = Wrap::repeat;
  bool nearest = false;
};

struct Material {
  std::string name;
  AlphaMode alpha_mode = AlphaMode::opaque;
  float alpha = 1.0f;         ///< baseColorFactor.a, [0,1]
  float alpha_cutoff = 0.5f;  ///< mask only
  int alpha_texture = -1;     ///< index into Scene::textures, -1 for none
  bool uses_vertex_alpha = true;
  V3f color{1, 1, 1};      ///< base colour: the albedo's factor, linear RGB, [0,1]
  int color_texture = -1;  ///< index into Scene::color_textures, -1 for none
  V3f emission{0, 0, 0};   ///< emitted radiance, W/(sr m^2), linear RGB
  /// Whether both sides emit, and which sides bakes count; every surface occludes from both.
  bool double_sided = false;
};

/// Consecutive vertices of a Mesh that were read from one primitive of a glTF file.
struct VertexSource {
  std::uint32_t mesh = 0, primitive = 0;  ///< indices in the file
  std::uint32_t first = 0, count = 0;     ///< vertices of the Mesh
  std::vector<std::uint32_t> used;        ///< their elements in accessors; empty: 0 to count - 1
  bool mirrored = false;  ///< skinned, and mirrored along X, which the instance's matrix undoes
};

/// Indexed primitives in object space: only triangles, or only segments of strands. The materials
/// may differ.
struct Mesh {
  std::string name;
  std::vector<V3f> positions;
  std::vector<std::uint32_t> indices;    ///< three per triangle, two per segment
  std::vector<std::uint32_t> materials;  ///< one per primitive, index into Scene::materials
  std::vector<float> radii;              ///< strands: per vertex, metres, > 0; empty: triangles
  std::vector<V3f> normals;  ///< per vertex, unit, or zero for that of the face; or empty
  std::vector<V2f> uvs;      ///< per vertex, for the textures, transforms applied; or empty
  std::vector<V3f> colors;   ///< per vertex, factor of the albedo, linear RGB; or empty (= 1)
  std::vector<float> vertex_alpha;    ///< per vertex, COLOR_0.a in [0,1]; or empty (= 1)
  std::vector<VertexSource> sources;  ///< of a glTF file's mesh; empty once meshes are merged
  /// Merged meshes: per primitive, index into Scene::objects; else empty.
  std::vector<std::uint32_t> objects;

  [[nodiscard]] bool has_strands() const { return !radii.empty(); }
  [[nodiscard]] std::size_t primitive_count() const { return materials.size(); }
};

/// One placement of a mesh. Imath's convention: p_world = p_object * to_world.
struct Instance {
  std::uint32_t mesh = 0;
  M44f to_world;    ///< affine; if it cannot be inverted, nothing is placed
  int light = -1;   ///< index of the mesh light that this placement emits, else -1
  int node = -1;    ///< the glTF node that places it; -1: none
  int object = -1;  ///< index into Scene::objects; -1 until name_objects()
};

enum class LightKind : std::uint8_t { rect, sphere, sun, mesh, dome, disk };

/// Radiance from all directions: a latitude-longitude image as OpenEXR defines it (ImfEnvmap.h).
/// The top row is the direction +Y, the middle column +Z, and the column a quarter from the left
/// +X.
struct Environment {
  std::uint32_t width = 0, height = 0;
  std::vector<V3f> radiance;        ///< row by row, linear RGB, finite, not negative
  std::string file = {};            ///< path that it was read from; empty: none
  std::size_t negative_pixels = 0;  ///< of the file; their negative channels became 0
  bool is_cropped = false;          ///< whether the file's data window is not its display window
};

/// A light. Irradiance at a point is the integral of radiance * cosine * transmittance.
struct Light {
  std::string name = {};
  LightKind kind = LightKind::rect;
  V3f radiance{1, 1, 1};  ///< W/(sr m^2), linear RGB
  V3f position{0, 0, 0};  ///< rect, disk and sphere: centre
  /// Unit; rect, disk: towards the emitting side; sun, spot: in which light travels.
  V3f direction{0, -1, 0};
  V3f edge_u{1, 0, 0};              ///< rect: full first edge
  V3f edge_v{0, 0, 1};              ///< rect: full second edge
  float radius = 0.1f;              ///< sphere, disk: metres
  float angular_radius = 0.00465f;  ///< sun, radians (the real sun: 0.2665 degrees)
  /// sphere: cosines of a spot's cone as in KHR_lights_punctual; -1, -1 for none.
  float cos_inner = -1.0f;
  float cos_outer = -1.0f;
  bool double_sided = false;  ///< mesh: emits from both sides
  /// dome: multiplied by `radiance`; none: the same radiance from all directions.
  std::shared_ptr<const Environment> environment = {};
  float rotation = 0;  ///< dome: radians about +Y, from +Z towards +X
  /// Lights of one group share the layer `light.GROUP`, the sum of their irradiances; empty: the
  /// light has a layer of its own.
  std::string group = {};
  /// Number of its sequence of random numbers; below 0: the next one. With a number of its own a
  /// light keeps its noise when others are removed.
  int sequence = -1;
};

struct Camera {
  enum class Kind : std::uint8_t { perspective, orthographic };
  std::string name = {};
  Kind kind = Kind::perspective;
  M44f to_world;          ///< camera looks along its -Z, +Y up, +X right
  float fov_y = 0.7f;     ///< perspective: full vertical angle, radians
  float half_height = 1;  ///< orthographic: ymag, metres
  /// Thin lens (Cook, Porter and Carpenter, "Distributed Ray Tracing", 1984): points at the focus
  /// distance are sharp.
  float lens_radius = 0;     ///< metres; 0: a pinhole, everything is sharp
  float focus_distance = 0;  ///< metres along the view direction; 0: the middle of the scene
};

/// Whether all rays of the camera start from one point.
[[nodiscard]] inline bool is_pinhole(const Camera& camera) {
  return camera.kind == Camera::Kind::perspective && camera.lens_radius == 0;
}

/// Motion that a scene's file contains.
struct Animation {
  std::string name;
  double seconds = 0;  ///< time of its last keyframe
};

struct Scene {
  std::string source;  ///< file or scene: name, for messages and metadata
  std::vector<Texture> textures;
  std::vector<ColorTexture> color_textures;
  std::vector<Material> materials;
  std::vector<Mesh> meshes;
  std::vector<Instance> instances;
  std::vector<Light> lights;
  std::vector<Camera> cameras;
  std::vector<Animation> animations;    ///< SceneOptions::animation chooses one
  std::vector<std::string> warnings;    ///< one line for each thing that the reader skipped
  std::vector<std::string> files;       ///< paths of the scene, its buffers and its images
  std::vector<std::string> node_names;  ///< of glTF nodes with meshes, by Instance::node
  std::vector<std::string> objects;     ///< names of objects, all different; see name_objects()
};

struct SceneOptions {
  float light_radius = 0.1f;   ///< metres: KHR point and spot lights become spheres of this radius
  float line_radius = 0;       ///< metres: glTF's lines become strands of this radius; 0: skipped
  bool colors = false;         ///< read colour textures and colours of vertices, for the albedo
  bool allow_outside = false;  ///< buffers and images may be outside of the scene file's folder
  std::optional<double> time = {};  ///< seconds: the time of the pose; none: at rest
  std::string animation = {};  ///< the glTF animation that plays, "*" for all; empty: the first
};

/// Throws Error usage, which names the command line's flag, if a value is out of range.
void validate(const SceneOptions& options);

/// Reads a scene: a glTF 2.0 file (.gltf or .glb), strands in a file of Cem Yuksel's HAIR format
/// (.hair), or a procedural one by name, "scene:tree?leaves=50000&opacity=0.85&seed=1". MovingScene
/// reads a scene once and poses it for many times. Throws Error: input.
Scene load_scene(const std::string& spec, const SceneOptions& options = {});

/// Reads only glTF; `load_scene` calls it. Throws Error: input.
Scene load_gltf(const std::string& path, const SceneOptions& options = {});

/// Makes only procedural scenes; `name` as "scene:NAME?key=value&...", `time` in seconds as in
/// SceneOptions. Throws Error: usage.
Scene make_procedural(const std::string& name, std::optional<double> time = {});

/// Reads a JSON file of lights (docs/formats.md), without those that are not enabled. Throws Error:
/// input.
std::vector<Light> load_lights(const std::string& path);

/// Reads a latitude-longitude image for a dome light: OpenEXR (channels R, G, B or Y) or Radiance
/// HDR. Negative values become 0. Throws Error: input.
std::shared_ptr<const Environment> load_environment(const std::string& path);

/// A dome with the image at `path`, as load_environment() reads it. Throws Error: input.
Light dome_light(const std::string& name, const std::string& path);

/// A sky of the CIE standard overcast luminance (Moon and Spencer, 1942), 1 + 2 cos(zenith angle)
/// to 3, or of uniform luminance, whose irradiance on an open horizontal plane is 1 W/m^2; dark
/// below the horizon.
Light overcast_sky();
Light uniform_sky();

/// Prepares dome images for sampling: reduces images of more than 2048 x 1024 pixels by averaging,
/// divides each by its mean luminance, and multiplies the light's radiance by that luminance.
void finalize_domes(Scene& scene);

/// Writes meshes, instances, materials (no textures), cameras as one GLB file, whole or not at all.
/// Throws Error failed, and input if the scene's parts do not fit together.
void write_glb(const Scene& scene, const std::string& path);

/// Bounds of all instances whose matrix can be inverted, after `transform` of world space, which is
/// affine; an empty box for an empty scene. Throws Error input if the scene's parts do not fit
/// together.
Box3f scene_bounds(const Scene& scene, const M44f& transform = {});

/// Gives material `name` the opacity `value` in place of texture, factor and mode.
/// Throws Error usage if there is no such material or `value` is outside [0,1].
void override_opacity(Scene& scene, const std::string& name, float value);

/// Puts `lights` in place of the scene's. What its mesh lights shine from stays, as a surface that
/// does not.
void use_lights(Scene& scene, const std::vector<Light>& lights);

/// Adds an opaque square under the scene's lowest point, 200 times as wide as the scene.
void add_ground(Scene& scene);

/// A perspective camera, 12 degrees above the horizon, as close as it can be with all of the scene
/// in the middle of its frame. It is on the side of +Z, or +X if the scene is twice as deep as
/// wide. `aspect` is width / height; `fov_y` in radians.
Camera frame_scene(const Scene& scene, float aspect, float fov_y = 0.7f);

/// A camera at `from` that looks at `at`; `fov_y` in radians. Throws Error usage if the three are
/// degenerate.
Camera look_at(V3f from, V3f at, V3f up, float fov_y);

/// The lights that a scene without lights gets: `sun`, up, left and in front of `camera`, and
/// `sky`, a blue dome, pale at the horizon and dim below it.
std::vector<Light> daylight(const Camera& camera);

/// A rect light, up, left and in front of `camera`, as large as the scene: a studio's key light.
Light key_light(const Scene& scene, const Camera& camera);

/// Makes objects of the instances, for Cryptomattes: what one glTF node places, or all instances of
/// a mesh where no node places it. Nodes of one name are one object. Comes before
/// merge_single_instances().
void name_objects(Scene& scene);

/// Merges all meshes that are placed once, and tiny meshes that are placed several times, into one
/// mesh in world space, so that overlapping meshes share one BVH. Mesh lights are not merged. Drops
/// instances whose matrix cannot be inverted and triangles that are not finite, with a warning.
/// Throws Error input if parts of the scene do not fit together, as an index beyond its array.
void merge_single_instances(Scene& scene);

}  // namespace dapple

#include "bake/preview.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "scene/images/color.hpp"

namespace dapple {
namespace {

/// Samples of a pixel along each axis.
constexpr int kSubpixels = 3;

/// Parts of a triangle that are closer than this share of its largest depth are not drawn.
constexpr float kNearShare = 1e-3f;

/// Linear grey where nothing is drawn.
constexpr float kBackground = 0.1f;

float wrapped(float x, Wrap wrap) {
  if (wrap == Wrap::clamp) return std::clamp(x, 0.0f, 1.0f);
  const float tile = std::floor(x);
  const bool mirrored = wrap == Wrap::mirror && static_cast<int>(tile) % 2 != 0;
  return mirrored ? 1 - (x - tile) : x - tile;
}

float alpha_at(const Texture& texture, const V2f& uv) {
  const auto texel = [](float x, std::uint32_t size) {
    return std::min(static_cast<std::uint32_t>(x * static_cast<float>(size)), size - 1);
  };
  const std::uint32_t x = texel(wrapped(uv.x, texture.wrap_s), texture.width);
  const std::uint32_t y = texel(wrapped(uv.y, texture.wrap_t), texture.height);
  return static_cast<float>(texture.alpha[std::size_t{y} * texture.width + x]) / 255.0f;
}

float bilinear(const BakedTexture& texture, const V2f& uv) {
  const int side = static_cast<int>(texture.size);
  const float x = uv.x * static_cast<float>(side) - 0.5f,
              y = uv.y * static_cast<float>(side) - 0.5f;
  const auto texel = [&](int u, int v) {
    return texture.ao[static_cast<std::size_t>(std::clamp(v, 0, side - 1) * side +
                                               std::clamp(u, 0, side - 1))];
  };
  const int u = static_cast<int>(std::floor(x)), v = static_cast<int>(std::floor(y));
  const float a = x - std::floor(x), b = y - std::floor(y);
  return (1 - b) * ((1 - a) * texel(u, v) + a * texel(u + 1, v)) +
         b * ((1 - a) * texel(u, v + 1) + a * texel(u + 1, v + 1));
}

/// A corner on the screen: x and y in samples, z: the distance along the view direction.
struct ScreenCorner {
  float x = 0, y = 0, z = 0;
};

/// A corner of a part of a triangle: its place before the camera, and in the triangle.
struct PartCorner {
  V3f point;
  std::array<float, 3> weights{};
};

/// The part of a triangle whose depths, -z, are at least `near`: a convex polygon, or nothing
/// (Sutherland and Hodgman, "Reentrant Polygon Clipping", 1974).
std::vector<PartCorner> clip_to_depth(const std::array<V3f, 3>& points, float near) {
  std::vector<PartCorner> part;
  for (std::size_t k = 0; k < 3; ++k) {
    const std::size_t next = (k + 1) % 3;
    const float depth = -points[k].z, next_depth = -points[next].z;
    PartCorner corner{points[k], {}};
    corner.weights[k] = 1;
    if (depth >= near) part.push_back(corner);
    if ((depth >= near) == (next_depth >= near)) continue;
    const float along = (near - depth) / (next_depth - depth);
    corner.point = points[k] + (points[next] - points[k]) * along;
    corner.weights[k] = 1 - along;
    corner.weights[next] = along;
    part.push_back(corner);
  }
  return part;
}

class Screen {
 public:
  Screen(const Camera& camera, int width, int height)
      : camera_(camera),
        to_camera_(camera.to_world.inverse()),
        width_(width * kSubpixels),
        height_(height * kSubpixels),
        depth_(static_cast<std::size_t>(width_) * static_cast<std::size_t>(height_),
               std::numeric_limits<float>::infinity()),
        ao_(depth_.size(), kBackground) {}

  /// Camera space: behind the camera z is positive.
  [[nodiscard]] V3f before_camera(const V3f& world) const { return world * to_camera_; }

  /// Calls value(weights), barycentric in space, at visible samples of a triangle in camera space.
  /// It returns AO, or a negative number where the triangle is cut out.
  template <class Value>
  void draw(const std::array<V3f, 3>& points, Value value) {
    const float nearest = -std::max({points[0].z, points[1].z, points[2].z});
    const float near = -kNearShare * std::min({points[0].z, points[1].z, points[2].z});
    if (!(near > 0)) return;
    if (nearest >= near)
      return draw_part({project(points[0]), project(points[1]), project(points[2])}, value);
    const std::vector<PartCorner> part = clip_to_depth(points, near);
    for (std::size_t k = 2; k < part.size(); ++k) {
      const std::array<const PartCorner*, 3> fan{&part[0], &part[k - 1], &part[k]};
      draw_part({project(fan[0]->point), project(fan[1]->point), project(fan[2]->point)},
                [&](const std::array<float, 3>& w) {
                  std::array<float, 3> weights{};
                  for (std::size_t i = 0; i < 3; ++i)
                    for (std::size_t j = 0; j < 3; ++j) weights[i] += w[j] * fan[j]->weights[i];
                  return value(weights);
                });
    }
  }

  /// Means of the samples, as sRGB.
  [[nodiscard]] ByteImage image() const {
    ByteImage image{width_ / kSubpixels, height_ / kSubpixels, 1, {}};
    for (int y = 0; y < image.height; ++y) {
      for (int x = 0; x < image.width; ++x) {
        float sum = 0;
        for (int v = 0; v < kSubpixels; ++v)
          for (int u = 0; u < kSubpixels; ++u)
            sum += ao_[static_cast<std::size_t>(y * kSubpixels + v) *
                           static_cast<std::size_t>(width_) +
                       static_cast<std::size_t>(x * kSubpixels + u)];
        image.bytes.push_back(srgb(sum / (kSubpixels * kSubpixels)));
      }
    }
    return image;
  }

 private:
  [[nodiscard]] ScreenCorner project(const V3f& p) const {
    const float half = camera_.kind == Camera::Kind::perspective
                           ? -p.z * std::tan(camera_.fov_y / 2)
                           : camera_.half_height;
    const float scale = 0.5f * static_cast<float>(height_) / half;
    return {0.5f * static_cast<float>(width_) + p.x * scale,
            0.5f * static_cast<float>(height_) - p.y * scale, -p.z};
  }

  /// All of `c` are in front of the camera.
  template <class Value>
  void draw_part(const std::array<ScreenCorner, 3>& c, Value value) {
    const float area =
        (c[1].x - c[0].x) * (c[2].y - c[0].y) - (c[2].x - c[0].x) * (c[1].y - c[0].y);
    if (area == 0 || !std::isfinite(area)) return;
    const int x0 = first(std::min({c[0].x, c[1].x, c[2].x}));
    const int x1 = last(std::max({c[0].x, c[1].x, c[2].x}), width_);
    const int y0 = first(std::min({c[0].y, c[1].y, c[2].y}));
    const int y1 = last(std::max({c[0].y, c[1].y, c[2].y}), height_);
    for (int y = y0; y <= y1; ++y) {
      for (int x = x0; x <= x1; ++x) {
        const float px = static_cast<float>(x) + 0.5f, py = static_cast<float>(y) + 0.5f;
        std::array<float, 3> w{};
        for (std::size_t k = 0; k < 3; ++k) {
          const ScreenCorner &a = c[(k + 1) % 3], &b = c[(k + 2) % 3];
          w[k] = ((a.x - px) * (b.y - py) - (b.x - px) * (a.y - py)) / area;
        }
        if (w[0] < 0 || w[1] < 0 || w[2] < 0) continue;
        draw_sample(static_cast<std::size_t>(y) * static_cast<std::size_t>(width_) +
                        static_cast<std::size_t>(x),
                    c, w, value);
      }
    }
  }

  static int first(float x) { return static_cast<int>(std::clamp(x - 0.5f, 0.0f, 1e6f)); }
  static int last(float x, int size) {
    return static_cast<int>(std::clamp(x + 0.5f, -1.0f, static_cast<float>(size - 1)));
  }
  static std::uint8_t srgb(float linear) {
    const float encoded = srgb_from_linear(std::clamp(linear, 0.0f, 1.0f));
    return static_cast<std::uint8_t>(std::lround(encoded * 255.0f));
  }

  template <class Value>
  void draw_sample(std::size_t i, const std::array<ScreenCorner, 3>& c, std::array<float, 3> w,
                   Value value) {
    float z = w[0] * c[0].z + w[1] * c[1].z + w[2] * c[2].z;
    if (camera_.kind == Camera::Kind::perspective) {
      z = 1 / (w[0] / c[0].z + w[1] / c[1].z + w[2] / c[2].z);
      for (std::size_t k = 0; k < 3; ++k) w[k] *= z / c[k].z;
    }
    if (z >= depth_[i]) return;
    const float ao = value(w);
    if (ao < 0) return;
    depth_[i] = z;
    ao_[i] = ao;
  }

  const Camera& camera_;
  M44f to_camera_;
  int width_, height_;
  std::vector<float> depth_, ao_;
};

/// Opacity and AO of one mesh's triangles.
class ShadedMesh {
 public:
  ShadedMesh(const Scene& scene, std::uint32_t mesh, const BakeResult& result)
      : scene_(scene), mesh_(scene.meshes[mesh]), result_(result), index_(mesh) {}

  /// Negative where the triangle is cut out.
  [[nodiscard]] float value(std::size_t triangle, std::uint32_t instance,
                            const std::array<float, 3>& w) const {
    const std::uint32_t* corner = &mesh_.indices[3 * triangle];
    const Material& material = scene_.materials[mesh_.materials[triangle]];
    if (material.alpha_mode != AlphaMode::opaque && opacity(material, corner, w) < 0.5f) return -1;
    if (!result_.instance_ao.empty()) return result_.instance_ao[instance];
    if (result_.texture.size > 0) {
      if (result_.texture.layout.corners[index_].empty()) return 1;
      const V2f* uv = &result_.texture.layout.corners[index_][3 * triangle];
      return bilinear(result_.texture, uv[0] * w[0] + uv[1] * w[1] + uv[2] * w[2]);
    }
    const std::vector<float>& ao = result_.meshes[index_].ao;
    if (ao.empty()) return 1;
    return ao[corner[0]] * w[0] + ao[corner[1]] * w[1] + ao[corner[2]] * w[2];
  }

 private:
  [[nodiscard]] float opacity(const Material& material, const std::uint32_t* corner,
                              const std::array<float, 3>& w) const {
    float alpha = material.alpha;
    if (material.alpha_texture >= 0 && !mesh_.uvs.empty()) {
      const V2f uv =
          mesh_.uvs[corner[0]] * w[0] + mesh_.uvs[corner[1]] * w[1] + mesh_.uvs[corner[2]] * w[2];
      alpha *= alpha_at(scene_.textures[static_cast<std::size_t>(material.alpha_texture)], uv);
    }
    if (material.uses_vertex_alpha && !mesh_.vertex_alpha.empty())
      alpha *= mesh_.vertex_alpha[corner[0]] * w[0] + mesh_.vertex_alpha[corner[1]] * w[1] +
               mesh_.vertex_alpha[corner[2]] * w[2];
    if (material.alpha_mode == AlphaMode::mask) return alpha >= material.alpha_cutoff ? 1.0f : 0.0f;
    return alpha;
  }

  const Scene& scene_;
  const Mesh& mesh_;
  const BakeResult& result_;
  std::uint32_t index_;
};

}  // namespace

ByteImage draw_preview(const Scene& scene, const BakeResult& result, const Camera& camera,
                       int width, int height) {
  Screen screen(camera, width, height);
  for (std::uint32_t i = 0; i < scene.instances.size(); ++i) {
    const Instance& instance = scene.instances[i];
    const Mesh& mesh = scene.meshes[instance.mesh];
    if (mesh.has_strands()) continue;
    const ShadedMesh shaded(scene, instance.mesh, result);
    std::vector<V3f> corners(mesh.positions.size());
    for (std::size_t v = 0; v < corners.size(); ++v)
      corners[v] = screen.before_camera(mesh.positions[v] * instance.to_world);
    for (std::size_t t = 0; t < mesh.primitive_count(); ++t) {
      const std::uint32_t* corner = &mesh.indices[3 * t];
      screen.draw({corners[corner[0]], corners[corner[1]], corners[corner[2]]},
                  [&](const std::array<float, 3>& w) { return shaded.value(t, i, w); });
    }
  }
  return screen.image();
}

}  // namespace dapple

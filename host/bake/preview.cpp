#include "bake/preview.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

namespace dapple {
namespace {

/// Samples of a pixel along each axis.
constexpr int kSubpixels = 3;

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

  /// z <= 0: behind the camera.
  [[nodiscard]] ScreenCorner project(const V3f& world) const {
    const V3f p = world * to_camera_;
    const float half = camera_.kind == Camera::Kind::perspective
                           ? -p.z * std::tan(camera_.fov_y / 2)
                           : camera_.half_height;
    const float scale = 0.5f * static_cast<float>(height_) / half;
    return {0.5f * static_cast<float>(width_) + p.x * scale,
            0.5f * static_cast<float>(height_) - p.y * scale, -p.z};
  }

  /// Calls value(weights), barycentric in space, at visible samples of a triangle. It returns AO,
  /// or a negative number where the triangle is cut out.
  template <class Value>
  void draw(const std::array<ScreenCorner, 3>& c, Value value) {
    const float area =
        (c[1].x - c[0].x) * (c[2].y - c[0].y) - (c[2].x - c[0].x) * (c[1].y - c[0].y);
    if (area == 0 || !(c[0].z > 0 && c[1].z > 0 && c[2].z > 0)) return;
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
  static int first(float x) { return std::max(0, static_cast<int>(std::max(x - 0.5f, 0.0f))); }
  static int last(float x, int size) {
    return static_cast<int>(std::clamp(x + 0.5f, -1.0f, static_cast<float>(size - 1)));
  }
  static std::uint8_t srgb(float linear) {  // IEC 61966-2-1
    const float x = std::clamp(linear, 0.0f, 1.0f);
    const float encoded = x <= 0.0031308f ? 12.92f * x : 1.055f * std::pow(x, 1 / 2.4f) - 0.055f;
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
    std::vector<ScreenCorner> corners(mesh.positions.size());
    for (std::size_t v = 0; v < corners.size(); ++v)
      corners[v] = screen.project(mesh.positions[v] * instance.to_world);
    for (std::size_t t = 0; t < mesh.primitive_count(); ++t) {
      const std::uint32_t* corner = &mesh.indices[3 * t];
      screen.draw({corners[corner[0]], corners[corner[1]], corners[corner[2]]},
                  [&](const std::array<float, 3>& w) { return shaded.value(t, i, w); });
    }
  }
  return screen.image();
}

}  // namespace dapple

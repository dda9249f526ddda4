// Opacities of a mesh's translucent triangles for Embree's filters, in float. In: a triangle and
// barycentric coordinates. Out: its opacity, which is a constant or factors times a texture, looked
// up bilinearly as glTF defines it. Shares no code with dapple's lookup, so that no error is in
// both.
#pragma once

#include <bit>
#include <cmath>
#include <cstdint>
#include <optional>
#include <vector>

#include "dapple/scene.hpp"

namespace dapple::bench {

/// The triangle's opacity in [0,1] if it is constant, else nothing.
std::optional<float> constant_opacity(const Scene& scene, const Mesh& mesh, std::size_t triangle);

/// The opacity of a strand's segment: the mean of its ends.
float segment_opacity(const Scene& scene, const Mesh& mesh, std::size_t segment);

class OpacityTable {
 public:
  /// Marks the geometry as curves, which do not stop rays that leave a strand.
  void set_strands() { strands_ = true; }
  [[nodiscard]] bool of_strands() const { return strands_; }
  void append(float opacity) { codes_.push_back(opacity); }

  /// Appends `triangle` of `mesh`, which gets the next index. Keeps pointers to the scene's
  /// textures.
  void append(const Scene& scene, const Mesh& mesh, std::size_t triangle);

  /// Opacity in [0,1] at Embree's barycentrics: weight u for the second corner, v for the third.
  [[nodiscard]] float opacity(unsigned triangle, float u, float v) const {
    const float code = codes_[triangle];
    return std::signbit(code) ? varying(std::bit_cast<std::uint32_t>(code) & ~kVarying, u, v)
                              : code;
  }

  [[nodiscard]] std::size_t size() const { return codes_.size(); }
  [[nodiscard]] std::size_t bytes() const;

 private:
  static constexpr std::uint32_t kVarying = 0x80000000u;

  /// Vertex alpha times base colour alpha times texture alpha, thresholded if cutoff >= 0.
  struct Varying {
    float uv[3][2];
    float alpha[3];
    float cutoff;
    const Texture* texture;  ///< or nullptr
  };

  [[nodiscard]] float varying(std::uint32_t index, float u, float v) const;

  std::vector<float> codes_;  ///< an opacity, or kVarying | index as its bits
  std::vector<Varying> varying_;
  bool strands_ = false;
};

}  // namespace dapple::bench

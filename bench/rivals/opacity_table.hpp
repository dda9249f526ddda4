// Opacity of a mesh's translucent triangles for Embree's filters, in float: one number where it
// is the same all over, else factors and a texture looked up bilinearly as glTF says. Apart from
// the product's own lookup, so that neither side inherits the other's mistakes.
#pragma once

#include <bit>
#include <cmath>
#include <cstdint>
#include <optional>
#include <vector>

#include "dapple/scene.hpp"

namespace dapple::bench {

/// The triangle's opacity in [0,1] if it is the same all over, else nothing.
std::optional<float> constant_opacity(const Scene& scene, const Mesh& mesh, std::size_t triangle);

/// Of a segment of a strand: its ends' mean.
float segment_opacity(const Scene& scene, const Mesh& mesh, std::size_t segment);

class OpacityTable {
 public:
  /// It is of curves: what leaves a strand is not stopped.
  void set_strands() { strands_ = true; }
  [[nodiscard]] bool of_strands() const { return strands_; }
  void append(float opacity) { codes_.push_back(opacity); }

  /// Appends `triangle` of `mesh`; opacities are then asked for by the order of appending. The
  /// scene's textures must stay where they are.
  void append(const Scene& scene, const Mesh& mesh, std::size_t triangle);

  /// In [0,1], at Embree's barycentrics: weight u of the second corner, v of the third.
  [[nodiscard]] float opacity(unsigned triangle, float u, float v) const {
    const float code = codes_[triangle];
    return std::signbit(code) ? varying(std::bit_cast<std::uint32_t>(code) & ~kVarying, u, v)
                              : code;
  }

  [[nodiscard]] std::size_t size() const { return codes_.size(); }
  [[nodiscard]] std::size_t bytes() const;

 private:
  static constexpr std::uint32_t kVarying = 0x80000000u;

  /// Vertex alpha times base colour alpha times the texture's; then thresholded if cutoff >= 0.
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

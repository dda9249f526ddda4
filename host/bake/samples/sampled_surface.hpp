// The surface of a mesh as a list of elements, each with a sequence of samples: triangles or
// vertices for values at vertices, texels for values of textures.
#pragma once

#include "bake/samples/surface_samples.hpp"

namespace dapple {

class SampledSurface {
 public:
  SampledSurface() = default;
  SampledSurface(const SampledSurface&) = delete;
  SampledSurface& operator=(const SampledSurface&) = delete;
  virtual ~SampledSurface() = default;

  /// Number of elements.
  [[nodiscard]] virtual std::size_t size() const = 0;
  [[nodiscard]] virtual bool can_be_sampled(std::size_t element) const = 0;
  /// Sample `index` of an element that can be sampled, of one of several independent sequences.
  [[nodiscard]] virtual SurfaceSample sample(std::size_t element, std::uint32_t index,
                                             std::uint32_t sequence) const = 0;
  /// The places whose values an element's samples are part of.
  [[nodiscard]] virtual std::array<std::uint32_t, 3> places(std::size_t element) const = 0;
};

}  // namespace dapple

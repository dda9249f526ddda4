// The bias of a picture's layers. In: BiasSums and the film's sums. Out: a Bias for each layer.
#pragma once

#include <map>
#include <string>
#include <vector>

#include "camera/view.hpp"
#include "dapple/bias.hpp"
#include "film/bias_sums.hpp"
#include "film/film_sums.hpp"
#include "film/traced_picture.hpp"

namespace dapple {

/// Layers that have a bias, "ao" and "light.NAME" by light, then "ao.back" and so on.
std::vector<std::string> bias_layers(const FilmLayout& layout, const std::vector<Light>& lights);

/// Samples of each pixel, in front and of those whose backs are traced.
struct SideSamples {
  std::vector<std::uint32_t> fronts, backs;  ///< backs: empty if there are none
};

/// Samples that were traced while `sums` were made. `samples`: all of each pixel. `group_bits`:
/// BackParams::group_bits.
SideSamples samples_of_bias(const BiasSums& sums, const HostView& film,
                            const std::vector<std::uint32_t>& samples, const FilmLayout& layout,
                            std::uint32_t group_bits);

/// The bias of each of these layers, over pixels that show geometry and have samples. `samples`: of
/// `sums`. `divisors`: of each layer, what values are divided by. Empty: nothing was compared.
std::vector<Bias> picture_bias(const BiasSums& sums, const HostView& film,
                               const SideSamples& samples, const FilmLayout& layout,
                               const View& view, const std::vector<double>& divisors);

}  // namespace dapple

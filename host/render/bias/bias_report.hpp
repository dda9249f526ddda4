// The bias of a picture's layers. In: BiasSums and the film's sums. Out: a Bias for each layer.
#pragma once

#include <string>
#include <vector>

#include "camera/view.hpp"
#include "dapple/bias.hpp"
#include "dapple/render.hpp"
#include "film/sums/bias_sums.hpp"
#include "film/sums/film_sums.hpp"
#include "film/traced_picture.hpp"

namespace dapple {

/// Samples of each pixel, in front and of those whose backs are traced.
struct SideSamples {
  std::vector<std::uint32_t> fronts, backs;  ///< backs: empty if there are none
};

/// Samples that were traced while `sums` were made. `samples`: all of each pixel. `group_bits`:
/// BackParams::group_bits.
SideSamples samples_of_bias(const BiasSums& sums, const HostView& film,
                            const std::vector<std::uint32_t>& samples, const FilmLayout& layout,
                            std::uint32_t group_bits);

/// The bias over pixels that show geometry and have samples. `samples`: of `sums`. `largest`:
/// FilmMoments::largest_values(). Empty: nothing was compared.
PictureBias picture_bias(const BiasSums& sums, const HostView& film, const SideSamples& samples,
                         const FilmLayout& layout, const View& view,
                         const std::vector<double>& largest);

/// Stores what errors and biases of lights are relative to. `largest`: TracedPicture::largest.
void add_largest_irradiances(RenderStatistics& statistics, const std::vector<double>& largest,
                             const FilmLayout& layout, const std::vector<Light>& lights);

/// Stores the bias of each layer in the statistics and the metadata of the result, which has its
/// film. A note says it if there is none although something is seen. `resumed`: the checkpoint that
/// the run went on from, or empty.
void add_bias(RenderResult& result, const TracedPicture& picture, const FilmLayout& layout,
              const std::vector<Light>& lights, const std::string& resumed);

}  // namespace dapple

// Cryptomatte layers (Friedman and Jones, "Fully Automatic ID Mattes with Support for Motion Blur
// and Transparency", 2015; Cryptomatte specification 1.2.0). In: for each pixel how many samples
// hit which objects and materials, and their names. Out: planes of ranked ids and coverages, and
// the attributes by which other programs find them.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "dapple/film.hpp"
#include "film/sums/matte_sums.hpp"

namespace dapple {

/// MurmurHash3_x86_32 with seed 0 (Appleby).
std::uint32_t murmur3_32(std::string_view bytes);

/// The id of a name, as bits of a float: its hash, with the exponent clamped to [1,254], so that it
/// is a normal number.
std::uint32_t matte_id(std::string_view name);

/// Names by the numbers that MatteSums has.
struct MatteNames {
  std::vector<std::string> objects, materials;
};

/// Adds the layers crypto_object00 and crypto_material00 as far as they are requested, up to 02 as
/// the number of names needs them, and their attributes. `samples`: of each pixel.
void add_cryptomattes(Film& film, const MatteSums& sums, const std::vector<std::uint32_t>& samples,
                      const MatteNames& names, const Cryptomattes& wanted);

}  // namespace dapple

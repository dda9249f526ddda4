// What tracing a picture leaves: its sums, still on the device, and what is known of them. The film is
// made from it (film_sums.hpp).
#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "device/context.hpp"

namespace dapple {

struct TracedPicture {
  HostView sums;                       ///< std::int64_t, as FilmLayout says
  std::vector<std::uint32_t> samples;  ///< of each pixel; 0 only where interrupted
  /// With a target, unless interrupted before they are known: standard errors by pass (AO, then the
  /// lights, these relative to their largest unoccluded irradiance) and pixel.
  std::vector<std::vector<float>> errors;
  std::map<std::string, double> pass_seconds;  ///< device seconds by label, earlier runs' too
  std::size_t queue_bytes = 0;
  bool interrupted = false;
};

}  // namespace dapple

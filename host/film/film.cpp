// Films as values: finds planes, and checks whether a film can be written. Reads and writes no
// files.
#include "dapple/film.hpp"

#include <algorithm>
#include <cstdint>
#include <set>

#include "film/film_defect.hpp"

namespace dapple {
namespace {

constexpr std::size_t kMaxChannelNameLength = 255;  // EXR cuts longer names

}  // namespace

const Plane* Film::find(const std::string& channel) const {
  const auto found = std::find_if(planes.begin(), planes.end(),
                                  [&](const Plane& plane) { return plane.channel == channel; });
  return found == planes.end() ? nullptr : &*found;
}

std::string film_defect(const Film& film) {
  const PixelRect& window = film.data_window;
  if (film.width < 1 || film.height < 1) return "the film has no pixels";
  if (window.width() < 1 || window.height() < 1) return "the data window is empty";
  if (film.planes.empty()) return "the film has no planes";

  const std::int64_t area = std::int64_t{window.width()} * window.height();
  std::set<std::string> seen;
  for (const Plane& plane : film.planes) {
    const std::string name = "channel " + plane.channel;
    if (plane.channel.empty()) return "a plane has no channel name";
    if (plane.channel.size() > kMaxChannelNameLength)
      return name + ": the name is too long for EXR";
    if (!seen.insert(plane.channel).second) return name + " is there twice";
    if (static_cast<std::int64_t>(plane.pixels.size()) != area) {
      return name + " has " + std::to_string(plane.pixels.size()) + " pixels, the data window " +
             std::to_string(area);
    }
  }
  return {};
}

}  // namespace dapple

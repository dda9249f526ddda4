// Films as values: finds planes, checks whether a film can be written, and makes names that EXR
// accepts. Reads and writes no files.
#include "dapple/film.hpp"

#include <algorithm>
#include <cstdint>
#include <set>

#include "film/film_defect.hpp"

namespace dapple {
namespace {

// EXR cuts channel names at 255 bytes; this leaves room for "light." and ".R" around it.
constexpr std::size_t kLongestChannelName = 255;
constexpr std::size_t kLongestLayerName = 200;

bool is_name_character(char c) {
  return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '_';
}

// The second and later bytes of a UTF-8 character. In "größe" the characters ö and ß become one
// underscore each.
bool continues_character(char c) { return (static_cast<unsigned char>(c) & 0xC0U) == 0x80U; }

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
    if (plane.channel.size() > kLongestChannelName) return name + ": the name is too long for EXR";
    if (!seen.insert(plane.channel).second) return name + " is there twice";
    if (static_cast<std::int64_t>(plane.pixels.size()) != area) {
      return name + " has " + std::to_string(plane.pixels.size()) + " pixels, the data window " +
             std::to_string(area);
    }
  }
  return {};
}

std::string layer_name(const std::string& text) {
  std::string name;
  for (const char c : text) {
    if (name.size() == kLongestLayerName) break;
    if (!continues_character(c)) name += is_name_character(c) ? c : '_';
  }
  return name.empty() ? "unnamed" : name;
}

}  // namespace dapple

// Reads HAIR files: see hair_file.hpp. All counts are compared with the file's size, in 64-bit
// arithmetic, before memory is allocated.
#include "scene/hair_file.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>
#include <new>

#include "scene/check/finite.hpp"
#include "scene/check/numeric_range.hpp"
#include "scene/message.hpp"
#include "scene/regular_file.hpp"

namespace dapple {
namespace {

constexpr FileKind kHairFile{"HAIR file"};
constexpr std::uint64_t kMaxPoints = std::uint64_t{1} << 28;
constexpr std::uint64_t kHeaderBytes = 128;

// One bit for each array that a file may have. The arrays follow each other in this order.
constexpr std::uint32_t kSegments = 1;
constexpr std::uint32_t kPoints = 2;
constexpr std::uint32_t kThickness = 4;
constexpr std::uint32_t kTransparency = 8;
constexpr std::uint32_t kColors = 16;
constexpr std::uint32_t kAllArrays = 31;

struct Header {
  std::uint32_t strands, points, arrays, segments;
  float thickness, transparency;
  float color[3];
};

template <typename T>
T load(const std::uint8_t* bytes) {
  T value;
  std::memcpy(&value, bytes, sizeof value);
  return value;
}

Header read_header(std::span<const std::uint8_t> bytes, const std::string& path) {
  constexpr std::uint8_t kMagic[] = {'H', 'A', 'I', 'R'};
  if (bytes.size() < 4 || !std::equal(std::begin(kMagic), std::end(kMagic), bytes.begin()))
    fail(path, "is not a HAIR file (it does not begin with \"HAIR\")");
  if (bytes.size() < kHeaderBytes)
    fail(path, "ends in its header (it has {} bytes of {})", bytes.size(), kHeaderBytes);
  Header header{};
  static_assert(sizeof header == 36);
  std::memcpy(&header, bytes.data() + 4, sizeof header);
  if ((header.arrays & ~kAllArrays) != 0)
    fail(path, "has arrays that the format does not know (its bits are {:#x})", header.arrays);
  if ((header.arrays & kPoints) == 0) fail(path, "has no array of points");
  if (header.points > kMaxPoints)
    fail(path, "has {} points (at most {})", grouped(header.points), grouped(kMaxPoints));
  return header;
}

/// The arrays of a file, as bytes without alignment; null for an array that the file lacks.
struct Arrays {
  const std::uint8_t* segments = nullptr;      ///< one uint16 per strand
  const std::uint8_t* points = nullptr;        ///< three floats per point
  const std::uint8_t* thickness = nullptr;     ///< one float per point
  const std::uint8_t* transparency = nullptr;  ///< one float per point
  const std::uint8_t* colors = nullptr;        ///< three floats per point
};

Arrays find_arrays(const Header& header, std::span<const std::uint8_t> bytes,
                   const std::string& path) {
  std::uint64_t end = kHeaderBytes;
  const auto next = [&](std::uint32_t array, std::uint64_t count,
                        std::uint64_t element) -> const std::uint8_t* {
    if ((header.arrays & array) == 0) return nullptr;
    const std::uint64_t begin = end;
    end += count * element;
    return begin <= bytes.size() ? bytes.data() + begin : nullptr;
  };
  Arrays arrays;
  arrays.segments = next(kSegments, header.strands, 2);
  arrays.points = next(kPoints, header.points, 12);
  arrays.thickness = next(kThickness, header.points, 4);
  arrays.transparency = next(kTransparency, header.points, 4);
  arrays.colors = next(kColors, header.points, 12);
  if (end <= bytes.size()) return arrays;
  fail(path, "ends early: {} strands and {} points need {} bytes, it has {}",
       grouped(header.strands), grouped(header.points), grouped(end), grouped(bytes.size()));
}

/// How many points each strand has, from its number of segments.
class StrandLengths {
 public:
  StrandLengths(const Header& header, const Arrays& arrays, const std::string& path)
      : segments_(arrays.segments), default_(header.segments) {
    std::uint64_t segments = 0, without = 0;
    if (segments_ == nullptr) {
      segments = std::uint64_t{header.strands} * default_;
      without = default_ == 0 ? header.strands : 0;
    } else {
      for (std::uint32_t s = 0; s < header.strands; ++s) {
        segments += segments_of(s);
        without += segments_of(s) == 0;
      }
    }
    const std::uint64_t points = segments + header.strands;
    // Some writers store one point for a strand without segments, others store none.
    empty_has_point_ = points == header.points;
    if (empty_has_point_ || points - without == header.points) return;
    fail(path, "has {} points, but its {} strands of {} segments take {}", grouped(header.points),
         grouped(header.strands), grouped(segments), grouped(points));
  }

  [[nodiscard]] std::uint64_t points_of(std::uint32_t strand) const {
    const std::uint64_t segments = segments_of(strand);
    return segments == 0 && !empty_has_point_ ? 0 : segments + 1;
  }

 private:
  [[nodiscard]] std::uint64_t segments_of(std::uint32_t strand) const {
    return segments_ == nullptr ? default_
                                : load<std::uint16_t>(segments_ + std::size_t{2} * strand);
  }

  const std::uint8_t* segments_;
  std::uint32_t default_;
  bool empty_has_point_ = true;
};

constexpr std::uint64_t kNoPoint = std::numeric_limits<std::uint64_t>::max();

[[noreturn]] void refuse(std::uint64_t point, const char* what, float value,
                         const std::string& path) {
  if (point == kNoPoint) fail(path, "its header has a {} of {:g}", what, value);
  fail(path, "point {} has a {} of {:g}", grouped(point), what, value);
}

/// Half of a thickness, in metres. The file's thickness may be 0 where a strand tapers; our radius
/// must be above 0.
float radius_of(float thickness, std::uint64_t point, const std::string& path) {
  if (!(thickness >= 0 && thickness <= kLargestCoordinate))
    refuse(point, "thickness", thickness, path);
  return std::max(thickness / 2, static_cast<float>(kSmallestLength));
}

float opacity_of(float transparency, std::uint64_t point, const std::string& path) {
  if (!std::isfinite(transparency)) refuse(point, "transparency", transparency, path);
  return 1 - std::clamp(transparency, 0.0f, 1.0f);
}

/// Colours are linear, in [0,1]; those that are not numbers become black.
V3f color_of(V3f color) {
  for (int channel = 0; channel < 3; ++channel)
    color[channel] = color[channel] > 0 ? std::min(color[channel], 1.0f) : 0.0f;
  return color;
}

/// Whether two points differ only by the rounding of their coordinates.
bool coincide(V3f a, V3f b) {
  constexpr float kRounding = std::numeric_limits<float>::epsilon();  // one or two steps
  const auto largest = [](V3f p) {
    return std::max({std::abs(p.x), std::abs(p.y), std::abs(p.z)});
  };
  return largest(b - a) <= kRounding * std::max(largest(a), largest(b));
}

/// Appends strands to a mesh, point after point, and counts the points, segments and strands that
/// it drops.
class StrandWriter {
 public:
  StrandWriter(const Header& header, const Arrays& arrays, const std::string& path)
      : arrays_(arrays), path_(path) {
    mesh_.name = "hair";
    if (arrays.thickness == nullptr) default_radius_ = radius_of(header.thickness, kNoPoint, path);
    mesh_.positions.reserve(header.points);
    mesh_.radii.reserve(header.points);
    if (arrays.transparency != nullptr) mesh_.vertex_alpha.reserve(header.points);
    if (arrays.colors != nullptr) mesh_.colors.reserve(header.points);
    mesh_.indices.reserve(std::size_t{2} * header.points);
    mesh_.materials.reserve(header.points);
  }

  /// Appends the strand of `count` points that begins at the file's point `first`. A point that
  /// repeats the previous one is left out; the next segment begins at the previous point, so that
  /// the strand has no gap. A point that is not finite ends the segments before it.
  void add(std::uint64_t first, std::uint64_t count) {
    if (is_speck(first, count)) {
      ++specks_;
      return;
    }
    std::uint64_t last = kNoPoint;  // the point at which the next segment begins
    bool written = false;           // point `last` is the mesh's last vertex
    bool has_segment = false;
    for (std::uint64_t i = first; i < first + count; ++i) {
      if (!is_finite(point(i))) {
        ++not_finite_;
        last = kNoPoint;
        written = false;
        continue;
      }
      if (last != kNoPoint && coincide(point(last), point(i))) {
        ++without_length_;
        continue;
      }
      if (last != kNoPoint) {
        if (!written) add_vertex(last);
        add_vertex(i);
        add_segment();
        has_segment = written = true;
      }
      last = i;
    }
    if (!has_segment) ++empty_strands_;
  }

  [[nodiscard]] std::vector<std::string> warnings() const {
    std::vector<std::string> lines;
    const auto warn = [&](std::uint64_t count, const char* what) {
      if (count > 0) lines.push_back(fmt::format("{}: dropped {} {}", path_, grouped(count), what));
    };
    warn(not_finite_, "points that are not finite");
    warn(without_length_, "segments without length");
    warn(specks_, "strands that are no longer than thick");
    warn(empty_strands_, "strands that have no segment");
    return lines;
  }

  [[nodiscard]] Mesh take() { return std::move(mesh_); }

 private:
  [[nodiscard]] V3f point(std::uint64_t i) const {
    const std::uint8_t* at = arrays_.points + 12 * i;
    return {load<float>(at), load<float>(at + 4), load<float>(at + 8)};
  }

  [[nodiscard]] float radius(std::uint64_t i) const {
    return arrays_.thickness == nullptr
               ? default_radius_
               : radius_of(load<float>(arrays_.thickness + 4 * i), i, path_);
  }

  /// Whether the total length of a strand is at most its thickness. Such a strand looks like a dot
  /// that consists of many overlapping segments.
  [[nodiscard]] bool is_speck(std::uint64_t first, std::uint64_t count) const {
    double length = 0;
    float thickest = 0;
    for (std::uint64_t i = first; i + 1 < first + count; ++i) {
      if (!is_finite(point(i)) || !is_finite(point(i + 1))) return false;
      length += (Imath::V3d(point(i + 1)) - Imath::V3d(point(i))).length();
      thickest = std::max({thickest, radius(i), radius(i + 1)});
    }
    return count > 1 && length <= 2 * double{thickest};
  }

  void add_vertex(std::uint64_t i) {
    mesh_.positions.push_back(point(i));
    mesh_.radii.push_back(radius(i));
    if (arrays_.colors != nullptr) {
      const std::uint8_t* at = arrays_.colors + 12 * i;
      mesh_.colors.push_back(color_of({load<float>(at), load<float>(at + 4), load<float>(at + 8)}));
    }
    if (arrays_.transparency == nullptr) return;
    mesh_.vertex_alpha.push_back(opacity_of(load<float>(arrays_.transparency + 4 * i), i, path_));
  }

  void add_segment() {
    const auto last = static_cast<std::uint32_t>(mesh_.positions.size()) - 1;
    mesh_.indices.insert(mesh_.indices.end(), {last - 1, last});
    mesh_.materials.push_back(0);
  }

  const Arrays& arrays_;
  const std::string& path_;
  Mesh mesh_;
  float default_radius_ = 0;
  std::uint64_t not_finite_ = 0, without_length_ = 0, specks_ = 0, empty_strands_ = 0;
};

Scene scene_of(const Header& header, const Arrays& arrays, const std::string& path) {
  const StrandLengths lengths(header, arrays, path);
  StrandWriter writer(header, arrays, path);
  std::uint64_t first = 0;
  for (std::uint32_t strand = 0; strand < header.strands && first < header.points; ++strand) {
    writer.add(first, lengths.points_of(strand));
    first += lengths.points_of(strand);
  }
  Scene scene;
  scene.source = path;
  scene.files = {path};
  scene.warnings = writer.warnings();
  Material hair;
  hair.name = "hair";
  hair.alpha_mode = AlphaMode::blend;
  hair.double_sided = true;
  if (arrays.transparency == nullptr) hair.alpha = opacity_of(header.transparency, kNoPoint, path);
  if (arrays.colors == nullptr)
    hair.color = color_of({header.color[0], header.color[1], header.color[2]});
  scene.materials.push_back(std::move(hair));
  scene.meshes.push_back(writer.take());
  scene.instances.emplace_back();
  if (scene.meshes[0].materials.empty()) fail(path, "has no strand that is longer than thick");
  return scene;
}

}  // namespace

bool is_hair_name(const std::string& path) { return path.ends_with(".hair"); }

Scene decode_hair(std::span<const std::uint8_t> bytes, const std::string& path) {
  const Header header = read_header(bytes, path);
  return scene_of(header, find_arrays(header, bytes, path), path);
}

void add_time_warning(const std::string& path, std::optional<double> seconds, Scene& scene) {
  if (seconds) scene.warnings.push_back(one_line(path + ": hair has no animations, and stays"));
}

Scene load_hair(const std::string& path) {
  try {
    return decode_hair(read_regular_file(path, path, kHairFile), path);
  } catch (const std::bad_alloc&) {
    throw Error(ErrorKind::failed, path + ": there is not enough memory to read it");
  }
}

}  // namespace dapple

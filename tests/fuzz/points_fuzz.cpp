// Reads any bytes as the file DAPPLE_FUZZ_FILE, points or suns (a target for each format). This
// gives an Error of kind input, or finite points with unit normals, or finite suns.
#include <cmath>
#include <string_view>

#include "dapple/error.hpp"
#include "fuzz/input_file.hpp"
#include "points/point_file.hpp"

namespace {

void require(bool condition) {
  if (!condition) __builtin_trap();
}

bool is_finite(const dapple::V3f& v) {
  return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z);
}

void read_any_points(const std::string& path) {
  const dapple::PointList list = dapple::read_points(path);
  require(list.normals.size() == list.points.size());
  for (const dapple::V3f& point : list.points) require(is_finite(point));
  for (const dapple::V3f& normal : list.normals) require(std::abs(normal.length() - 1) < 1e-5f);
}

void read_any_suns(const std::string& path) {
  for (const dapple::SunDirection& sun : dapple::read_suns(path))
    require(is_finite(sun.direction) && std::isfinite(sun.irradiance));
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  constexpr std::string_view kName = DAPPLE_FUZZ_FILE;
  static const dapple::fuzz::InputFile file{std::string(kName)};
  const std::string& path = file.fill(data, size);
  try {
    if (kName == "suns.csv")
      read_any_suns(path);
    else
      read_any_points(path);
  } catch (const dapple::Error& error) {
    require(error.kind() == dapple::ErrorKind::input);
  }
  return 0;
}

// Reads any bytes as points or suns; the first byte chooses the format. This gives an Error of kind
// input, or finite points with unit normals, or finite suns.
#include <cmath>

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
  static const dapple::fuzz::InputFile csv("points.csv"), npy("points.npy"), ply("points.ply"),
      suns("suns.csv");
  if (size == 0) return 0;
  const std::uint8_t format = data[0] % 4;
  ++data;
  --size;
  try {
    if (format == 0) read_any_points(csv.fill(data, size));
    if (format == 1) read_any_points(npy.fill(data, size));
    if (format == 2) read_any_points(ply.fill(data, size));
    if (format == 3) read_any_suns(suns.fill(data, size));
  } catch (const dapple::Error& error) {
    require(error.kind() == dapple::ErrorKind::input);
  }
  return 0;
}

// Cem Yuksel's .hair files as meshes, just as far as tests of traced hair need them:
// http://www.cemyuksel.com/research/hairmodels/ has the format.
#pragma once

#include <cstdint>
#include <cstring>
#include <fstream>
#include <iterator>
#include <string>
#include <vector>

#include "dapple/scene.hpp"

namespace dapple::hair_test {

/// Strands of the one radius `radius`, in the file's units times `scale`; all of material 0.
inline Mesh read_hair(const std::string& path, float radius, float scale) {
  std::ifstream file(path, std::ios::binary);
  const std::string bytes(std::istreambuf_iterator<char>(file), {});
  std::size_t at = 4;
  const auto take = [&]<class T>(T& value) {
    std::memcpy(&value, &bytes.at(at), sizeof value);
    at += sizeof value;
  };
  std::uint32_t strands = 0, points = 0, flags = 0, segments = 0;
  take(strands);
  take(points);
  take(flags);
  take(segments);
  at = 128;
  std::vector<std::uint16_t> counts(strands, static_cast<std::uint16_t>(segments));
  if (flags & 1) {
    for (std::uint16_t& count : counts) take(count);
  }
  Mesh mesh;
  for (const std::uint16_t count : counts) {
    for (std::uint32_t i = 0; i <= count; ++i) {
      V3f p;
      for (int k = 0; k < 3; ++k) take(p[k]);
      const auto here = static_cast<std::uint32_t>(mesh.positions.size());
      mesh.positions.push_back(V3f(p.x, p.z, -p.y) * scale);  // its z is up
      mesh.radii.push_back(radius);
      if (i == 0) continue;
      mesh.indices.insert(mesh.indices.end(), {here - 1, here});
      mesh.materials.push_back(0);
    }
  }
  return mesh;
}

}  // namespace dapple::hair_test

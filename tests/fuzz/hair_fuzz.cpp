// Reads any bytes as a HAIR file. This gives an Error of kind input, or strands whose indices are
// within bounds and whose numbers are finite and in range.
#include <cmath>

#include "dapple/error.hpp"
#include "scene/hair_file.hpp"

namespace {

void require(bool condition) {
  if (!condition) __builtin_trap();
}

void check(const dapple::Mesh& mesh, std::size_t materials) {
  require(!mesh.materials.empty() && mesh.indices.size() == 2 * mesh.materials.size());
  require(mesh.radii.size() == mesh.positions.size());
  require(mesh.vertex_alpha.empty() || mesh.vertex_alpha.size() == mesh.positions.size());
  for (const std::uint32_t index : mesh.indices) require(index < mesh.positions.size());
  for (const std::uint32_t material : mesh.materials) require(material < materials);
  for (const float radius : mesh.radii) require(radius > 0 && std::isfinite(radius));
  for (const float alpha : mesh.vertex_alpha) require(alpha >= 0 && alpha <= 1);
  for (const dapple::V3f& p : mesh.positions)
    require(std::isfinite(p.x) && std::isfinite(p.y) && std::isfinite(p.z));
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  try {
    const dapple::Scene scene = dapple::decode_hair({data, size}, "hair");
    check(scene.meshes.at(0), scene.materials.size());
  } catch (const dapple::Error& error) {
    require(error.kind() == dapple::ErrorKind::input);
  }
  return 0;
}

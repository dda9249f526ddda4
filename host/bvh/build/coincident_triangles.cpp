#include "bvh/build/coincident_triangles.hpp"

#include <oneapi/tbb/parallel_for.h>
#include <oneapi/tbb/parallel_sort.h>

#include <algorithm>
#include <array>
#include <utility>

#include "files/checksum.hpp"

namespace dapple {
namespace {

/// Returns a checksum that does not depend on the order of the corners.
Checksum corners_checksum(const Mesh& mesh, std::uint32_t triangle) {
  std::array<std::array<float, 3>, 3> corners{};
  for (std::size_t corner = 0; corner < 3; ++corner) {
    const V3f& at = mesh.positions[mesh.indices[3 * std::size_t{triangle} + corner]];
    corners[corner] = {at.x + 0.0f, at.y + 0.0f, at.z + 0.0f};  // -0 becomes 0
  }
  std::sort(corners.begin(), corners.end());
  return checksum({reinterpret_cast<const char*>(corners.data()), sizeof corners});
}

}  // namespace

std::vector<std::uint8_t> find_coincident(const Mesh& mesh,
                                          std::span<const std::uint32_t> triangles) {
  std::vector<std::pair<Checksum, std::uint32_t>> order(triangles.size());
  tbb::parallel_for(std::size_t{0}, triangles.size(), [&](std::size_t i) {
    order[i] = {corners_checksum(mesh, triangles[i]), static_cast<std::uint32_t>(i)};
  });
  tbb::parallel_sort(order);
  std::vector<std::uint8_t> coincident(triangles.size(), 0);
  for (std::size_t i = 1; i < order.size(); ++i) {
    if (order[i].first == order[i - 1].first)
      coincident[order[i].second] = coincident[order[i - 1].second] = 1;
  }
  return coincident;
}

}  // namespace dapple

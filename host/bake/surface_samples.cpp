#include "bake/surface_samples.hpp"

#include <algorithm>
#include <cmath>
#include <span>

namespace dapple {
namespace {

constexpr int kMinRays = 16;

/// A point of a quadrature rule: barycentric coordinates and the share of the area.
struct RulePoint {
  float a, b, c, weight;
};

/// Rules of 1, 3, 6 and 12 points, exact for polynomials of degree 1, 2, 4 and 6 (Dunavant, "High
/// Degree Efficient Symmetrical Gaussian Quadrature Rules for the Triangle", 1985).
std::span<const RulePoint> rule(int points) {
  static constexpr RulePoint kOne[] = {{1 / 3.0f, 1 / 3.0f, 1 / 3.0f, 1}};
  static constexpr RulePoint kThree[] = {{2 / 3.0f, 1 / 6.0f, 1 / 6.0f, 1 / 3.0f},
                                         {1 / 6.0f, 2 / 3.0f, 1 / 6.0f, 1 / 3.0f},
                                         {1 / 6.0f, 1 / 6.0f, 2 / 3.0f, 1 / 3.0f}};
  constexpr float kA = 0.816847572980459f, kB = 0.091576213509771f, kAreaA = 0.109951743655322f;
  constexpr float kC = 0.108103018168070f, kD = 0.445948490915965f, kAreaC = 0.223381589678011f;
  static constexpr RulePoint kSix[] = {{kA, kB, kB, kAreaA}, {kB, kA, kB, kAreaA},
                                       {kB, kB, kA, kAreaA}, {kC, kD, kD, kAreaC},
                                       {kD, kC, kD, kAreaC}, {kD, kD, kC, kAreaC}};
  constexpr float kE = 0.501426509658179f, kF = 0.249286745170910f, kAreaE = 0.116786275726379f;
  constexpr float kG = 0.873821971016996f, kH = 0.063089014491502f, kAreaG = 0.050844906370207f;
  constexpr float kI = 0.053145049844817f, kJ = 0.310352451033784f, kK = 0.636502499121399f,
                  kAreaI = 0.082851075618374f;
  static constexpr RulePoint kTwelve[] = {
      {kE, kF, kF, kAreaE}, {kF, kE, kF, kAreaE}, {kF, kF, kE, kAreaE}, {kG, kH, kH, kAreaG},
      {kH, kG, kH, kAreaG}, {kH, kH, kG, kAreaG}, {kI, kJ, kK, kAreaI}, {kI, kK, kJ, kAreaI},
      {kJ, kI, kK, kAreaI}, {kJ, kK, kI, kAreaI}, {kK, kI, kJ, kAreaI}, {kK, kJ, kI, kAreaI}};
  if (points < 3) return kOne;
  if (points < 6) return kThree;
  if (points < 12) return kSix;
  return kTwelve;
}

}  // namespace

SampleCounts sample_counts(int rays) {
  const int points = static_cast<int>(rule(rays / kMinRays).size());
  return {points, rays / points};
}

bool is_two_sided(const Material& material, BakeSides sides) {
  if (sides == BakeSides::automatic) return material.double_sided;
  return sides != BakeSides::front;
}

std::uint32_t hash_of(std::uint32_t a, std::uint32_t b) {
  std::uint32_t x = a * 0x9e3779b1u ^ (b + 0x7f4a7c15u) * 0x85ebca77u;
  x ^= x >> 16;
  x *= 0x21f0aaadu;  // Wellons, "Prospecting for Hash Functions", 2018
  x ^= x >> 15;
  x *= 0x735a2d97u;
  return x ^ x >> 15;
}

void sample_triangle(const Mesh& mesh, std::size_t triangle, const VertexGroups& groups,
                     bool two_sided, int points, std::vector<SurfaceSample>& samples) {
  const V3f cross = area_vector(mesh, triangle);
  const float twice_area = cross.length();
  if (!(twice_area > 0) || !std::isfinite(twice_area)) return;
  const std::uint32_t* corner = &mesh.indices[3 * triangle];
  for (const RulePoint& point : rule(points)) {
    const std::array<float, 3> barycentric{point.a, point.b, point.c};
    SurfaceSample sample;
    sample.normal = cross / twice_area;
    sample.two_sided = two_sided;
    for (std::size_t k = 0; k < 3; ++k) {
      sample.position += mesh.positions[corner[k]] * barycentric[k];
      sample.group[k] = groups.of_vertex[corner[k]];
      sample.weight[k] = twice_area * point.weight * barycentric[k];
    }
    samples.push_back(sample);
  }
}

std::vector<SurfaceSample> sample_vertices(const Mesh& mesh, const VertexGroups& groups,
                                           const std::vector<bool>& two_sided_triangles) {
  std::vector<SurfaceSample> of_group(groups.count);
  for (std::size_t t = 0; t < mesh.primitive_count(); ++t) {
    const V3f area = area_vector(mesh, t);
    for (std::size_t corner = 3 * t; corner < 3 * t + 3; ++corner) {
      const std::uint32_t vertex = mesh.indices[corner];
      SurfaceSample& sample = of_group[groups.of_vertex[vertex]];
      // The two sides of a folded sheet would cancel.
      sample.normal += sample.normal.dot(area) < 0 ? -area : area;
      sample.position = mesh.positions[vertex];
      sample.two_sided = sample.two_sided || two_sided_triangles[t];
      sample.group[0] = groups.of_vertex[vertex];
      sample.weight[0] = 1;
    }
  }
  std::erase_if(of_group, [](SurfaceSample& sample) {
    const float length = sample.normal.length();
    sample.normal /= length > 0 ? length : 1.0f;
    return !(length > 0) || !std::isfinite(length);
  });
  return of_group;
}

}  // namespace dapple

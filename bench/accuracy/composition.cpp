#include "accuracy/composition.hpp"

#include <algorithm>
#include <cmath>

#include "bvh/build/quantize_boxes.hpp"
#include "bvh/opacity/strand_coverage.hpp"
#include "bvh/opacity/texture_integrals.hpp"

namespace dapple::bench {
namespace {

/// The two axes across `axis`.
constexpr int first_across(int axis) { return (axis + 1) % 3; }
constexpr int second_across(int axis) { return (axis + 2) % 3; }

float face(const Box3f& box, int axis) {
  return box.size()[first_across(axis)] * box.size()[second_across(axis)];
}

/// A box with a constant opacity along each axis.
struct UniformBox {
  Box3f box;
  V3f opacity;
};

/// Opacity of `whole` along `axis`, if the transmittances of overlapping parts are multiplied. It
/// is a sum over the cells into which the sides of the parts divide the face.
float rectangle_opacity(const Box3f& whole, const std::vector<UniformBox>& parts, int axis) {
  const int u = first_across(axis), v = second_across(axis);
  std::vector<float> columns, rows;
  for (const UniformBox& part : parts) {
    columns.insert(columns.end(), {part.box.min[u], part.box.max[u]});
    rows.insert(rows.end(), {part.box.min[v], part.box.max[v]});
  }
  std::sort(columns.begin(), columns.end());
  std::sort(rows.begin(), rows.end());
  double occluded = 0;
  for (std::size_t i = 0; i + 1 < columns.size(); ++i) {
    for (std::size_t j = 0; j + 1 < rows.size(); ++j) {
      const float x = 0.5f * (columns[i] + columns[i + 1]), y = 0.5f * (rows[j] + rows[j + 1]);
      float transmittance = 1.0f;
      for (const UniformBox& part : parts) {
        const bool inside = x > part.box.min[u] && x < part.box.max[u] && y > part.box.min[v] &&
                            y < part.box.max[v];
        if (inside) transmittance *= 1.0f - part.opacity[axis];
      }
      occluded +=
          double{1.0f - transmittance} * (columns[i + 1] - columns[i]) * (rows[j + 1] - rows[j]);
    }
  }
  return std::min(1.0f, static_cast<float>(occluded / face(whole, axis)));
}

class Composer {
 public:
  Composer(const SceneBvh& bvh, const Scene& scene)
      : bvh_(bvh), integrals_(scene, bvh.textured), out_(bvh.nodes.size()) {}

  void node(std::uint32_t index) {
    const BvhNode& node = bvh_.nodes[index];
    for (unsigned slot = 0; slot < DAPPLE_BVH_WIDTH; ++slot) {
      out_[index][slot] = is_inner(node, slot) ? inner(node, slot) : leaf(node, slot);
    }
  }

  Compositions take() { return std::move(out_); }

 private:
  Composition inner(const BvhNode& node, unsigned slot) {
    const std::uint32_t below = child_node(node, slot);
    this->node(below);
    Composition made;
    std::vector<UniformBox> parts;
    for (unsigned s = 0; s < DAPPLE_BVH_WIDTH; ++s) {
      const Composition& part = out_[below][s];
      for (std::size_t k = 0; k < made.moments.size(); ++k) made.moments[k] += part.moments[k];
      const bool empty = bvh_.nodes[below].lower[0][s] > bvh_.nodes[below].upper[0][s];
      if (!empty) parts.push_back({child_box(bvh_.nodes[below], s), part.rectangles});
    }
    const Box3f whole = child_box(node, slot);
    for (int axis = 0; axis < 3; ++axis)
      made.rectangles[axis] = rectangle_opacity(whole, parts, axis);
    return made;
  }

  Composition leaf(const BvhNode& node, unsigned slot) const {
    Composition made;
    if (node.prim_base & DAPPLE_SEGMENTS) return strand_leaf(node, slot);
    const Box3f box = child_box(node, slot);
    V3f transmittance(1.0f);
    for (const LeafTriangle& triangle : leaf_triangles(bvh_, node, slot)) {
      const V3f across = 0.5f * triangle.edge1.cross(triangle.edge2);
      const float opacity = mean_opacity(triangle);
      for (int axis = 0; axis < 3; ++axis) {
        transmittance[axis] *=
            1.0f - opacity * std::min(1.0f, std::fabs(across[axis]) / face(box, axis));
      }
      add_moments(made, V3d(across), opacity);
    }
    made.rectangles = V3f(1.0f) - transmittance;
    return made;
  }

  Composition strand_leaf(const BvhNode& node, unsigned slot) const {
    Composition made;
    const Box3f box = child_box(node, slot);
    V3f transmittance(1.0f);
    NormalMoments normals;
    for (const StrandSegment& segment : leaf_segments(bvh_, node, slot)) {
      SurfaceAreas occluded;
      add_surface(segment, normals, occluded);
      for (int axis = 0; axis < 3; ++axis) {
        transmittance[axis] *= 1.0f - std::min(1.0f, occluded.other[axis] / face(box, axis));
      }
    }
    for (std::size_t k = 0; k < 6; ++k) made.moments[k] = normals.sum[k];
    made.rectangles = V3f(1.0f) - transmittance;
    return made;
  }

  static void add_moments(Composition& made, const V3d& across, double opacity) {
    const double area = across.length();
    if (!(area > 0)) return;
    const V3d weighted = across * (opacity / area);
    const double products[6] = {weighted.x * across.x, weighted.y * across.y,
                                weighted.z * across.z, weighted.x * across.y,
                                weighted.y * across.z, weighted.z * across.x};
    for (std::size_t k = 0; k < 6; ++k) made.moments[k] += products[k];
  }

  float mean_opacity(const LeafTriangle& triangle) const {
    if (triangle.opacity >= 0.0f) return triangle.opacity;
    const auto index = static_cast<std::size_t>(-triangle.opacity - 1.0f);
    return integrals_.of(bvh_.textured[index]).mean(1.0f / 3.0f, 1.0f / 3.0f, 1.0f);
  }

  const SceneBvh& bvh_;
  TextureIntegrals integrals_;
  Compositions out_;
};

}  // namespace

V3f Composition::correlation() const {
  const auto of = [this](int product, int a, int b) {
    const double scale = std::sqrt(moments[a] * moments[b]);
    return scale > 0 ? static_cast<float>(moments[product] / scale) : 0.0f;
  };
  return {of(3, 0, 1), of(4, 1, 2), of(5, 2, 0)};
}

Compositions compose(const SceneBvh& bvh, const Scene& scene) {
  Composer composer(bvh, scene);
  for (const std::uint32_t root : object_roots(bvh)) composer.node(root);
  return composer.take();
}

}  // namespace dapple::bench

// Computes directional opacity bottom-up: rasterizes each leaf into a coverage map, and composites
// the maps of a node's children into the node's own.
#include "bvh/opacity/prefilter.hpp"

#include <tbb/parallel_for.h>

#include <array>
#include <cmath>
#include <optional>
#include <utility>

#include "bvh/opacity/quantize_opacity.hpp"
#include "bvh/opacity/strand_coverage.hpp"
#include "bvh/storage/segment_block.hpp"

namespace dapple {
namespace {

/// Subtrees with fewer primitives run in their parent's task.
constexpr std::uint32_t kTaskPrimitives = 2048;

/// Maximum number of primitives of a leaf.
constexpr std::size_t kMaxInLeaf = kMaxCovering / 2;

/// The primitives of a leaf as triangles to rasterize, with the sums of their areas and normals.
struct Leaf {
  /// Triangles, the same for all axes; or strips of strand segments, two triangles a segment,
  /// separately for each axis.
  std::array<CoveringTriangle, 3 * kMaxCovering> storage;
  std::size_t count = 0;  ///< primitives
  std::size_t drawn = 0;  ///< triangles for one axis
  bool facing = false;    ///< whether each axis has its own triangles
  bool textured = false;
  bool one_strand = false;
  NormalMoments normals;
  SurfaceAreas areas;
  WallAreas walls;
  [[nodiscard]] std::span<const CoveringTriangle> along(int axis) const {
    return {storage.data() + (facing ? static_cast<std::size_t>(axis) * drawn : 0), drawn};
  }
  [[nodiscard]] Covering covering() const { return {along(0), along(1), along(2)}; }
};

TriangleIntegral integral_of(const CoveringTriangle& triangle,
                             std::span<const TexturedTriangle> textured,
                             const TextureIntegrals& integrals) {
  return integrals.of(textured[static_cast<std::size_t>(-triangle.opacity - 1.0f)]);
}

/// The integrals of a leaf's textured triangles.
class LeafTextures {
 public:
  LeafTextures(const Leaf& leaf, std::span<const TexturedTriangle> textured,
               const TextureIntegrals& integrals) {
    if (!leaf.textured) return;
    for (const CoveringTriangle& triangle : leaf.along(0))
      if (triangle.opacity < 0)
        found_[count_++].emplace(triangle.opacity, integral_of(triangle, textured, integrals));
  }

  /// Of a textured triangle of the leaf.
  [[nodiscard]] const TriangleIntegral& of(const CoveringTriangle& triangle) const {
    std::size_t i = 0;
    while (found_[i]->first != triangle.opacity) ++i;
    return found_[i]->second;
  }

 private:
  /// With the triangles' codes.
  std::array<std::optional<std::pair<float, TriangleIntegral>>, kMaxInLeaf> found_;
  std::size_t count_ = 0;
};

/// Sums over what is seen along the axes, weighted by occluding area.
struct MassSums {
  V3f position{0, 0, 0};  ///< from the centre of the box, half sizes
  V3f seen{0, 0, 0};      ///< occluding area of the views that see this axis
  float square = 0, area = 0;

  /// Adds a view along `axis`: its moments per opacity of 1, and the weight of these.
  void add(int axis, const OpacityMoments& moments, float opacity, float weight) {
    const int column = column_axis(axis), row = row_axis(axis);
    position[column] += weight * moments.column;
    position[row] += weight * moments.row;
    seen[column] += weight * opacity;
    seen[row] += weight * opacity;
    square += weight * moments.square;
    area += weight * opacity;
  }
  [[nodiscard]] MassShape shape() const {
    if (!(area > 0.0f)) return {};
    V3f centroid;
    for (int axis = 0; axis < 3; ++axis)
      centroid[axis] = seen[axis] > 0.0f ? position[axis] / seen[axis] : 0.0f;
    return mass_shape_of(centroid, square / area);
  }
};

/// An axis across a view, from which positions are converted to half sizes from the middle.
struct ViewedSide {
  int axis;
  float from, halves;

  ViewedSide(const Box3f& box, int k)
      : axis(k), from(box.min[k]), halves(2.0f / (box.max[k] - box.min[k])) {}

  /// Adds the mean square of the triangle's positions to `square`, and returns their mean.
  float add_square(const CoveringTriangle& t, float& square) const {
    const float a = (t.vertex[axis] - from) * halves - 1.0f;
    const float b = a + t.edge1[axis] * halves, c = a + t.edge2[axis] * halves;
    square += (a * a + b * b + c * c + a * b + b * c + c * a) / 6.0f;
    return (a + b + c) / 3.0f;
  }
};

/// Returns the opacity of a single layer: the result of map_opacity() for a map of infinitely many
/// cells.
NodeOpacity layer_opacity(const Leaf& leaf, const Box3f& box) {
  NodeOpacity opacity;
  opacity.normals = leaf.normals;
  float variance = 0, greatest = 0;
  MassSums mass;
  for (int axis = 0; axis < 3; ++axis) {
    const float face = face_area(box, axis);
    if (!(face > 0.0f)) continue;
    const ViewedSide column(box, column_axis(axis)), row(box, row_axis(axis));
    float occluded = 0, square = 0;
    for (const CoveringTriangle& t : leaf.along(axis)) {
      const float share = 0.5f * std::fabs(t.edge1.cross(t.edge2)[axis]) / face;
      occluded += t.opacity * share;
      square += t.opacity * t.opacity * share;
      OpacityMoments moments{};
      moments.column = column.add_square(t, moments.square);
      moments.row = row.add_square(t, moments.square);
      mass.add(axis, moments, 1.0f, t.opacity * share * face);
    }
    opacity.axes[axis] = occluded = std::min(occluded, 1.0f);
    variance += std::max(0.0f, square - occluded * occluded);
    greatest += occluded * (1.0f - occluded);
  }
  if (greatest > 1e-6f) opacity.clumping = std::min(1.0f, variance / greatest);
  opacity.mass = mass.shape();
  return opacity;
}

class Prefilter {
 public:
  Prefilter(const PrefilterTask& task, const TextureIntegrals& integrals)
      : task_(task), object_(task.object), tree_(task.tree), integrals_(integrals) {}

  Summary node(std::uint32_t index) {
    const WideNode& wide = tree_.nodes[index];
    if (wide.child_count == 0) return task_.summaries->summary(index);
    const std::uint32_t own = task_.node_of.empty() ? index : task_.node_of[index];
    const auto children = tree_.children_of(wide);
    NodeCoverage coverage(wide.box);
    NormalMoments normals;
    WallAreas walls;
    const auto add_inner = [&](unsigned slot, const Summary& below) {
      coverage.add(below.map, children[slot].box, below.areas);
      normals.add(below.normals);
      walls.add(below.walls);
      set_inner_opacity(own, slot, children[slot], below, wide.primitives);
    };
    const bool parallel = wide.primitives > kTaskPrimitives;
    std::vector<Summary> below(parallel ? wide.child_count : 0);
    if (parallel) {
      tbb::parallel_for(0u, wide.child_count, [&](unsigned slot) {
        if (!children[slot].count) below[slot] = node(children[slot].first);
      });
    }
    // In the order of the slots, so that the bits do not depend on the order of the tasks.
    for (unsigned slot = 0; slot < wide.child_count; ++slot) {
      if (children[slot].count) {
        const Leaf leaf = add_leaf(own, slot, children[slot].box, coverage);
        normals.add(leaf.normals);
        walls.add(leaf.walls);
      } else {
        add_inner(slot, parallel ? below[slot] : node(children[slot].first));
      }
    }
    return {coverage.map(), normals, coverage.areas(), walls};
  }

 private:
  /// Sets the opacity of child `slot`, an inner node, of the object's node `own`. `below`: summary
  /// of the child; `primitives`: number of primitives in `own`.
  void set_inner_opacity(std::uint32_t own, unsigned slot, const WideChild& child,
                         const Summary& below, std::uint32_t primitives) const {
    const WideNode& wide = tree_.nodes[child.first];
    const NodeOpacity* measured = nullptr;
    if (wide.child_count == 0) {
      measured = task_.summaries->measured(child.first);
      if (!measured) {
        set_kept_opacity(object_.nodes[own], slot, task_.record->nodes[own], below.areas,
                         below.normals, child.box);
        return;
      }
    }
    NodeOpacity opacity = measured ? *measured : map_opacity(below.map, below.normals, child.box);
    set_opacity(own, slot, opacity, child.box, below.areas, below.walls);
    if (task_.record && !measured && wide.primitives <= kRigidPrimitives &&
        (primitives > kRigidPrimitives || own == 0)) {
      task_.record->subtrees[task_.record->subtree_at(child.first)].keep(below.map, below.areas,
                                                                         child.box);
    }
  }

  /// Moving triangles remain connected, or are built again (refit/vertex_places.hpp), so a node
  /// that is refitted stays a wall or not.
  void set_opacity(std::uint32_t own, unsigned slot, NodeOpacity& opacity, const Box3f& box,
                   const SurfaceAreas& areas, const WallAreas& walls) const {
    opacity.wall = task_.node_of.empty() ? is_wall(walls, opacity.normals, box)
                                         : bvh_is_wall(object_.nodes[own].depth, slot);
    const float factor = set_child_opacity(object_.nodes[own], slot, opacity, box);
    if (task_.record) task_.record->nodes[own].keep(slot, opacity.axes, areas, box, factor);
  }

  /// Sets the leaf's opacity, puts it into its node's coverage and returns it.
  Leaf add_leaf(std::uint32_t own, unsigned slot, const Box3f& box, NodeCoverage& coverage) const {
    const BvhNode& node = object_.nodes[own];
    const Leaf leaf =
        node.prim_base & DAPPLE_SEGMENTS ? load_strands(node, slot) : load_triangles(node, slot);
    const SharedEdges edges(leaf.covering());
    if (leaf.facing ? leaf.one_strand : !leaf.textured && edges.is_single_layer()) {
      coverage.add_layer(leaf.covering(), edges, box, leaf.areas);
      NodeOpacity opacity = layer_opacity(leaf, box);
      set_opacity(own, slot, opacity, box, leaf.areas, leaf.walls);
      return leaf;
    }
    CoverageMap map;
    const LeafTextures textures(leaf, object_.textured, integrals_);
    cover(map, box, leaf.covering(), edges,
          [&](const CoveringTriangle& t, float u, float v, float share) {
            return textures.of(t).mean(u, v, share);
          });
    coverage.add(map, box, leaf.areas);
    NodeOpacity opacity = map_opacity(map, leaf.normals, box);
    set_opacity(own, slot, opacity, box, leaf.areas, leaf.walls);
    return leaf;
  }

  Leaf load_strands(const BvhNode& node, unsigned slot) const {
    Leaf leaf;
    std::array<StrandSegment, kMaxInLeaf> segments;
    for (std::uint32_t i = bvh_leaf_begin(&node, slot); i < bvh_leaf_end(node.leaf_end, slot);
         ++i) {
      segments[leaf.count] =
          unpack_segment(object_.segments[bvh_block_index(bvh_block(node.prim_base, i))], i % 8);
      add_surface(segments[leaf.count++], leaf.normals, leaf.areas);
    }
    const std::span all(segments.data(), leaf.count);
    leaf.facing = true;
    leaf.drawn = 2 * leaf.count;
    auto to = leaf.storage.begin();
    for (int axis = 0; axis < 3; ++axis) {
      for (const StrandSegment& segment : all) {
        for (const CoveringTriangle& half : facing_strip(segment, axis)) *to++ = half;
      }
    }
    leaf.one_strand = is_one_strand(all);
    return leaf;
  }

  Leaf load_triangles(const BvhNode& node, unsigned slot) const {
    Leaf leaf;
    for (std::uint32_t i = bvh_leaf_begin(&node, slot); i < bvh_leaf_end(node.leaf_end, slot);
         ++i) {
      const TriangleBlock& block = object_.blocks[bvh_block(node.prim_base, i)];
      const unsigned lane = i % 8;
      const CoveringTriangle triangle{corner_of(block, 0, lane), edge_of(block, 1, lane),
                                      edge_of(block, 2, lane), block.opacity[lane],
                                      has_bit(object_.closed, bvh_block(node.prim_base, i), lane)};
      leaf.textured |= triangle.opacity < 0.0f;
      const float opacity =
          triangle.opacity >= 0.0f
              ? triangle.opacity
              : integral_of(triangle, object_.textured, integrals_).mean(1.0f / 3, 1.0f / 3, 1.0f);
      const V3f area = 0.5f * triangle.edge1.cross(triangle.edge2);
      leaf.normals.add(area, opacity);
      leaf.areas.add(area, opacity, triangle.closed);
      leaf.walls.add(area, opacity, chord(bvh_block(node.prim_base, i), lane));
      leaf.storage[leaf.count++] = triangle;
    }
    leaf.drawn = leaf.count;
    return leaf;
  }

  /// The bit of a lane in bytes by block of the object; `bytes` may be empty.
  bool has_bit(std::span<const std::uint8_t> bytes, std::uint32_t block, unsigned lane) const {
    return !bytes.empty() && (bytes[block - object_.first_block] >> lane & 1u) != 0;
  }

  /// Of interior_triangles().
  float chord(std::uint32_t block, unsigned lane) const {
    return object_.interior.empty() ? 0.0f
                                    : object_.interior[8 * (block - object_.first_block) + lane];
  }

  const PrefilterTask& task_;
  const ObjectArrays& object_;
  const WideTree& tree_;
  const TextureIntegrals& integrals_;
};

}  // namespace

NodeOpacity map_opacity(const CoverageMap& map, const NormalMoments& normals, const Box3f& box) {
  const MapStatistics seen = map.statistics();
  NodeOpacity opacity{seen.opacity, normals, seen.clumping};
  MassSums mass;
  for (int axis = 0; axis < 3; ++axis)
    mass.add(axis, seen.moments[axis], seen.opacity[axis], face_area(box, axis));
  opacity.mass = mass.shape();
  return opacity;
}

namespace {

void start_record(BuiltObject& built, const TextureIntegrals& integrals, RefitRecord& record) {
  record = {};
  record.triangles = built.object.primitives;
  record.closed = built.closed;
  for (const TexturedTriangle& triangle : built.object.textured)
    record.textured_opacity.push_back(integrals.of(triangle).mean(1.0f / 3, 1.0f / 3, 1.0f));
  record.nodes.resize(built.object.nodes.size());
  cut_subtrees(built.tree, record);
}

}  // namespace

Summary prefilter(const PrefilterTask& task, const TextureIntegrals& integrals) {
  return Prefilter(task, integrals).node(0);
}

void prefilter(BuiltObject& built, const TextureIntegrals& integrals, RefitRecord* record) {
  ObjectBvh& object = built.object;
  if (record) start_record(built, integrals, *record);
  const ObjectArrays arrays{object.nodes,    object.blocks, object.textured, built.closed, 0, 0, 0,
                            object.segments, built.interior};
  const Summary all = prefilter({arrays, built.tree, {}, record, nullptr}, integrals);
  object.opacity = map_opacity(all.map, all.normals, object.box);
  object.opacity.wall = is_wall(all.walls, all.normals, object.box);
}

}  // namespace dapple

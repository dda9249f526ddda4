// Makes procedural hair: an opaque head, and locks of curly strands that begin at its scalp and
// hang down over it. In: checked parameters; out: a scene. Units are metres; the face looks along
// +Z, the chin is near the origin.
#include <fmt/format.h>
#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "dapple/error.hpp"
#include "scene/procedural/mesh_shapes.hpp"
#include "scene/procedural/pcg32.hpp"
#include "scene/procedural/scenes.hpp"

namespace dapple {
namespace {

constexpr std::uint32_t kHairMaterial = 0;
constexpr std::uint32_t kSkinMaterial = 1;
constexpr std::uint32_t kMaxSegments = 1u << 26;
constexpr std::uint64_t kLockStreams = std::uint64_t{1} << 40;  // above the strands' stream numbers

const V3f kHeadCentre(0, 0.12f, 0);
const V3f kHeadRadii(0.075f, 0.115f, 0.095f);

struct HairShape {
  std::uint32_t strands = 0, segments = 0, seed = 0;
  float radius = 0;
  float curl = 0;
};

/// Values that all strands of one lock share.
struct Lock {
  V3f root;  ///< direction from the head's centre, in the space where the head is a unit sphere
  V3f sway;  ///< added to the direction of gravity
  V2f phase;
  float length = 0;
};

V3f on_head(V3f direction, float scale) { return kHeadCentre + direction * kHeadRadii * scale; }

/// Whether hair grows in a direction from the head's centre: it does above a line that is high at
/// the face and low at the back of the neck.
bool is_scalp(V3f direction) {
  const float face = std::clamp(direction.z + 0.35f, 0.0f, 1.0f);
  return direction.y > -0.45f + 0.95f * face;
}

V3f point_on_scalp(Pcg32& rng) {
  for (;;) {
    const V3f direction = unit_vector(rng);
    if (is_scalp(direction)) return direction;
  }
}

Lock grow_lock(const HairShape& shape, std::uint32_t lock) {
  Pcg32 rng(shape.seed, kLockStreams + lock);
  Lock grown;
  grown.root = point_on_scalp(rng);
  grown.sway = unit_vector(rng) * 0.2f;
  grown.phase = unit_circle(rng);
  grown.length = rng.between(0.13f, 0.26f);
  return grown;
}

/// About one lock for each forty strands, but at least 400 locks (if there are as many strands), to
/// cover the scalp, and at most 4000.
std::uint32_t lock_count(std::uint32_t strands) {
  return std::clamp(strands / 40, std::min(strands, 400u), 4000u);
}

/// Moves a point that is inside the head, enlarged by `scale`, out to its surface.
V3f pushed_out(V3f point, float scale) {
  const V3f direction = (point - kHeadCentre) / kHeadRadii;
  const float distance = direction.length();
  if (distance >= scale) return point;
  return distance > 0 ? on_head(direction / distance, scale) : on_head(V3f(0, 1, 0), scale);
}

/// The rotation of a curl from one segment to the next, as cosine and sine; at most a sixth of a
/// full turn.
V2f curl_step(const HairShape& shape) {
  const double turns = 6.0 * shape.curl;
  const double angle = 2 * std::numbers::pi * std::min(turns / shape.segments, 1.0 / 6);
  // Double arithmetic, rounded at the end: differences in libm's last bit do not change the mesh.
  return {static_cast<float>(std::cos(angle)), static_cast<float>(std::sin(angle))};
}

/// Computes the points of one strand: a core grows step by step, the strand winds around it.
class Strand {
 public:
  Strand(const HairShape& shape, const Lock& lock, Pcg32& rng) : lock_(lock) {
    const V3f offset = point_in_ball(rng);
    const V3f root = (lock.root + offset * 0.07f).normalized();
    core_ = on_head(root, 1.0f);
    along_ = (root / kHeadRadii).normalized();
    across_ = perpendicular(along_);
    lift_ = rng.between(1.02f, 1.12f);
    turn_ = lock.phase;
    step_length_ = lock.length * rng.between(0.85f, 1.0f) / static_cast<float>(shape.segments);
    curl_radius_ = 0.009f * shape.curl * rng.between(0.8f, 1.2f);
    pull_ = 6.0f / static_cast<float>(shape.segments);
    // Combs hair away from the face: from a parting to the sides and to the back.
    const float side = std::copysign(std::max(std::abs(root.x), 0.4f), root.x);
    comb_ = V3f(1.4f * side, 0, -2.2f * std::max(0.0f, root.z + 0.2f));
    frizz_ = unit_vector(rng) * 0.15f;
  }

  [[nodiscard]] V3f root() const { return core_; }

  /// Returns the next point; `t`, in (0, 1], is its position along the strand. `curl` is
  /// curl_step()'s rotation.
  V3f grow(V2f curl, float t) {
    const V3f pull = V3f(0, -1, 0) + lock_.sway + frizz_ + comb_ * std::max(0.0f, 1 - 2 * t);
    V3f next = core_ + (along_ + pull * pull_).normalized() * step_length_;
    // Keeps the strand outside of the head and of the hair below it.
    next = pushed_out(next, 1.0f + (lift_ - 1.0f) * std::min(1.0f, 6 * t));
    const V3f moved = next - core_;
    along_ = moved.length2() > 0 ? moved.normalized() : along_;
    core_ = next;
    // The frame moves without rotating about the strand, as in append_tube().
    const V3f carried = across_ - along_ * across_.dot(along_);
    across_ = carried.length2() > 1e-6f ? carried.normalized() : perpendicular(along_);
    turn_ = {turn_.x * curl.x - turn_.y * curl.y, turn_.x * curl.y + turn_.y * curl.x};
    const V3f offset = across_ * turn_.x + along_.cross(across_) * turn_.y;
    return pushed_out(core_ + offset * (curl_radius_ * std::min(1.0f, 3 * t)), 1.01f);
  }

 private:
  const Lock& lock_;
  V3f core_, along_, across_, comb_, frizz_;
  V2f turn_;
  float lift_ = 1, step_length_ = 0, curl_radius_ = 0, pull_ = 0;
};

class HairMesh {
 public:
  explicit HairMesh(const HairShape& shape) : shape_(shape), curl_(curl_step(shape)) {
    const std::size_t segments = std::size_t{shape.strands} * shape.segments;
    mesh_.name = "hair";
    mesh_.positions.resize(segments + shape.strands);
    mesh_.radii.resize(segments + shape.strands);
    mesh_.indices.resize(2 * segments);
    mesh_.materials.resize(segments, kHairMaterial);
  }

  /// Safe to call from several threads for different strands.
  void set(std::uint32_t strand, const Lock& lock) {
    Pcg32 rng(shape_.seed, strand);
    Strand grown(shape_, lock, rng);
    const std::size_t first = std::size_t{strand} * (shape_.segments + 1);
    mesh_.positions[first] = grown.root();
    mesh_.radii[first] = shape_.radius;
    for (std::uint32_t s = 1; s <= shape_.segments; ++s) {
      const float t = static_cast<float>(s) / static_cast<float>(shape_.segments);
      mesh_.positions[first + s] = grown.grow(curl_, t);
      mesh_.radii[first + s] = shape_.radius * (1 - 0.6f * t * t);
      const std::size_t segment = std::size_t{strand} * shape_.segments + s - 1;
      mesh_.indices[2 * segment] = static_cast<std::uint32_t>(first + s - 1);
      mesh_.indices[2 * segment + 1] = static_cast<std::uint32_t>(first + s);
    }
  }

  [[nodiscard]] Mesh take() { return std::move(mesh_); }

 private:
  const HairShape& shape_;
  V2f curl_;
  Mesh mesh_;
};

Mesh make_hair(const HairShape& shape) {
  std::vector<Lock> locks(lock_count(shape.strands));
  for (std::uint32_t i = 0; i < locks.size(); ++i) locks[i] = grow_lock(shape, i);
  HairMesh mesh(shape);
  const auto grow = [&](const tbb::blocked_range<std::uint32_t>& range) {
    for (std::uint32_t strand = range.begin(); strand < range.end(); ++strand) {
      // Strands of one lock are adjacent in memory.
      mesh.set(strand, locks[std::uint64_t{strand} * locks.size() / shape.strands]);
    }
  };
  tbb::parallel_for(tbb::blocked_range<std::uint32_t>(0, shape.strands, 256), grow);
  return mesh.take();
}

/// Makes a closed ellipsoid from rings around the vertical axis.
Mesh make_head() {
  constexpr int kRings = 48, kSides = 64;
  Mesh mesh;
  mesh.name = "head";
  const auto direction = [](int ring, int side) {
    const double polar = std::numbers::pi * ring / kRings;
    const double azimuth = 2 * std::numbers::pi * (side % kSides) / kSides;
    return V3f(static_cast<float>(std::sin(polar) * std::cos(azimuth)),
               static_cast<float>(std::cos(polar)),
               static_cast<float>(-std::sin(polar) * std::sin(azimuth)));
  };
  mesh.positions.push_back(on_head({0, 1, 0}, 1));
  for (int ring = 1; ring < kRings; ++ring) {
    for (int side = 0; side < kSides; ++side)
      mesh.positions.push_back(on_head(direction(ring, side), 1));
  }
  mesh.positions.push_back(on_head({0, -1, 0}, 1));
  const auto last = static_cast<std::uint32_t>(mesh.positions.size() - 1);
  const auto vertex = [&](int ring, int side) {
    if (ring == 0) return 0u;
    if (ring == kRings) return last;
    return static_cast<std::uint32_t>(1 + (ring - 1) * kSides + side % kSides);
  };
  for (int ring = 0; ring < kRings; ++ring) {
    for (int side = 0; side < kSides; ++side) {
      const std::uint32_t a = vertex(ring, side), b = vertex(ring + 1, side),
                          c = vertex(ring + 1, side + 1), d = vertex(ring, side + 1);
      // At the lower pole b and c are the same vertex, at the upper pole a and d.
      if (ring + 1 < kRings) mesh.indices.insert(mesh.indices.end(), {a, b, c});
      if (ring > 0) mesh.indices.insert(mesh.indices.end(), {a, c, d});
    }
  }
  for (const V3f& position : mesh.positions)
    mesh.normals.push_back(((position - kHeadCentre) / (kHeadRadii * kHeadRadii)).normalized());
  mesh.materials.resize(mesh.indices.size() / 3, kSkinMaterial);
  return mesh;
}

/// The radius at the root, in metres. By default the sum of all strands' radii is that of a real
/// head, with 100,000 strands of radius 0.04 mm.
float radius_of(const ProceduralParameters& parameters) {
  if (const float given = parameters.real("radius"); given > 0) return given;
  return std::min(0.01f, 4.0f / static_cast<float>(parameters.whole("strands")));
}

}  // namespace

Scene make_hair_scene(const ProceduralParameters& parameters) {
  HairShape shape;
  shape.strands = parameters.whole("strands");
  shape.segments = parameters.whole("segments");
  shape.seed = parameters.whole("seed");
  shape.radius = radius_of(parameters);
  shape.curl = parameters.real("curl");
  if (std::uint64_t{shape.strands} * shape.segments > kMaxSegments) {
    throw Error(ErrorKind::usage, fmt::format("scene:hair: {} strands of {} segments are too many "
                                              "(at most {} segments in all)",
                                              shape.strands, shape.segments, kMaxSegments));
  }
  Scene scene;
  scene.materials.push_back(blend_material("hair", parameters.real("opacity")));
  scene.materials.push_back(opaque_material("skin"));
  place(scene, make_hair(shape));
  place(scene, make_head());
  return scene;
}

}  // namespace dapple

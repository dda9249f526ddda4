// What a cached object says of itself: numbers that no object has are not placed.
#include "bvh/storage/object_validation.hpp"

#include <gtest/gtest.h>

#include <functional>
#include <limits>

#include "bvh/build/object_bvh.hpp"

namespace dapple {
namespace {

TEST(ObjectValidation, SummariesThatCannotBePlacedAreNotSound) {
  constexpr float kInfinity = std::numeric_limits<float>::infinity();
  constexpr float kNan = std::numeric_limits<float>::quiet_NaN();
  const Scene scene = make_procedural("scene:cloud?leaves=100");
  const FinishedObject good(build_object(scene, OpaqueTexels(scene), scene.meshes[0]).object);
  EXPECT_TRUE(is_sound(good, scene));
  const std::vector<std::function<void(ObjectSummary&)>> edits = {
      [](ObjectSummary& o) { o.box.max.y = kInfinity; },
      [](ObjectSummary& o) { o.box.makeEmpty(); },
      [](ObjectSummary& o) { o.parts.clear(); },
      [](ObjectSummary& o) { o.parts[0].min.x = kNan; },
      [](ObjectSummary& o) { o.opacity.axes.z = 1.5f; },
      [](ObjectSummary& o) { o.opacity.clumping = -1; },
      [](ObjectSummary& o) { o.opacity.mass.concentration = 40; },
      [](ObjectSummary& o) { o.opacity.mass.pole.y = kNan; },
      [](ObjectSummary& o) { o.opacity.normals.sum[2] = kNan; },
  };
  for (std::size_t e = 0; e < edits.size(); ++e) {
    FinishedObject bad = good;
    edits[e](bad);
    EXPECT_FALSE(is_sound(bad, scene)) << "edit " << e;
  }
}

}  // namespace
}  // namespace dapple

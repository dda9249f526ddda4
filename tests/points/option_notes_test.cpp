// measure_points() notes options that may not do what was meant: for the library as for the
// command.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>

#include "dapple/points.hpp"

namespace dapple {
namespace {

using Notes = std::vector<std::string>;

Scene small_tree() { return make_procedural("scene:tree?leaves=200"); }

/// Of one point in the middle of a tree, or `below` its ground.
Notes notes_of(const PointOptions& options, bool below = false) {
  const Scene scene = small_tree();
  const Box3f bounds = scene_bounds(scene);
  V3f point = bounds.center();
  if (below) point.y = bounds.min.y - 1;
  const V3f up(0, 1, 0);
  return measure_points(scene, {&point, 1}, {&up, 1}, options).notes;
}

bool has(const Notes& notes, const std::string& part) {
  return std::ranges::any_of(
      notes, [&](const std::string& note) { return note.find(part) != std::string::npos; });
}

PointOptions exact_rays(int rays = 64) {
  PointOptions options;
  options.rays = rays;
  options.estimator = Estimator::exact;
  return options;
}

TEST(PointOptionNotes, RaysAreAMultipleOfTheSets) {
  EXPECT_TRUE(has(notes_of(exact_rays(67)), "--rays is 67; 64 are traced, a multiple of 8"));
  EXPECT_FALSE(has(notes_of(exact_rays(64)), "--rays"));
}

TEST(PointOptionNotes, PointsBelowTheGround) {
  PointOptions options = exact_rays();
  EXPECT_FALSE(has(notes_of(options, true), "below the ground"));
  options.ground = true;
  EXPECT_TRUE(has(notes_of(options, true), "1 of 1 points lie below the ground"));
  EXPECT_FALSE(has(notes_of(options, false), "below the ground"));
}

TEST(PointOptionNotes, OfAPeriodicScene) {
  PointOptions options = exact_rays();
  options.rings = 6;
  EXPECT_TRUE(notes_of(options).empty());
  const V3f size = scene_bounds(small_tree()).size();
  options.period_x = 2 * size.x;
  options.period_z = size.z / 2;
  const Notes notes = notes_of(options);
  EXPECT_TRUE(has(notes, " m wide along Z, and its period "));
  EXPECT_FALSE(has(notes, "along X"));
  EXPECT_TRUE(has(notes, "1 of 6 rings reaches lower than 5 degrees"));
  options.rings = 5;  // to 74.1 degrees from the zenith
  EXPECT_FALSE(has(notes_of(options), "rings"));
}

TEST(PointOptionNotes, OfSunsBelowFiveDegreesInAPeriodicScene) {
  PointOptions options = exact_rays();
  const auto sun = [](float elevation) {
    return SunDirection{V3f(std::cos(elevation), std::sin(elevation), 0), 1};
  };
  options.suns = {sun(0.08f), sun(0.1f), sun(-0.02f)};
  EXPECT_FALSE(has(notes_of(options), "suns"));
  options.period_x = options.period_z = 20;
  EXPECT_TRUE(has(notes_of(options), "1 of 3 suns is lower than 5 degrees"));
}

}  // namespace
}  // namespace dapple

// Scenes that callers of the library made: what does not fit together is an error that names it, in
// every function that takes a scene.
#include <gtest/gtest.h>

#include <filesystem>
#include <functional>
#include <limits>

#include "dapple/bake.hpp"
#include "dapple/error.hpp"
#include "dapple/points.hpp"
#include "dapple/render.hpp"
#include "support/scenes/scene_on_device.hpp"

namespace dapple {
namespace {

using namespace scene_test;

Scene lit_square() {
  Scene scene;
  scene.materials.push_back(material_of(1));
  place(scene, square_mesh(1, 0, 1, 0));
  scene.lights = daylight(Camera{});
  return scene;
}

std::string message_of(const std::function<void()>& call) {
  try {
    call();
  } catch (const Error& error) {
    EXPECT_EQ(error.kind(), ErrorKind::input);
    return error.what();
  }
  return "no error";
}

TEST(SceneCheck, WhatDoesNotFitTogetherIsNamed) {
  const std::vector<V3f> up{V3f(0, 1, 0)};
  PointOptions periodic;
  periodic.period_x = periodic.period_z = 2;
  BakeOptions alone;
  alone.placement = BakePlacement::alone;
  const float nan = std::numeric_limits<float>::quiet_NaN();
  const std::pair<std::function<void(Scene&)>, std::string> cases[] = {
      {[](Scene& s) { s.meshes[0].indices[4] = 4'000'000'000; },
       "mesh 0 has the index 4000000000, but there are 4"},
      {[](Scene& s) { s.meshes[0].indices.pop_back(); }, "mesh 0 has 5 indices and 2 materials"},
      {[](Scene& s) { s.meshes[0].materials[1] = 1; }, "mesh 0 has the material 1"},
      {[](Scene& s) { s.materials.clear(); }, "mesh 0 has the material 0, but there are 0"},
      {[](Scene& s) { s.meshes[0].normals.resize(3); }, "mesh 0 has 3 normals"},
      {[](Scene& s) { s.instances[0].mesh = 7; }, "instance 0 has no mesh 7"},
      {[](Scene& s) { s.instances[0].light = 9; }, "instance 0 has no light 9"},
      {[](Scene& s) { s.materials[0].alpha_texture = 0; },
       "material 0 \"material_1.000000\" has no texture 0"},
      {[](Scene& s) {
         s.textures.push_back({"leaf", 2, 2, {1, 2, 3}});
       },
       "texture 0 \"leaf\" has 3 values for 2 x 2 texels"},
      {[](Scene& s) {
         s.textures.push_back({"empty", 0, 5, {}});
       },
       "texture 0 \"empty\" has 0 values for 0 x 5 texels"},
      {[](Scene& s) {
         s.meshes[0].objects = {0, 9};
       },
       "mesh 0 has the object 9, but there are 0"},
      {[](Scene& s) { s.instances[0].object = 3; }, "instance 0 has no object 3"},
      {[&](Scene& s) { s.materials[0].alpha = nan; },
       "material 0 \"material_1.000000\" has the alpha nan"},
      {[](Scene& s) { s.materials[0].color.x = -5; },
       "material 0 \"material_1.000000\" has a colour"},
      {[&](Scene& s) { s.lights[0].radiance.y = nan; }, "light 0 \"sun\" has a radiance"},
      {[](Scene& s) { s.lights[0].radiance.x = -1; }, "light 0 \"sun\" has a radiance"},
      {[](Scene& s) { s.lights[0].radiance.z = 2e30f; }, "light 0 \"sun\" has a radiance"},
      {[](Scene& s) { s.lights[0].kind = static_cast<LightKind>(6); },
       "light 0 \"sun\" has no kind 6"},
      {[](Scene& s) { s.materials[0].alpha_mode = static_cast<AlphaMode>(3); },
       "material 0 \"material_1.000000\" has no alpha mode 3"},
      {[](Scene& s) {
         s.textures.push_back({"leaf", 1, 1, {1}});
         s.textures[0].wrap_t = static_cast<Wrap>(3);
       },
       "texture 0 \"leaf\" has the wrap modes 0 and 3"},
      {[](Scene& s) {
         s.meshes[0].name = "two\nlines";
         s.meshes[0].normals.resize(3);
       },
       "mesh 0 \"two lines\" has 3 normals"},
      {[](Scene& s) { s.lights[0].direction = V3f(0); }, "light 0 \"sun\" has a direction"},
      {[](Scene& s) { s.lights[1].environment = std::make_shared<Environment>(); },
       "light 1 \"sky\" has a dome of 0 values for 0 x 0 pixels"},
      {[&](Scene& s) {
         s.lights[1].environment =
             std::make_shared<Environment>(Environment{1, 2, {V3f(1), V3f(1, nan, 1)}});
       },
       "light 1 \"sky\" has a dome with pixels"},
      {[](Scene& s) { s.lights[0].angular_radius = 0; },
       "light 0 \"sun\" has the angular radius 0"},
  };
  for (const auto& [change, expected] : cases) {
    Scene scene = lit_square();
    change(scene);
    RenderOptions picture;
    picture.width = picture.height = picture.spp = 1;
    for (const std::string& message :
         {message_of([&] { (void)render(scene, picture); }),
          message_of([&] { (void)measure_points(scene, up, up); }),
          message_of([&] { (void)measure_points(scene, up, up, periodic); }),
          message_of([&] { (void)bake(scene, {}); }), message_of([&] { (void)bake(scene, alone); }),
          message_of([&] { (void)build_bvh(scene); })})
      EXPECT_TRUE(message.starts_with(expected)) << message << " in place of " << expected;
  }
}

TEST(SceneCheck, BoundsCamerasGroundsAndFilesAreOfScenesThatFitTogether) {
  const std::string path = testing::TempDir() + "dapple_scene_check.glb";
  const std::pair<std::function<void(Scene&)>, std::string> cases[] = {
      {[](Scene& s) { s.meshes[0].indices[4] = 7; }, "mesh 0 has the index 7, but there are 4"},
      {[](Scene& s) { s.instances[0].mesh = 7; }, "instance 0 has no mesh 7"},
      {[](Scene& s) { s.meshes[0].materials[1] = 5; },
       "mesh 0 has the material 5, but there are 1"},
  };
  for (const auto& [change, expected] : cases) {
    Scene scene = lit_square();
    change(scene);
    EXPECT_EQ(message_of([&] { (void)scene_bounds(scene); }), expected);
    EXPECT_EQ(message_of([&] { (void)frame_scene(scene, 1); }), expected);
    EXPECT_EQ(message_of([&] { add_ground(scene); }), expected);
    EXPECT_EQ(message_of([&] { write_glb(scene, path); }), expected);
  }
  EXPECT_FALSE(std::filesystem::exists(path));
}

TEST(SceneCheck, UpdatesAreCheckedAsBuildsAre) {
  Scene bad = lit_square();
  bad.meshes[0].indices[4] = 7;
  const std::string expected = "mesh 0 has the index 7, but there are 4";
  EXPECT_EQ(message_of([&] { UpdatableBvh built(bad); }), expected);
  UpdatableBvh bvh(lit_square());
  EXPECT_EQ(message_of([&] { bvh.update(bad); }), expected);
  bvh.update(lit_square());
  EXPECT_EQ(bvh.bvh().statistics.triangles, 2u);
}

TEST(SceneCheck, PlacesThatAreNotFiniteAreRefusedWhereNothingDropsThem) {
  const float infinity = std::numeric_limits<float>::infinity();
  Scene scene = lit_square();
  scene.instances[0].to_world[3][1] = infinity;
  EXPECT_EQ(message_of([&] { (void)build_bvh(scene); }),
            "the scene: instance 0 has a place that is not finite");
  scene = lit_square();
  scene.meshes[0].positions[2].x = infinity;
  EXPECT_EQ(message_of([&] { (void)build_bvh(scene); }), "mesh \"\" has vertices at infinity");
}

TEST(SceneCheck, CamerasThatSeeNothingAreRefused) {
  const float nan = std::numeric_limits<float>::quiet_NaN();
  const std::pair<std::function<void(Camera&)>, std::string> cases[] = {
      {[&](Camera& c) { c.fov_y = nan; },
       "camera \"\" has the field of view nan; it must be above 0 and below pi radians"},
      {[](Camera& c) { c.fov_y = 4; },
       "camera \"\" has the field of view 4; it must be above 0 and below pi radians"},
      {[](Camera& c) {
         c.kind = Camera::Kind::orthographic;
         c.half_height = 0;
       },
       "camera \"\" has the half height 0; it must be finite and not 0"},
      {[&](Camera& c) { c.to_world[0][0] = nan; }, "camera \"\" has a place that is not finite"},
      {[&](Camera& c) { c.to_world[3][1] = nan; }, "camera \"\" has a place that is not finite"},
      {[](Camera& c) { c.to_world[0][0] = 0; },
       "camera \"\" has the determinant 0; it must be other than 0"},
      {[](Camera& c) { c.kind = static_cast<Camera::Kind>(7); },
       "camera \"\" has the kind 7; it must be perspective or orthographic"},
      {[](Camera& c) { c.lens_radius = -1; },
       "camera \"\" has the lens radius -1; it must be finite, 0 or more"},
      {[&](Camera& c) { c.focus_distance = nan; },
       "camera \"\" has the focus distance nan; it must be finite, 0 or more"},
  };
  for (const auto& [change, expected] : cases) {
    Scene scene = lit_square();
    scene.cameras.resize(1);
    change(scene.cameras[0]);
    EXPECT_EQ(message_of([&] { (void)render(scene, {}); }), "the scene: " + expected);
  }
}

TEST(SceneCheck, ObjectsThatWereNamedBeforeMergingKeepTheirNames) {
  Scene scene = lit_square();
  place(scene, square_mesh(1, 1, 1, 0));
  scene.meshes[0].name = "lower";
  scene.meshes[1].name = "upper";
  name_objects(scene);
  merge_single_instances(scene);
  name_objects(scene);
  EXPECT_EQ(scene.objects, (std::vector<std::string>{"lower", "upper"}));
}

}  // namespace
}  // namespace dapple

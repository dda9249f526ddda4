// One function a procedural scene; their parameters are in the table in procedural.cpp.
// In: checked parameters; out: a scene without a source name.
#pragma once

#include "dapple/scene.hpp"
#include "scene/procedural/parameters.hpp"

namespace dapple {

// Foliage (procedural_foliage.cpp).
Scene make_tree_scene(const ProceduralParameters& parameters);
Scene make_cloud_scene(const ProceduralParameters& parameters);
Scene make_forest_scene(const ProceduralParameters& parameters);
Scene make_demo_scene(const ProceduralParameters& parameters);

// Strands (procedural_hair.cpp).
Scene make_hair_scene(const ProceduralParameters& parameters);

// Shapes whose occlusion is known in closed form (procedural_solids.cpp).
Scene make_stack_scene(const ProceduralParameters& parameters);
Scene make_disk_scene(const ProceduralParameters& parameters);
Scene make_cube_scene(const ProceduralParameters& parameters);
Scene make_greys_scene(const ProceduralParameters& parameters);

/// A BLEND material of that opacity.
Material blend_material(const std::string& name, float opacity);
Material opaque_material(const std::string& name);

/// Adds `mesh` and places it once, where it is.
void place(Scene& scene, Mesh mesh);

}  // namespace dapple

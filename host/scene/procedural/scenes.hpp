// One function for each procedural scene; procedural.cpp has the table of their parameters.
// In: checked parameters; out: a scene without a source name.
#pragma once

#include "dapple/scene.hpp"
#include "scene/procedural/parameters.hpp"

namespace dapple {

// Foliage (foliage.cpp).
Scene make_tree_scene(const ProceduralParameters& parameters);
Scene make_cloud_scene(const ProceduralParameters& parameters);
Scene make_forest_scene(const ProceduralParameters& parameters);
Scene make_demo_scene(const ProceduralParameters& parameters);

// Plants of other habits (plants.cpp).
Scene make_palm_scene(const ProceduralParameters& parameters);
Scene make_conifer_scene(const ProceduralParameters& parameters);
Scene make_willow_scene(const ProceduralParameters& parameters);
Scene make_grass_scene(const ProceduralParameters& parameters);

// Flowers (flower.cpp).
Scene make_flower_scene(const ProceduralParameters& parameters);

// Strands (hair.cpp).
Scene make_hair_scene(const ProceduralParameters& parameters);

// Shapes whose occlusion is known in closed form (solids.cpp).
Scene make_stack_scene(const ProceduralParameters& parameters);
Scene make_disk_scene(const ProceduralParameters& parameters);
Scene make_cube_scene(const ProceduralParameters& parameters);
Scene make_greys_scene(const ProceduralParameters& parameters);
Scene make_sieve_scene(const ProceduralParameters& parameters);

/// Throws Error usage as make_procedural() does, without making the scene.
void check_procedural(const std::string& name);

// What they have in common (parts.cpp).

/// Makes a material of alpha mode BLEND; `opacity` is in [0, 1].
Material blend_material(const std::string& name, float opacity);
Material opaque_material(const std::string& name);

/// The parameter `leaf_size`, metres; 0: automatic. Throws Error usage for less than a millimetre,
/// of which the rounding of floats would leave no leaf.
float given_leaf_length(const ProceduralParameters& parameters);

/// Adds `mesh` and one instance of it, without a transformation.
void place(Scene& scene, Mesh mesh);

}  // namespace dapple

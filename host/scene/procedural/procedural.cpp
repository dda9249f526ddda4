// The table of procedural scenes, and the function that makes one from "scene:NAME?key=value".
// In: a name with parameters and a time; out: a scene.
#include "scene/procedural/procedural.hpp"

#include <fmt/format.h>

#include <string_view>
#include <utility>

#include "dapple/error.hpp"
#include "dapple/scene.hpp"
#include "scene/procedural/scenes.hpp"
#include "scene/unused_options.hpp"

namespace dapple {
namespace {

using Parameter = ProceduralParameter;

struct Recipe {
  ProceduralHelp help;
  Scene (*make)(const ProceduralParameters&);
};

Parameter leaves_of(double count, const char* help) {
  return {"leaves", count, 1, 10'000'000, true, help};
}

Parameter opacity_of(const char* material, double value) {
  return {"opacity", value, 0, 1, false, fmt::format("opacity of material \"{}\"", material)};
}

Parameter leaf_size() {
  return {"leaf_size", 0, 0, 1, false, "mean leaf length in metres; 0: smaller the more leaves"};
}

Parameter seed() { return {"seed", 1, 0, 4294967295.0, true, "another seed, another plant"}; }

constexpr const char* kTwoTriangles = "number of leaves, of two triangles each";

std::vector<Recipe> plant_recipes() {
  return {
      {{"demo", "a tree on a ground in daylight, and a camera", {}}, make_demo_scene},
      {{"tree",
        "a broad-leaved tree: materials \"leaf\" and \"bark\"",
        {leaves_of(50000, kTwoTriangles),
         opacity_of("leaf", 0.85),
         leaf_size(),
         seed(),
         {"height", 8, 0.5, 100, false, "height in metres"},
         {"wood", 1, 0, 1, true, "1: with trunk and branches, 0: leaves only"},
         {"wind", 0, 0, 3, false, "strength of the wind that sways it with the time; 0: calm"}}},
       make_tree_scene},
      {{"cloud",
        "leaves turned at random in a ball of radius 2 m, 2.5 m above the origin",
        {leaves_of(20000, kTwoTriangles), opacity_of("leaf", 0.85), leaf_size(), seed()}},
       make_cloud_scene},
      {{"forest",
        "many instances of a few trees on a ground",
        {{"trees", 400, 1, 1'000'000, true, "number of trees"},
         leaves_of(45000, "number of leaves of each tree"),
         {"species", 3, 1, 16, true, "number of different trees"},
         opacity_of("leaf", 0.85),
         {"spacing", 6, 0.5, 100, false, "mean distance between trees in metres"},
         seed()}},
       make_forest_scene},
  };
}

Parameter height_of(double metres) {
  return {"height", metres, 0.5, 100, false, "height in metres"};
}

std::vector<Recipe> habit_recipes() {
  return {
      {{"palm",
        "a palm with arching fronds: materials \"leaf\" and \"bark\"",
        {leaves_of(6000, "number of leaflets, of two triangles each"), opacity_of("leaf", 0.85),
         leaf_size(), seed(), height_of(10)}},
       make_palm_scene},
      {{"conifer",
        "a conifer with whorls of branches: materials \"leaf\" (needles) and \"bark\"",
        {leaves_of(300000, "number of needles, of two triangles each"), opacity_of("leaf", 1),
         leaf_size(), seed(), height_of(12)}},
       make_conifer_scene},
      {{"willow",
        "a weeping willow, whose twigs hang to the ground: materials \"leaf\" and \"bark\"",
        {leaves_of(80000, kTwoTriangles), opacity_of("leaf", 0.85), leaf_size(), seed(),
         height_of(10)}},
       make_willow_scene},
      {{"grass",
        "a field of grass and a camera at a grazing angle: material \"leaf\"",
        {leaves_of(400000, "number of blades, of two triangles each"),
         opacity_of("leaf", 1),
         leaf_size(),
         seed(),
         {"length", 100, 1, 1000, false, "length in metres; its width is a fifth"}}},
       make_grass_scene},
  };
}

Recipe flower_recipe() {
  return {{"flower",
           "a clump of daisies on a meadow in daylight, and a camera: materials \"petal\", "
           "\"floret\", \"leaf\", \"stem\" and \"ground\"",
           {{"blooms", 5, 1, 100, true, "number of flower heads"},
            {"petals", 21, 3, 89, true, "petals of each head, in two whorls"},
            {"florets", 200, 10, 1000, true, "florets of each head, of 30 triangles each"},
            {"leaves", 16, 0, 200, true, "leaves at the foot of the clump"},
            {"detail", 8, 2, 64, true, "squares across a petal"},
            {"clumps", 16, 1, 1000, true, "clumps on the meadow: instances behind the first one"},
            opacity_of("petal", 0.85),
            seed(),
            {"height", 0.35, 0.05, 10, false, "height in metres"}}},
          make_flower_scene};
}

Recipe hair_recipe() {
  return {{"hair",
           "a head of curly hair looking along +Z: materials \"hair\" and \"skin\"",
           {{"strands", 20000, 1, 2'000'000, true, "number of strands"},
            {"segments", 16, 1, 256, true, "segments of each strand"},
            {"radius", 0, 0, 0.01, false, "metres at the root; 0: thinner the more strands"},
            {"curl", 0.5, 0, 1, false, "0: straight, 1: tight curls"},
            opacity_of("hair", 0.3),
            {"seed", 1, 0, 4294967295.0, true, "another seed, another hairdo"}}},
          make_hair_scene};
}

std::vector<Recipe> sheet_and_solid_recipes() {
  return {
      {{"stack",
        "square sheets of 2 m, one above the other, over a ground: material \"sheet\"",
        {{"layers", 4, 1, 10000, true, "number of sheets"},
         opacity_of("sheet", 0.25),
         {"gap", 0.1, 0.001, 10, false,
          "metres between sheets, and from the ground to the first"}}},
       make_stack_scene},
      {{"disk",
        "a horizontal disk over a ground: material \"disk\"",
        {{"radius", 1, 0.001, 100, false, "metres"},
         {"height", 1, 0.001, 100, false, "metres above the ground"},
         {"segments", 256, 3, 1'000'000, true, "triangles around the centre"},
         opacity_of("disk", 1)}},
       make_disk_scene},
      {{"cube",
        "an opaque closed cube of side 1 m standing at the origin: material \"cube\"",
        {{"divisions", 16, 1, 1000, true, "squares along an edge"}}},
       make_cube_scene},
      {{"greys",
        "two sheets of 2 m over a ground: materials \"quarter\" (0.25, below) and \"half\" (0.5)",
        {{"gap", 0.1, 0.001, 10, false,
          "metres between sheets, and from the ground to the first"}}},
       make_greys_scene},
      {{"sieve",
        "a plate of 2 m with square holes over a ground: material \"plate\"",
        {{"holes", 100, 1, 2000, true, "number of holes along an edge"},
         {"open", 0.5, 0.01, 0.99, false, "area of the holes over that of the plate"},
         {"height", 1, 0.01, 10, false, "metres above the ground"}}},
       make_sieve_scene},
  };
}

/// Makes the table, in the order of the output of `dapple scene`.
std::vector<Recipe> make_recipes() {
  std::vector<Recipe> all = plant_recipes();
  for (Recipe& recipe : habit_recipes()) all.push_back(std::move(recipe));
  all.push_back(flower_recipe());
  all.push_back(hair_recipe());
  for (Recipe& recipe : sheet_and_solid_recipes()) all.push_back(std::move(recipe));
  return all;
}

const std::vector<Recipe>& recipes() {
  static const std::vector<Recipe> kRecipes = make_recipes();
  return kRecipes;
}

const Recipe& find_recipe(std::string_view name) {
  std::string known;
  for (const Recipe& recipe : recipes()) {
    if (recipe.help.name == name) return recipe;
    known += (known.empty() ? "" : ", ") + recipe.help.name;
  }
  throw Error(ErrorKind::usage,
              fmt::format("scene:{}: there is no such scene; there are: {}", name, known));
}

/// "tree?leaves=5" of "scene:tree?leaves=5", and its parts.
struct ProceduralName {
  std::string_view all, scene, query;
  explicit ProceduralName(std::string_view name) : all(name) {
    if (all.starts_with("scene:")) all.remove_prefix(6);
    const std::size_t mark = all.find('?');
    scene = all.substr(0, mark);
    if (mark != std::string_view::npos) query = all.substr(mark + 1);
  }
};

void warn_if_still(const ProceduralParameters& parameters, Scene& scene) {
  if (parameters.can_move() && parameters.real("wind") > 0) return;
  warn_of_rest(scene.source, scene);
  if (parameters.can_move()) scene.warnings.back() += "; with wind=1 it moves";
}

}  // namespace

std::vector<ProceduralHelp> procedural_help() {
  std::vector<ProceduralHelp> help;
  for (const Recipe& recipe : recipes()) help.push_back(recipe.help);
  return help;
}

Scene make_procedural(const std::string& name, std::optional<double> time) {
  const ProceduralName parts(name);
  const Recipe& recipe = find_recipe(parts.scene);
  const ProceduralParameters parameters(recipe.help, parts.query, time);
  Scene scene = recipe.make(parameters);
  scene.source = fmt::format("scene:{}", parts.all);
  if (time) warn_if_still(parameters, scene);
  return scene;
}

void check_procedural(const std::string& name) {
  const ProceduralName parts(name);
  const ProceduralParameters parameters(find_recipe(parts.scene).help, parts.query, {});
}

}  // namespace dapple

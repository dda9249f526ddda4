// Parts of tricky scenes: a ground, and a card that stands on it. A tricky case stores them in an
// unusual way, its plain twin in the simplest way.
#pragma once

#include "corpus/corpus.hpp"

namespace dapple::test {

/// The card's corners, counter-clockwise, and the corners of its two triangles.
inline const std::vector<float> kCorners = {-1, 0, 0, 1, 0, 0, 1, 2, 0, -1, 2, 0};
inline const std::vector<float> kCardTriangles = {-1, 0, 0, 1, 0, 0, 1,  2, 0,
                                                  -1, 0, 0, 1, 2, 0, -1, 2, 0};

/// The ground alone, as mesh and node 0.
inline GltfBuilder stage() {
  GltfBuilder builder;
  builder.add_mesh({{"attributes",
                     {{"POSITION", builder.add_positions({-3, 0, 3, 3, 0, 3, 3, 0, -3,  //
                                                          -3, 0, 3, 3, 0, -3, -3, 0, -3})}}}});
  return builder;
}

/// The ground and the card, as meshes and nodes 0 and 1.
inline GltfBuilder plain_stage() {
  GltfBuilder builder = stage();
  builder.add_mesh({{"attributes", {{"POSITION", builder.add_positions(kCardTriangles)}}}});
  return builder;
}

/// A tricky case: the plain stage after `edit`. Its twin is the plain stage.
inline Tricky twisted(const std::string& name, const std::function<void(GltfBuilder&)>& edit) {
  GltfBuilder builder = plain_stage();
  edit(builder);
  return {name, as_glb(builder), as_glb(plain_stage())};
}

/// A tricky case: the ground, to which `add_card` adds the card. Its twin is the plain stage.
inline Tricky card(const std::string& name, const std::function<void(GltfBuilder&)>& add_card) {
  GltfBuilder builder = stage();
  add_card(builder);
  return {name, as_glb(builder), as_glb(plain_stage())};
}

}  // namespace dapple::test

// Keeps reference pictures on disk, because they take minutes to render. In: a key, and a function
// that renders. Out: two halves of independent samples.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "rivals/rival_scene.hpp"

namespace dapple::bench {

struct ReferenceHalves {
  std::vector<double> first, second;
};

/// All that a reference depends on, as text: the scene's name, opacities, content, camera and size,
/// the pass and the samples per pixel.
std::string reference_key_text(const RivalScene& scene, const std::string& pass, int spp);

/// $XDG_CACHE_HOME/dapple-bench, or ~/.cache/dapple-bench; empty if neither variable is set.
std::string default_cache_folder();

/// Reads the halves of `key`, `values` numbers each, from a file in `folder`. If there is no
/// matching file, calls make(0) and make(1), and writes the file atomically. With an empty `folder`
/// nothing is written. Throws Error failed if the folder cannot be written.
ReferenceHalves cached_reference(const std::string& folder, const std::string& key,
                                 std::size_t values,
                                 const std::function<std::vector<double>(int)>& make);

}  // namespace dapple::bench

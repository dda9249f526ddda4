// References take minutes, so they are kept on disk: two halves of independent samples each.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "rivals/rival_scene.hpp"

namespace dapple::bench {

struct ReferenceHalves {
  std::vector<double> first, second;
};

/// Everything that a reference depends on, as text: the scene's name, opacities, content, camera
/// and size, the pass and the samples a pixel.
std::string reference_key_text(const RivalScene& scene, const std::string& pass, int spp);

/// $XDG_CACHE_HOME/dapple-bench, or ~/.cache/dapple-bench. Empty where neither is known.
std::string default_cache_folder();

/// The halves of `key`, `values` numbers each, from a file in `folder`; where there is none, or
/// one that does not match, made by `make` (given 0, then 1) and written, whole or not at all. An
/// empty folder keeps nothing. Throws Error failed when the folder cannot be written.
ReferenceHalves cached_reference(const std::string& folder, const std::string& key,
                                 std::size_t values,
                                 const std::function<std::vector<double>(int)>& make);

}  // namespace dapple::bench

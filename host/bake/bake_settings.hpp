// The settings that decide a bake's samples, as names and values, for its checkpoint. In: what
// bake() gets. Out: settings that a resumed bake must have too.
#pragma once

#include "dapple/bake.hpp"
#include "render/render_settings.hpp"

namespace dapple {

Settings bake_settings(const Scene& scene, const BakeOptions& options,
                       const std::vector<Scene>& occluders);

}  // namespace dapple

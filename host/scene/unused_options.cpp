// Words for options without effect: see unused_options.hpp.
#include "scene/unused_options.hpp"

#include "scene/message.hpp"

namespace dapple {

void refuse_named_animation(const std::string& spec, const SceneOptions& options) {
  if (options.animation.empty() || options.animation == "*") return;
  throw Error(ErrorKind::usage, fmt::format("--animation {}: {} has no animations",
                                            one_line(excerpt(options.animation)), one_line(spec)));
}

void warn_of_rest(const std::string& spec, Scene& scene) {
  scene.warnings.push_back(one_line(spec + ": has no animations, and stays in its rest pose"));
}

void warn_of_no_lines(const std::string& spec, const SceneOptions& options, Scene& scene) {
  if (options.line_radius > 0)
    scene.warnings.push_back(
        one_line(spec + ": has no glTF lines, and --line-radius changes nothing"));
}

}  // namespace dapple

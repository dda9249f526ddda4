// The sources of moving scenes: glTF files, procedural scenes, and hair, which does not move. In: a
// scene's name and a time in seconds; out: the scene at that time.
#include "dapple/moving_scene.hpp"

#include <new>
#include <utility>

#include "dapple/error.hpp"
#include "scene/gltf/moving_gltf.hpp"
#include "scene/hair_file.hpp"
#include "scene/procedural/scenes.hpp"
#include "scene/unused_options.hpp"

namespace dapple {

class MovingScene::Source {
 public:
  virtual ~Source() = default;
  [[nodiscard]] virtual Scene at(std::optional<double> seconds) const = 0;
};

namespace {

class GltfSource : public MovingScene::Source {
 public:
  GltfSource(const std::string& path, const SceneOptions& options) : file_(path, options, true) {}
  [[nodiscard]] Scene at(std::optional<double> seconds) const override { return file_.at(seconds); }

 private:
  gltf::MovingGltf file_;
};

class ProceduralSource : public MovingScene::Source {
 public:
  ProceduralSource(std::string name, SceneOptions options)
      : name_(std::move(name)), options_(std::move(options)) {
    check_procedural(name_);
  }
  [[nodiscard]] Scene at(std::optional<double> seconds) const override {
    Scene scene = make_procedural(name_, seconds);
    warn_of_no_lines(name_, options_, scene);
    return scene;
  }

 private:
  std::string name_;
  SceneOptions options_;
};

class HairSource : public MovingScene::Source {
 public:
  HairSource(const std::string& path, const SceneOptions& options)
      : path_(path), scene_(load_hair(path)) {
    warn_of_no_lines(path, options, scene_);
  }
  [[nodiscard]] Scene at(std::optional<double> seconds) const override {
    Scene scene = scene_;
    add_time_warning(path_, seconds, scene);
    return scene;
  }

 private:
  std::string path_;
  Scene scene_;
};

std::unique_ptr<const MovingScene::Source> open(const std::string& spec,
                                                const SceneOptions& options) {
  const bool is_procedural = spec.starts_with("scene:");
  if (!is_procedural && !is_hair_name(spec)) return std::make_unique<GltfSource>(spec, options);
  refuse_named_animation(spec, options);
  if (is_procedural) return std::make_unique<ProceduralSource>(spec, options);
  return std::make_unique<HairSource>(spec, options);
}

}  // namespace

MovingScene::MovingScene(const std::string& spec, const SceneOptions& options) {
  validate(options);
  try {
    source_ = open(spec, options);
  } catch (const std::bad_alloc&) {
    throw Error(ErrorKind::failed, spec + ": there is not enough memory to read it");
  }
}

MovingScene::~MovingScene() = default;
MovingScene::MovingScene(MovingScene&&) noexcept = default;
MovingScene& MovingScene::operator=(MovingScene&&) noexcept = default;

Scene MovingScene::at(std::optional<double> seconds) const {
  SceneOptions options;
  options.time = seconds;
  validate(options);
  return source_->at(seconds);
}

}  // namespace dapple

// What optional layers cost: pictures at the defaults of `dapple render`, with a layer and without,
// in turn. In: a scene's recipe. Out: processor seconds of all threads, writing the EXR file
// included, and their ratio to those without the layer: `ratio` once the scene is loaded and its
// BVH built, `render` with both.
#include <unistd.h>

#include <ctime>
#include <filesystem>
#include <functional>

#include "benchmarks.hpp"
#include "dapple/film.hpp"
#include "dapple/render.hpp"

namespace dapple::bench {
namespace {

constexpr int kRepetitions = 7;

struct Layer {
  std::string name;
  std::function<void(RenderOptions&)> add;
  std::function<void(RenderOptions&)> without = [](RenderOptions&) {};
};

const std::vector<Layer>& layers() {
  static const std::vector<Layer> all = {
      {"albedo", [](RenderOptions&) {}, [](RenderOptions& o) { o.albedo = false; }},
      {"beauty", [](RenderOptions& o) { o.beauty = true; }},
      {"object", [](RenderOptions& o) { o.cryptomattes.objects = true; }},
      {"mattes",
       [](RenderOptions& o) {
         o.cryptomattes = {true, true};
       }},
      {"motion", [](RenderOptions& o) { o.motion = true; }},
      {"back", [](RenderOptions& o) { o.back = true; }},
      {"normals", [](RenderOptions&) {}, [](RenderOptions& o) { o.normals = Normals::geometric; }},
      {"deep", [](RenderOptions& o) { o.deep = true; }},
      {"all",
       [](RenderOptions& o) {
         o.cryptomattes = {true, true};
         o.motion = o.back = o.beauty = true;
       },
       [](RenderOptions& o) {
         o.albedo = false;
         o.normals = Normals::geometric;
       }},
  };
  return all;
}

double processor_seconds() {
  timespec time{};
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &time);
  return static_cast<double>(time.tv_sec) + 1e-9 * static_cast<double>(time.tv_nsec);
}

/// Renders and writes pictures of one scene. The first builds the BVH and compiles kernels.
class LayerPictures {
 public:
  explicit LayerPictures(const SceneRecipe& recipe) : recipe_(recipe), scene_(load(recipe)) {
    std::filesystem::create_directories(folder_);
  }
  ~LayerPictures() { std::filesystem::remove_all(folder_); }
  LayerPictures(const LayerPictures&) = delete;
  LayerPictures& operator=(const LayerPictures&) = delete;

  using Change = std::function<void(RenderOptions&)>;

  /// Processor seconds of one picture of a scene whose BVH is built.
  double take(const Change& change) {
    const double start = processor_seconds();
    write_picture(change, scene_, renderer_);
    return processor_seconds() - start;
  }
  /// The same with loading and building, as `dapple render` takes.
  double take_from_the_start(const Change& change) {
    const double start = processor_seconds();
    const Scene scene = load(recipe_);
    Renderer renderer;
    write_picture(change, scene, renderer);
    return processor_seconds() - start;
  }

 private:
  void write_picture(const Change& change, const Scene& scene, Renderer& renderer) const {
    RenderOptions options;
    change(options);
    const auto scene_at = [&](int) { return scene; };
    const Film film = renderer.render_shutter(scene_at, 1, options, {}, scene_at).film;
    write_exr(film, (folder_ / "picture.exr").string());
    if (options.deep) write_deep_exr(film, (folder_ / "deep.exr").string());
  }

  static Scene load(const SceneRecipe& recipe) {
    SceneOptions options;
    options.colors = true;
    Scene scene = load_scene(recipe.spec, options);
    for (const auto& [material, value] : recipe.opacity) override_opacity(scene, material, value);
    return scene;
  }

  std::filesystem::path folder_ =
      std::filesystem::temp_directory_path() / ("dapple_bench_" + std::to_string(getpid()));
  SceneRecipe recipe_;
  Scene scene_;
  Renderer renderer_;
};

void measure_layer(benchmark::State& state, LayerPictures& pictures, const Layer& layer) {
  const auto with = [&](RenderOptions& options) { layer.add(options); };
  for (auto _ : state) {
    const double before = pictures.take(layer.without);
    const double seconds = pictures.take(with);
    state.SetIterationTime(seconds);
    state.counters["ratio"] = seconds / before;
    const double whole_before = pictures.take_from_the_start(layer.without);
    state.counters["render"] = pictures.take_from_the_start(with) / whole_before;
  }
}

}  // namespace

void register_layers(const SceneRecipe& recipe) {
  const auto pictures = std::make_shared<std::unique_ptr<LayerPictures>>();
  for (const Layer& layer : layers()) {
    register_measured("Layers/" + layer.name + "/" + recipe.name, kRepetitions,
                      [&layer, pictures, recipe](benchmark::State& state) {
                        if (!*pictures) {
                          *pictures = std::make_unique<LayerPictures>(recipe);
                          (*pictures)->take(layer.without);
                        }
                        measure_layer(state, **pictures, layer);
                      });
  }
}

}  // namespace dapple::bench

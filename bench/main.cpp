// dapple-bench: benchmarks of the kernels and the BVH builder, and the subcommands accuracy, paper
// and rivals. Its own options and those of Google Benchmark may be mixed. Prints medians and their
// spread.
#include <benchmark/benchmark.h>

#include <algorithm>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <iostream>
#include <memory>
#include <string_view>

#include "accuracy/accuracy.hpp"
#include "benchmarks.hpp"
#include "dapple/error.hpp"
#include "paper/paper.hpp"
#include "rivals/rivals.hpp"

namespace dapple::bench {
namespace {

constexpr const char* kHelp =
    "dapple-bench [--scene=SCENE [--opacity=MATERIAL=VALUE]...]... [--device=NAME]\n"
    "             [--kernel-dir=FOLDER] [Google Benchmark's flags, below]\n"
    "dapple-bench accuracy|paper|rivals --help   (where built with Embree)\n"
    "  --scene        measure this scene too: a glTF file or \"scene:NAME?key=value\"\n"
    "  --opacity      give a material of the last --scene this opacity\n"
    "  --device       part of an OpenCL device's name\n"
    "  --kernel-dir   read kernels from this folder instead of the built-in ones\n\n";

struct Arguments {
  std::vector<SceneRecipe> scenes = named_scenes();
  std::string device, kernel_dir;
  std::vector<char*> rest;  ///< for Google Benchmark, the program's name first
  bool given_scene = false;
  bool chose_format = false;
};

void add_scene(Arguments& a, const std::string& spec) {
  const bool procedural = spec.starts_with("scene:");
  a.scenes.push_back(
      {procedural ? spec.substr(6) : std::filesystem::path(spec).stem().string(), spec, {}});
  a.given_scene = true;
}

void add_opacity(Arguments& a, const std::string& text) {
  if (!a.given_scene) throw Error(ErrorKind::usage, "--opacity comes after the --scene it is for");
  const std::size_t at = text.rfind('=');
  const char* number = text.c_str() + (at == std::string::npos ? text.size() : at + 1);
  char* end = nullptr;
  const float value = std::strtof(number, &end);
  if (end == number || *end || at == 0) {
    throw Error(ErrorKind::usage, "--opacity=" + text + ": expected MATERIAL=VALUE");
  }
  a.scenes.back().opacity.emplace_back(text.substr(0, at), value);
}

/// The value of `argument` if it is NAME=value, else nullptr.
const char* value_of(const char* argument, const char* name) {
  const std::size_t length = std::strlen(name);
  return std::strncmp(argument, name, length) == 0 && argument[length] == '='
             ? argument + length + 1
             : nullptr;
}

Arguments parse(int argc, char** argv) {
  Arguments a;
  a.rest.push_back(argv[0]);
  for (int i = 1; i < argc; ++i) {
    if (const char* spec = value_of(argv[i], "--scene")) {
      add_scene(a, spec);
    } else if (const char* opacity = value_of(argv[i], "--opacity")) {
      add_opacity(a, opacity);
    } else if (const char* device = value_of(argv[i], "--device")) {
      a.device = device;
    } else if (const char* folder = value_of(argv[i], "--kernel-dir")) {
      a.kernel_dir = folder;
    } else {
      if (std::strcmp(argv[i], "--help") == 0) std::cout << kHelp;
      a.chose_format |= value_of(argv[i], "--benchmark_format") != nullptr;
      a.rest.push_back(argv[i]);
    }
  }
  return a;
}

/// Prints the median and the coefficient of variation of each benchmark's repetitions, with the
/// name under which the benchmark was registered.
class MedianReporter : public benchmark::ConsoleReporter {
 public:
  MedianReporter() : ConsoleReporter(OO_Tabular) {}
  bool ReportContext(const Context& context) override {
    const bool goes_on = ConsoleReporter::ReportContext(context);
    name_field_width_ = std::min<std::size_t>(name_field_width_, kNameWidth);
    return goes_on;
  }
  void ReportRuns(const std::vector<Run>& runs) override {
    std::vector<Run> kept;
    for (const Run& run : runs) {
      if (run.aggregate_name != "median" && run.aggregate_name != "cv") continue;
      kept.push_back(run);
      benchmark::BenchmarkName& name = kept.back().run_name;
      name.iterations = name.repetitions = name.time_type = "";
    }
    ConsoleReporter::ReportRuns(kept);
  }

 private:
  static constexpr std::size_t kNameWidth = 40;
};

int run(int argc, char** argv) {
  Arguments arguments = parse(argc, argv);
  BenchDevice device(arguments.device, arguments.kernel_dir);
  std::vector<std::unique_ptr<BenchScene>> scenes;
  const std::vector<SceneRecipe> recipes = arguments.scenes;
  for (SceneRecipe& recipe : arguments.scenes) {
    scenes.push_back(std::make_unique<BenchScene>(std::move(recipe), device));
  }
  for (const auto& scene : scenes) register_tracing(*scene);
  for (const auto& scene : scenes) register_building(*scene);
  register_refitting();
  // Of the named scenes one is enough: each picture takes seconds.
  register_layers(recipes[0]);
  for (std::size_t i = named_scenes().size(); i < recipes.size(); ++i) register_layers(recipes[i]);
  int rest = static_cast<int>(arguments.rest.size());
  benchmark::Initialize(&rest, arguments.rest.data());
  if (benchmark::ReportUnrecognizedArguments(rest, arguments.rest.data())) return 2;
  MedianReporter medians;
  // A reporter of our own would disable --benchmark_format.
  benchmark::RunSpecifiedBenchmarks(arguments.chose_format ? nullptr : &medians);
  return 0;
}

}  // namespace
}  // namespace dapple::bench

int main(int argc, char** argv) {
  try {
#ifdef DAPPLE_BENCH_ACCURACY
    const std::string_view subcommand = argc > 1 ? argv[1] : "";
    if (subcommand == "accuracy") return dapple::bench::run_accuracy(argc - 1, argv + 1);
    if (subcommand == "paper") return dapple::bench::run_paper(argc - 1, argv + 1);
    if (subcommand == "rivals") return dapple::bench::run_rivals(argc - 1, argv + 1);
#endif
    return dapple::bench::run(argc, argv);
  } catch (const dapple::Error& error) {
    std::cerr << "dapple-bench: " << error.what() << '\n';
    return static_cast<int>(error.kind());
  }
}

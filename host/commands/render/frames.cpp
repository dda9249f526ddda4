// The files of each frame: see frames.hpp.
#include "commands/render/frames.hpp"

#include <fmt/format.h>

#include <filesystem>
#include <map>

#include "commands/arguments/option_text.hpp"
#include "commands/arguments/output_paths.hpp"
#include "commands/render/render_values.hpp"
#include "dapple/error.hpp"

namespace dapple {
namespace {

/// The output files as the user typed them.
Frame typed_files(const RenderArguments& a) {
  RenderOptions passes;
  parse_passes(a.passes, passes);
  Frame frame;
  frame.output = a.output;
  frame.png = a.png;
  if (!a.png.empty() && passes.visits) frame.visits_png = visits_path(a.png);
  frame.deep = a.deep;
  frame.stats_json = a.stats_json;
  return frame;
}

void check_sequence(const RenderArguments& a) {
  for (const auto& [flag, path] :
       {OutputPath{"--output", a.output}, OutputPath{"--png", a.png}, OutputPath{"--deep", a.deep},
        OutputPath{"--stats-json", a.stats_json}}) {
    if (path.empty() || has_frame_digits(path)) continue;
    throw Error(ErrorKind::usage, fmt::format("{} {}: with --frames its name needs a place for the "
                                              "frame's number, as in out.####.exr",
                                              flag, path));
  }
  if (a.checkpoint.empty() && a.resume.empty() && a.resume_or_begin.empty()) return;
  throw Error(ErrorKind::usage,
              fmt::format("{} is for one image: leave --frames out and choose it by --frame",
                          a.checkpoint.empty() ? "--resume" : "--checkpoint"));
}

Frame numbered(const Frame& typed, std::int64_t number) {
  Frame frame = typed;
  for (std::string* path :
       {&frame.output, &frame.png, &frame.visits_png, &frame.deep, &frame.stats_json}) {
    if (!path->empty()) *path = frame_path(*path, number);
  }
  return frame;
}

std::vector<OutputPath> outputs_of(const Frame& frame, const RenderArguments& a) {
  std::vector<OutputPath> outputs{{"--output", frame.output}};
  if (!frame.png.empty()) outputs.push_back({"--png", frame.png});
  if (!frame.visits_png.empty()) outputs.push_back({"--png (its heat map)", frame.visits_png});
  if (!frame.deep.empty()) outputs.push_back({"--deep", frame.deep});
  if (!frame.stats_json.empty()) outputs.push_back({"--stats-json", frame.stats_json});
  if (!a.checkpoint.empty()) outputs.push_back({"--checkpoint", a.checkpoint});
  return outputs;
}

/// Throws Error usage where two frames write one file, as o.#.exr and o.1#.exr do. Those of one
/// frame are checked.
void check_frames_differ(const std::vector<Frame>& frames, const RenderArguments& a) {
  std::map<std::string, std::string> flags;  // by path
  for (const Frame& frame : frames) {
    for (const OutputPath& output : outputs_of(frame, a)) {
      if (output.flag == "--checkpoint") continue;
      const std::string path = std::filesystem::path(output.path).lexically_normal().string();
      const auto [other, is_new] = flags.try_emplace(path, output.flag);
      if (!is_new)
        throw Error(ErrorKind::usage, fmt::format("{} {}: is the {} of another frame", output.flag,
                                                  output.path, other->second));
    }
  }
}

/// A new checkpoint may replace the one that the render resumes from. No other output may replace
/// an input.
void check_resumed_spare(std::vector<OutputPath> outputs, const std::string& resume) {
  std::erase_if(outputs, [](const OutputPath& output) { return output.flag == "--checkpoint"; });
  check_outputs_spare(outputs, {resume});
}

}  // namespace

std::string visits_path(const std::string& png) {
  const std::filesystem::path path(png);
  return (path.parent_path() / (path.stem().string() + "_visits" + path.extension().string()))
      .string();
}

std::vector<Frame> list_frames(const RenderArguments& a) {
  const Frame typed = typed_files(a);
  if (a.frames.empty()) {
    Frame still = typed;
    still.seconds = a.frame;
    return {still};
  }
  check_sequence(a);
  const FrameRange range = parse_frames(a.frames);
  std::vector<Frame> frames;
  for (std::int64_t number = range.first; number <= range.last; number += range.step) {
    Frame frame = numbered(typed, number);
    frame.number = number;
    frame.seconds = static_cast<double>(number) / frames_per_second(a);
    frame.title = fmt::format("frame {} ({} of {})", number, frames.size() + 1, range.count());
    frames.push_back(std::move(frame));
  }
  return frames;
}

void check_files(const std::vector<Frame>& frames, const RenderArguments& a) {
  std::vector<std::string> inputs;
  if (!a.scene.starts_with("scene:")) inputs.push_back(a.scene);
  if (!a.lights.empty()) inputs.push_back(a.lights);
  if (!a.dome.empty()) inputs.push_back(a.dome);
  // Folders have many files, and frames one folder: it is tidied once.
  for (const Frame& frame : frames)
    check_outputs(outputs_of(frame, a), &frame == &frames.front() ? Folders::tidy : Folders::leave);
  check_frames_differ(frames, a);
  check_files_spare(frames, a, inputs);
  for (const std::string& resumed : {a.resume, a.resume_or_begin})
    if (!resumed.empty()) check_resumed_spare(outputs_of(frames[0], a), resumed);
}

void check_files_spare(const std::vector<Frame>& frames, const RenderArguments& a,
                       const std::vector<std::string>& inputs) {
  const InputFiles files(inputs);
  for (const Frame& frame : frames)
    for (const OutputPath& output : outputs_of(frame, a)) check_spares(output, files);
}

}  // namespace dapple

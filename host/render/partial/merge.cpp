#include "render/partial/merge.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <memory>
#include <nlohmann/json.hpp>
#include <tuple>

#include "camera/camera_splitting.hpp"
#include "dapple/error.hpp"
#include "film/film_memory.hpp"
#include "film/layers.hpp"
#include "render/partial/checkpoint.hpp"
#include "render/partial/merged_sums.hpp"
#include "render/stopwatch.hpp"

namespace dapple {
namespace {

[[noreturn]] void refuse(const std::string& why) { throw Error(ErrorKind::usage, why); }

/// What differs from part to part: the memory of a merge must not grow with all that they share, as
/// the names of a hundred thousand objects.
struct Part {
  std::string path;
  std::vector<Piece> pieces;
  std::string device;
  int samples;
  bool visits, beauty;
};

/// The file without its state.
Checkpoint describe(const std::string& path) {
  Checkpoint about = read_part(path, PartContents::description);
  for (const auto& [name, value] : about.options)
    if (name == "--target-error or --target-rmse" && value != "none")
      refuse(path +
             ": was made with a target error, which decides about samples from those of the "
             "whole picture; parts are made with --spp");
  if (about.pieces.empty())
    refuse(path + ": is not finished; dapple render --resume " + path + " goes on");
  return about;
}

Part part_of(const std::string& path, Checkpoint about) {
  const PictureRecord& picture = about.picture;
  return {path,
          std::move(about.pieces),
          std::move(about.device),
          picture.metadata.samples,
          picture.options.visits,
          picture.options.beauty};
}

/// Whatever parts of one picture must agree in: all but their pixels, samples and devices.
Settings common_settings(const Checkpoint& about) {
  Settings settings, chosen;  // what dapple may have chosen from the scene, which comes first
  for (const auto& setting : about.options) {
    if (setting.first == "--crop" || setting.first == "--shard") continue;
    (setting.first == "--camera-splitting" ? chosen : settings).push_back(setting);
  }
  settings.insert(settings.end(), about.content.begin(), about.content.end());
  settings.insert(settings.end(), chosen.begin(), chosen.end());
  settings.emplace_back("--spp (footprints)", fmt::format("{}", about.footprint_spp));
  const PictureRecord& picture = about.picture;
  const auto& ambient = picture.options.ambient;
  settings.emplace_back("--ambient", ambient ? fmt::format("{}", *ambient) : "none");
  for (const auto& [name, value] : picture.metadata.settings)
    if (name != kAmbient && name != "footprint_spp") settings.emplace_back(name, value);
  nlohmann::json rest = to_json(picture);
  for (const char* own : {"crop", "metadata"}) rest.erase(own);
  for (const char* made_of_any_sums : {"visits", "beauty"}) rest["options"].erase(made_of_any_sums);
  using Json = nlohmann::json;
  const std::string text = rest.dump(-1, ' ', false, Json::error_handler_t::replace);
  settings.emplace_back("set of lights, objects or materials", text_checksum({text}));
  return settings;
}

/// `first`, `part`: what the files at the two paths must agree in.
void require_one_picture(const Settings& first, const std::string& first_path, const Settings& part,
                         const std::string& path) {
  auto other = first_difference(first, part);
  if (!other) {
    other = first_difference(part, first);  // settings that only the first has
    if (other) std::swap(other->before, other->now);
  }
  if (!other) return;
  refuse(other->is_opaque()
             ? fmt::format("{}: differs from {} in {}", path, first_path, other->name)
             : fmt::format("{}: was made with {} {}, {} with {} {}", path, other->name, other->now,
                           first_path, other->name, other->before));
}

/// The parts, sorted by what they hold, and what they agree in.
struct Parts {
  std::vector<Part> parts;
  Settings common;
};

/// In any order.
bool agree(const Settings& a, const Settings& b) {
  return !first_difference(a, b) && !first_difference(b, a);
}

/// Reads a part once more. Throws Error usage if the file is no longer what was described.
Checkpoint read_again(const Part& part, const Settings& common, PartContents contents) {
  Checkpoint about = read_part(part.path, contents);
  if (about.pieces != part.pieces || about.picture.options.visits != part.visits ||
      about.picture.options.beauty != part.beauty || !agree(common_settings(about), common))
    refuse(part.path + ": changed while it was merged");
  return about;
}

struct PieceOfFile {
  Piece piece;
  const Part* part;
};

std::vector<PieceOfFile> pieces_of(const std::vector<Part>& parts) {
  std::vector<PieceOfFile> pieces;
  for (const Part& part : parts)
    for (const Piece& piece : part.pieces) pieces.push_back({piece, &part});
  std::sort(pieces.begin(), pieces.end(), [](const PieceOfFile& a, const PieceOfFile& b) {
    return a.piece.rays.first < b.piece.rays.first;
  });
  return pieces;
}

/// Pieces are in the order of their first samples, so that few pairs are compared.
void require_no_overlap(const std::vector<PieceOfFile>& pieces) {
  for (std::size_t i = 0; i < pieces.size(); ++i) {
    const Piece& a = pieces[i].piece;
    for (std::size_t k = i + 1; k < pieces.size() && pieces[k].piece.rays.first < a.rays.end; ++k) {
      const Piece& b = pieces[k].piece;
      if (!overlap(a, b)) continue;
      const RayRange both{b.rays.first, std::min(a.rays.end, b.rays.end)};
      const PixelRect shared{std::max(a.rect.x0, b.rect.x0), std::max(a.rect.y0, b.rect.y0),
                             std::min(a.rect.x1, b.rect.x1), std::min(a.rect.y1, b.rect.y1)};
      const std::string names =
          pieces[i].part->path == pieces[k].part->path
              ? pieces[i].part->path + " is named twice: its "
              : fmt::format("{} and {} overlap: ", pieces[i].part->path, pieces[k].part->path);
      refuse(fmt::format("{}{} of the pixels {} would count twice", names, rays_text(both),
                         rect_text(shared)));
    }
  }
}

/// The order does not depend on that of the paths, so that the sum does not.
Parts describe_all(const std::vector<std::string>& paths) {
  if (paths.empty()) refuse("dapple merge needs the files of parts");
  std::vector<Part> parts;
  Settings of_first;
  for (const std::string& path : paths) {
    Checkpoint about = describe(path);
    const Settings settings = common_settings(about);
    if (parts.empty())
      of_first = settings;
    else
      require_one_picture(of_first, paths.front(), settings, path);
    parts.push_back(part_of(path, std::move(about)));
  }
  require_no_overlap(pieces_of(parts));
  const auto key = [](const Part& part) {
    const Piece& first = part.pieces.front();
    return std::tuple(first.rays.first, first.rect.y0, first.rect.x0);
  };
  std::sort(parts.begin(), parts.end(),
            [&](const Part& a, const Part& b) { return key(a) < key(b); });
  return {std::move(parts), std::move(of_first)};
}

/// Adds the devices of a part to those of the sum, each once.
void add_devices(std::string of_part, std::string& of_sum) {
  constexpr std::string_view kAnd = " and ";
  while (!of_part.empty()) {
    const std::size_t end = std::min(of_part.find(kAnd), of_part.size());
    const std::string name = of_part.substr(0, end);
    const std::string known = fmt::format("{0}{1}{0}", kAnd, of_sum);
    if (known.find(fmt::format("{0}{1}{0}", kAnd, name)) == std::string::npos)
      of_sum += std::string(kAnd) + name;
    of_part.erase(0, end + (end < of_part.size() ? kAnd.size() : 0));
  }
}

/// The description of the sum. Options are those of a render without --shard, if it is whole.
Checkpoint describe_sum(const std::vector<Part>& parts, const Settings& common) {
  Checkpoint sum = read_again(parts.front(), common, PartContents::description);
  sum.pieces.clear();
  for (const Part& part : parts) {
    sum.pieces.insert(sum.pieces.end(), part.pieces.begin(), part.pieces.end());
    sum.picture.options.visits = sum.picture.options.visits || part.visits;
    sum.picture.options.beauty = sum.picture.options.beauty || part.beauty;
    sum.picture.metadata.samples = std::max(sum.picture.metadata.samples, part.samples);
    add_devices(part.device, sum.device);
  }
  sum.pieces = joined(std::move(sum.pieces));
  const PixelRect& crop = sum.picture.crop = box_of(sum.pieces);
  for (auto& [name, value] : sum.options) {
    if (name == "--crop") value = fmt::format("{},{},{},{}", crop.x0, crop.y0, crop.x1, crop.y1);
    if (name == "--shard") value = "1/1";
  }
  return sum;
}

/// `has_tiles`: the parts are of several rectangles.
void add_notes(const Checkpoint& sum, const Merge& merge, bool has_tiles,
               RenderStatistics& statistics) {
  const std::string& first = sum.picture.metadata.device;
  if (sum.device != first) {
    statistics.notes.push_back(fmt::format(
        "parts were traced on {}: the picture's bits are not those of one device", sum.device));
  }
  if (!merge.missing.empty()) statistics.notes.push_back("parts are missing: " + merge.missing);
  const PixelRect &crop = sum.picture.crop,
                  whole{0, 0, sum.picture.width - 1, sum.picture.height - 1};
  if (has_tiles && crop != whole)
    statistics.notes.push_back(
        fmt::format("no part has pixels outside of {}; the picture is {} x {}", rect_text(crop),
                    sum.picture.width, sum.picture.height));
}

RenderResult film_of(const PictureRecord& picture, MergedSums&& sums) {
  RenderResult result;
  const FilmLayout layout = picture.layout();
  RenderStatistics& statistics = result.statistics;
  TracedPicture traced = std::move(sums).picture();
  statistics.pass_seconds = traced.pass_seconds;
  statistics.bytes.film = layout.sum_bytes();
  result.film = {
      picture.width,    picture.height,
      picture.crop,     develop(traced, layout, picture.options, picture.lights, statistics),
      picture.metadata, DeepAlpha{}};
  set_ambient(result.film.metadata, statistics.ambient);
  traced.mattes.keep_first();
  add_cryptomattes(result.film, traced.mattes, traced.samples, picture.names,
                   picture.options.cryptomattes);
  return result;
}

}  // namespace

Merge merge_parts(const std::vector<std::string>& paths, const std::string& output) {
  const Stopwatch total;
  const auto [parts, common] = describe_all(paths);
  Checkpoint sum = describe_sum(parts, common);
  const PictureRecord& picture = sum.picture;
  check_film_memory({{}, picture.width, picture.height, picture.crop}, picture.lights.size(),
                    picture.options);
  MergedSums sums(picture);
  for (const Part& part : parts) sums.add(part.path, read_again(part, common, PartContents::all));
  Merge merge;
  merge.spp = static_cast<std::uint32_t>(picture.metadata.samples);
  merge.missing = missing_text(sum.pieces, merge.spp);
  if (!output.empty()) sums.write(output, sum);
  merge.result = film_of(picture, std::move(sums));
  if (!merge.missing.empty())
    merge.result.film.metadata.settings.emplace_back("missing", merge.missing);
  const std::vector<PieceOfFile> pieces = pieces_of(parts);
  const bool has_tiles = std::any_of(pieces.begin(), pieces.end(), [&](const PieceOfFile& of) {
    return !(of.piece.rect == pieces.front().piece.rect);
  });
  add_notes(sum, merge, has_tiles, merge.result.statistics);
  merge.result.statistics.device = sum.device;
  merge.result.statistics.footprint = sum.footprint;
  merge.result.statistics.seconds.total = total.seconds();
  return merge;
}

}  // namespace dapple

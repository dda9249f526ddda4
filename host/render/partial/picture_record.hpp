// The part of a scene and its options that turns sums into layers. It is stored beside the sums, so
// that dapple merge needs no scene and no device. In: a render, or JSON. Out: JSON, or the record.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <vector>

#include "camera/view.hpp"
#include "film/cryptomatte.hpp"
#include "film/sums/film_sums.hpp"

namespace dapple {

/// The name of that setting in the metadata.
inline constexpr const char* kAmbient = "ambient";

struct PictureRecord {
  int width = 1, height = 1;  ///< of the display window
  PixelRect crop{0, 0, 0, 0};
  /// By sample; only the members that develop() and FilmLayout read, and `cryptomattes`.
  RenderOptions options;
  std::vector<Light> lights;  ///< only name, group, kind and radiance
  bool has_normals = false;
  FilmScales scales{1, 1, {}};
  MatteNames names;
  FilmMetadata metadata;  ///< without what is only known once the sums are: the sky of RGBA

  [[nodiscard]] FilmLayout layout() const { return {crop, options, scales, lights, has_normals}; }
};

/// `options` as by_sample() returns them; `metadata` as it is without the samples.
PictureRecord record_of(const View& view, const RenderOptions& options, const FilmLayout& layout,
                        const std::vector<Light>& lights, MatteNames names, FilmMetadata metadata);

/// Sets the metadata's radiance of the sky, which only the sums tell.
void set_ambient(FilmMetadata& metadata, double ambient);

nlohmann::json to_json(const PictureRecord& record);

/// Throws nlohmann::json::exception for other JSON, and Error failed, "damaged: ...", for values
/// that no picture has.
PictureRecord picture_record(const nlohmann::json& json);

}  // namespace dapple

// Writes the scenes of the corpus, small images and point files as the first inputs of the fuzzers.
// The command `seeds FOLDER` makes the folders FOLDER/gltf, image, radiance_hdr, exr, csv, npy, ply
// and suns.
#include <fmt/format.h>
#include <webp/encode.h>

#include <cstdio>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>
#include <utility>
#include <vector>

#include "corpus/corpus.hpp"
#include "dapple/film.hpp"
#include "points/point_file.hpp"
#include "support/files/compressed_gltf.hpp"
#include "support/files/draco_gltf.hpp"
#include "support/files/gltf_builder.hpp"

namespace {

/// Maximum bytes of a seed, as in tests/fuzz/run. Larger files of the corpus (bombs) are left out.
constexpr std::size_t kLargest = 20000;

using Bytes = std::vector<std::uint8_t>;

void write_seed(const std::filesystem::path& path, const Bytes& bytes) {
  if (bytes.size() > kLargest) return;
  std::filesystem::create_directories(path.parent_path());
  std::ofstream(path, std::ios::binary)
      .write(reinterpret_cast<const char*>(bytes.data()),
             static_cast<std::streamsize>(bytes.size()));
}

void write_scene(const std::filesystem::path& folder, const std::string& name,
                 const dapple::test::SceneFiles& files) {
  const auto scene = files.files.find(files.scene);
  if (scene != files.files.end()) write_seed(folder / name, scene->second);
}

void write_webp_images(const std::filesystem::path& folder) {
  constexpr int kSize = 5;
  Bytes rgba(4 * kSize * kSize);
  for (std::size_t i = 0; i < rgba.size(); ++i) rgba[i] = static_cast<std::uint8_t>(7 * i);
  std::uint8_t* data = nullptr;
  std::size_t size = WebPEncodeLosslessRGBA(rgba.data(), kSize, kSize, 4 * kSize, &data);
  write_seed(folder / "lossless.webp", Bytes(data, data + size));
  WebPFree(data);
  size = WebPEncodeRGBA(rgba.data(), kSize, kSize, 4 * kSize, 50, &data);
  write_seed(folder / "lossy.webp", Bytes(data, data + size));
  WebPFree(data);
}

/// A small PNG of each colour type and depth.
void write_images(const std::filesystem::path& folder) {
  constexpr std::size_t kSize = 5;
  for (const auto& [color_type, channels] : {std::pair(0, 1), {2, 3}, {4, 2}, {6, 4}}) {
    for (const std::size_t bytes : {1u, 2u}) {
      Bytes samples(kSize * kSize * static_cast<std::size_t>(channels) * bytes);
      for (std::size_t i = 0; i < samples.size(); ++i)
        samples[i] = static_cast<std::uint8_t>(7 * i);
      write_seed(folder / fmt::format("type_{}_{}.png", color_type, 8 * bytes),
                 dapple::test::png::encode(kSize, kSize, static_cast<std::uint8_t>(8 * bytes),
                                           static_cast<std::uint8_t>(color_type), samples));
    }
  }
}

/// Images whose lines are encoded, as only lines of eight pixels or more are, and not.
void write_radiance_images(const std::filesystem::path& folder) {
  const auto image = [](const std::string& size, const Bytes& pixels) {
    const std::string header = "#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n" + size + "\n";
    Bytes bytes(header.begin(), header.end());
    bytes.insert(bytes.end(), pixels.begin(), pixels.end());
    return bytes;
  };
  // Of each channel a run of five (128 + 5), and three values.
  Bytes line{2, 2, 0, 8};
  for (const auto value :
       {std::uint8_t{100}, std::uint8_t{90}, std::uint8_t{80}, std::uint8_t{129}})
    line.insert(line.end(), {133, value, 3, value, 2, value});
  Bytes lines = line;
  lines.insert(lines.end(), line.begin(), line.end());
  write_seed(folder / "encoded", image("-Y 2 +X 8", lines));
  write_seed(folder / "plain", image("-Y 2 +X 1", {1, 2, 3, 128, 4, 5, 6, 130}));
}

/// An EXR file of each compression, with 32 and with 16 bits.
void write_exr_images(const std::filesystem::path& folder) {
  using dapple::ExrCompression;
  constexpr int kWidth = 5, kHeight = 18;  // more lines than a block of ZIP has
  dapple::Film film;
  film.width = kWidth;
  film.height = kHeight;
  film.data_window = {0, 0, kWidth - 1, kHeight - 1};
  for (const char* channel : {"R", "G", "B"}) {
    dapple::Plane plane{channel, {}};
    for (int i = 0; i < kWidth * kHeight; ++i)
      plane.pixels.push_back(0.01f * static_cast<float>(i % 7));
    film.planes.push_back(plane);
  }
  std::filesystem::create_directories(folder);
  for (const auto compression : {ExrCompression::none, ExrCompression::zips, ExrCompression::zip,
                                 ExrCompression::piz, ExrCompression::dwaa}) {
    const std::string name = fmt::format("{}", static_cast<int>(compression));
    const bool multipart = compression == ExrCompression::dwaa;
    dapple::write_exr(film, folder / (name + ".exr"), {compression, multipart, {}});
    dapple::write_exr(film, folder / (name + "_half.exr"), {compression, true, {"all"}});
  }
}

/// A file of each format.
void write_points_and_suns(const std::filesystem::path& folder) {
  dapple::PointList list;
  list.points = {{1, 2, 3}, {0.5f, 0, -1}};
  list.normals = {{0, 1, 0}, {1, 0, 0}};
  for (const std::string format : {"csv", "npy", "ply"}) {
    std::filesystem::create_directories(folder / format);
    dapple::write_points(folder / format / ("points." + format), list, {{"ao", {0.25f, 1}}});
  }
  const std::string suns = "x,y,z,irradiance\n0,1,0,800\n0.5,0.5,0,300\n";
  write_seed(folder / "suns" / "suns.csv", Bytes(suns.begin(), suns.end()));
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 2) {
    std::fprintf(stderr, "usage: seeds FOLDER\n");
    return 2;
  }
  const std::filesystem::path folder(argv[1]);
  for (const auto& one : dapple::test::malformed_corpus())
    write_scene(folder / "gltf", one.name, one.files);
  for (const auto& one : dapple::test::tricky_corpus())
    write_scene(folder / "gltf", one.name, one.files);
  write_seed(folder / "gltf" / "compressed",
             dapple::test::compressed(dapple::test::one_triangle()).glb());
  for (const int method : {draco::MESH_EDGEBREAKER_ENCODING, draco::MESH_SEQUENTIAL_ENCODING})
    write_seed(
        folder / "gltf" / fmt::format("draco_{}", method),
        dapple::test::draco_compressed(dapple::test::one_triangle(), {.method = method}).glb());
  write_images(folder / "image");
  write_webp_images(folder / "image");
  write_radiance_images(folder / "radiance_hdr");
  write_exr_images(folder / "exr");
  write_points_and_suns(folder);
  return 0;
}

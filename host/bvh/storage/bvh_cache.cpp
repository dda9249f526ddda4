#include "bvh/storage/bvh_cache.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>
#include <filesystem>

#include "bvh/storage/builder_version.hpp"
#include "bvh/storage/object_validation.hpp"
#include "dapple/bvh.hpp"
#include "dapple/error.hpp"
#include "files/output_file.hpp"
#include "files/sealed_file.hpp"
#include "files/temporary_file.hpp"

namespace dapple {
namespace {

namespace fs = std::filesystem;

constexpr SealedKind kKind{"BVH cache", 1};

constexpr std::size_t kRecord = 0, kBuilder = 1, kNodes = 2, kBlocks = 3, kTextured = 4,
                      kSegments = 5, kPrimitives = 6;

using BoxRecord = std::array<float, 6>;

/// An ObjectSummary as plain data, with the key of the object and its build time.
struct ObjectRecord {
  Checksum key;
  double build_seconds, sah_cost;
  std::uint64_t primitive_count, opaque, cut_out, translucent;
  BoxRecord box;
  std::array<BoxRecord, DAPPLE_BVH_WIDTH> parts;
  std::array<float, 3> axes;
  std::array<float, 6> normals;
  float clumping, mass_concentration;
  std::array<float, 3> mass_pole;
  std::uint32_t part_count, stack, wall, spare;
};
static_assert(sizeof(ObjectRecord) == 2 * 8 + 6 * 8 + (6 + 8 * 6 + 3 + 6 + 2 + 3) * 4 + 4 * 4);

BoxRecord box_record(const Box3f& box) {
  return {box.min.x, box.min.y, box.min.z, box.max.x, box.max.y, box.max.z};
}

Box3f box_of(const BoxRecord& r) { return {V3f(r[0], r[1], r[2]), V3f(r[3], r[4], r[5])}; }

ObjectRecord record_of(const CachedObject& cached, const Checksum& key) {
  const FinishedObject& object = cached.object;
  ObjectRecord record{};
  record.key = key;
  record.build_seconds = cached.build_seconds;
  record.sah_cost = object.sah_cost;
  record.primitive_count = object.primitive_count;
  record.opaque = object.opaque;
  record.cut_out = object.cut_out;
  record.translucent = object.translucent;
  record.box = box_record(object.box);
  std::transform(object.parts.begin(), object.parts.end(), record.parts.begin(), box_record);
  for (int axis = 0; axis < 3; ++axis) record.axes[axis] = object.opacity.axes[axis];
  record.normals = object.opacity.normals.sum;
  record.clumping = object.opacity.clumping;
  record.mass_concentration = object.opacity.mass.concentration;
  for (int axis = 0; axis < 3; ++axis) record.mass_pole[axis] = object.opacity.mass.pole[axis];
  record.part_count = static_cast<std::uint32_t>(object.parts.size());
  record.stack = object.stack;
  record.wall = object.opacity.wall ? 1 : 0;
  return record;
}

ObjectSummary summary_of(const ObjectRecord& record) {
  ObjectSummary summary;
  summary.sah_cost = record.sah_cost;
  summary.primitive_count = record.primitive_count;
  summary.opaque = record.opaque;
  summary.cut_out = record.cut_out;
  summary.translucent = record.translucent;
  summary.box = box_of(record.box);
  for (std::size_t i = 0; i < std::min<std::size_t>(record.part_count, DAPPLE_BVH_WIDTH); ++i)
    summary.parts.push_back(box_of(record.parts[i]));
  summary.opacity.axes = V3f(record.axes[0], record.axes[1], record.axes[2]);
  summary.opacity.normals.sum = record.normals;
  summary.opacity.clumping = record.clumping;
  summary.opacity.mass = {record.mass_concentration,
                          V3f(record.mass_pole[0], record.mass_pole[1], record.mass_pole[2])};
  summary.stack = record.stack;
  summary.opacity.wall = record.wall != 0;
  return summary;
}

std::string file_of(const std::string& folder, const Checksum& key) {
  return (fs::path(folder) / (hex_text(key) + ".bvh")).string();
}

bool is_there(const std::string& path) {
  std::error_code ignored;
  return fs::exists(fs::symlink_status(path, ignored));
}

CachedObject read_object(const std::string& path, const Checksum& key, const Scene& scene) {
  const SealedFile file = open_sealed_file(path, kKind);
  const auto builder = file.values<char>(kBuilder);
  if (std::string_view(builder.data(), builder.size()) != builder_version()) {
    throw Error(ErrorKind::input, path + ": made by another version of dapple");
  }
  const auto records = file.values<ObjectRecord>(kRecord);
  if (records.size() != 1 || records[0].key != key) {
    throw Error(ErrorKind::input, path + ": made of another mesh and renamed");
  }
  CachedObject cached;
  static_cast<ObjectSummary&>(cached.object) = summary_of(records[0]);
  cached.build_seconds = records[0].build_seconds;
  cached.object.nodes = {file.values<BvhNode>(kNodes), file.keeper()};
  cached.object.blocks = {file.values<TriangleBlock>(kBlocks), file.keeper()};
  cached.object.segments = {file.values<SegmentBlock>(kSegments), file.keeper()};
  cached.object.has_strands = !cached.object.segments.empty();
  cached.object.textured = {file.values<TexturedTriangle>(kTextured), file.keeper()};
  cached.object.primitives = {file.values<std::uint32_t>(kPrimitives), file.keeper()};
  if (records[0].part_count > DAPPLE_BVH_WIDTH || !is_sound(cached.object, scene)) {
    throw Error(ErrorKind::input, path + ": not a valid BVH");
  }
  return cached;
}

[[noreturn]] void refuse_folder(const std::string& folder, const std::string& reason) {
  throw Error(ErrorKind::usage, fmt::format("--cache {}: {}", folder, reason));
}

}  // namespace

FinishedObject::FinishedObject(ObjectBvh&& object)
    : ObjectSummary(std::move(object)),
      nodes(std::move(object.nodes)),
      blocks(std::move(object.blocks)),
      segments(std::move(object.segments)),
      textured(std::move(object.textured)),
      primitives(std::move(object.primitives)) {}

void prepare_bvh_cache(const std::string& folder) {
  std::error_code problem;
  const fs::file_status status = fs::status(folder, problem);
  if (fs::exists(status) && !fs::is_directory(status)) refuse_folder(folder, "it is not a folder");
  fs::create_directories(folder, problem);
  if (problem) refuse_folder(folder, "it cannot be made: " + problem.message());
  if (access(folder.c_str(), R_OK | W_OK | X_OK) != 0) {
    refuse_folder(folder, std::string("files cannot be kept there: ") + std::strerror(errno));
  }
  remove_abandoned_files(folder);
}

std::optional<CachedObject> read_cached_object(const std::string& folder, const Checksum& key,
                                               const Scene& scene, std::string& note) {
  const std::string path = file_of(folder, key);
  if (!is_there(path)) return std::nullopt;
  try {
    return read_object(path, key, scene);
  } catch (const Error& error) {
    note = error.what();
    return std::nullopt;
  }
}

// Does not wait until the disk has stored the file: an object whose file a power failure damages is
// built again.
void write_cached_object(const std::string& folder, const Checksum& key,
                         const CachedObject& cached) {
  const std::string path = file_of(folder, key);
  remove_link(path);
  const ObjectRecord record = record_of(cached, key);
  const std::string_view builder = builder_version();
  const FinishedObject& object = cached.object;
  write_sealed_file(
      path, kKind,
      {as_section(std::span(&record, 1)), as_section(builder), as_section(object.nodes),
       as_section(object.blocks), as_section(object.textured), as_section(object.segments),
       as_section(object.primitives)},
      Durable::no);
}

}  // namespace dapple

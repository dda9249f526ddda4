// The BVH cache: an object that is read from it has the same bits as the one that was built. If a
// file is damaged or does not fit, the object is built again, with the same bits.
#include "bvh/storage/bvh_cache.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <fstream>
#include <functional>
#include <limits>
#include <random>

#include "bvh/storage/builder_version.hpp"
#include "bvh/storage/object_key.hpp"
#include "dapple/bvh.hpp"
#include "files/sealed_file.hpp"
#include "support/files/film_files.hpp"
#include "support/same_bits.hpp"
#include "support/scenes/curly_strands.hpp"

namespace dapple {
namespace {

using namespace film_test;

namespace fs = std::filesystem;

Mesh random_mesh(unsigned seed, std::uint32_t triangles, std::uint32_t material) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<float> at(-1, 1), in(0, 1);
  Mesh mesh;
  for (std::uint32_t t = 0; t < triangles; ++t) {
    const V3f p(at(random), at(random), at(random));
    for (std::uint32_t corner = 0; corner < 3; ++corner) {
      mesh.positions.push_back(p + 0.2f * V3f(at(random), at(random), at(random)));
      mesh.uvs.emplace_back(in(random), in(random));
      mesh.vertex_alpha.push_back(in(random));
      mesh.indices.push_back(3 * t + corner);
    }
    mesh.materials.push_back(material);
  }
  return mesh;
}

/// Two meshes with random vertex alphas: one has a cut-out texture and two instances, the other is
/// blended.
Scene leafy_scene() {
  Scene scene;
  scene.source = "test";
  Texture texture;
  texture.width = texture.height = 8;
  for (int i = 0; i < 64; ++i) texture.alpha.push_back(static_cast<std::uint8_t>(i * 37 % 256));
  scene.textures = {texture, texture};
  Material cut_out, blended;
  cut_out.alpha_mode = AlphaMode::mask;
  cut_out.alpha_texture = 0;
  blended.alpha_mode = AlphaMode::blend;
  blended.alpha = 0.7f;
  scene.materials = {cut_out, blended};
  scene.meshes = {random_mesh(1, 300, 0), random_mesh(2, 400, 1)};
  scene.instances = {{0, M44f(), -1},
                     {0, M44f().setTranslation(V3f(3, 0, 1)), -1},
                     {1, M44f().setTranslation(V3f(0, 2, 0)), -1}};
  return scene;
}

/// One object without a transform, so that the arrays of its BVH equal those in the file.
Scene single_object() {
  Scene scene = leafy_scene();
  scene.instances.resize(1);
  scene.meshes.resize(1);
  return scene;
}

Scene strands_and_leaves() {
  Scene scene = single_object();
  scene_test::place(scene, scene_test::curly_strands({.strands = 40}));
  return scene;
}

void expect_same(const SceneBvh& a, const SceneBvh& b) {
  EXPECT_TRUE(same_bits(a.nodes, b.nodes));
  EXPECT_TRUE(same_bits(a.blocks, b.blocks));
  EXPECT_TRUE(same_bits(a.segments, b.segments));
  EXPECT_TRUE(same_bits(a.textured, b.textured));
  EXPECT_TRUE(same_bits(a.primitives, b.primitives));
  EXPECT_TRUE(same_bits(a.instances, b.instances));
  EXPECT_EQ(a.root, b.root);
  EXPECT_EQ(a.has_top, b.has_top);
  EXPECT_EQ(a.bounds, b.bounds);
  const BvhStatistics &s = a.statistics, &t = b.statistics;
  EXPECT_EQ(std::tuple(s.triangles, s.opaque, s.cut_out, s.translucent, s.instanced_triangles),
            std::tuple(t.triangles, t.opaque, t.cut_out, t.translucent, t.instanced_triangles));
  EXPECT_EQ(std::tuple(s.lane_use, s.sah_cost), std::tuple(t.lane_use, t.sah_cost));
  for (int axis = 0; axis < 3; ++axis) EXPECT_EQ(s.root_opacity[axis], t.root_opacity[axis]);
}

class BvhCache : public FilmFile {
 protected:
  BvhCache() : cache_((folder_ / "cache").string()) {}

  [[nodiscard]] std::vector<std::string> cached_files() const {
    std::vector<std::string> files;
    for (const auto& entry : fs::directory_iterator(cache_)) files.push_back(entry.path().string());
    std::sort(files.begin(), files.end());
    return files;
  }

  /// Fills the cache with a scene of one object. Returns the path of the only file.
  std::string fill_with_one() const {
    build_bvh(single_object(), cache_);
    const auto files = cached_files();
    EXPECT_EQ(files.size(), 1u);
    return files.empty() ? "" : files[0];
  }

  /// Builds the scene of one object. Expects that the cache refuses `file`, with `reason` in its
  /// note, and replaces it.
  void expect_rebuilt(const std::string& file, const SceneBvh& expected,
                      const std::string& reason = "") const {
    const SceneBvh bvh = build_bvh(single_object(), cache_);
    EXPECT_EQ(bvh.statistics.cache.objects_read, 0u);
    EXPECT_EQ(bvh.statistics.cache.objects_written, 1u);
    const std::string& note = bvh.statistics.cache.note;
    EXPECT_TRUE(contains(note, file)) << note;
    EXPECT_TRUE(contains(note, reason)) << note;
    expect_same(bvh, expected);
  }

  std::string cache_;
};

TEST_F(BvhCache, ASecondBuildReadsTheSameBitsAndBuildsNothing) {
  for (const Scene& scene : {leafy_scene(), single_object(), strands_and_leaves()}) {
    SCOPED_TRACE(scene.meshes.size());
    fs::remove_all(cache_);
    const SceneBvh without = build_bvh(scene), first = build_bvh(scene, cache_),
                   second = build_bvh(scene, cache_);
    EXPECT_EQ(first.statistics.cache.objects_written, scene.meshes.size());
    EXPECT_EQ(second.statistics.cache.objects_read, scene.meshes.size());
    EXPECT_EQ(second.statistics.cache.objects_written, 0u);
    EXPECT_EQ(second.statistics.cache.note, "");
    EXPECT_EQ(cached_files().size(), scene.meshes.size());
    expect_same(first, without);
    expect_same(second, without);
  }
}

TEST_F(BvhCache, ABvhRemainsValidAfterItsFileIsRemoved) {
  fill_with_one();
  const SceneBvh bvh = build_bvh(single_object(), cache_);
  fs::remove_all(cache_);
  expect_same(bvh, build_bvh(single_object()));
}

TEST_F(BvhCache, ChangesThatDoNotAffectABvhKeepItsFile) {
  build_bvh(leafy_scene(), cache_);
  Scene scene = leafy_scene();
  scene.source = "another";
  scene.instances.pop_back();
  scene.instances[0].to_world.setTranslation(V3f(7, 7, 7));
  scene.lights.push_back({});
  scene.cameras.push_back({});
  scene.meshes[0].name = scene.materials[0].name = scene.textures[0].name = "renamed";
  scene.materials[0].emission = V3f(1, 2, 3);
  scene.materials[1].alpha = 0.1f;  // the material of the other mesh
  const SceneBvh bvh = build_bvh(scene, cache_);
  EXPECT_EQ(bvh.statistics.cache.objects_read, 1u);
  EXPECT_EQ(bvh.statistics.cache.objects_written, 1u);
  expect_same(bvh, build_bvh(scene));
}

TEST_F(BvhCache, EveryInputOfABvhChangesItsKey) {
  const Scene original = single_object();
  const Checksum key = object_key(original, original.meshes[0]);
  const std::vector<std::function<void(Scene&)>> edits = {
      [](Scene& s) { s.meshes[0].positions[5].y += 1e-6f; },
      [](Scene& s) { std::swap(s.meshes[0].indices[0], s.meshes[0].indices[1]); },
      [](Scene& s) { s.meshes[0].uvs[7].x += 1e-6f; },
      [](Scene& s) { s.meshes[0].vertex_alpha[9] *= 0.5f; },
      [](Scene& s) { s.meshes[0].vertex_alpha.clear(); },
      [](Scene& s) { s.meshes[0].materials[0] = 1; },
      [](Scene& s) { s.materials[0].alpha_mode = AlphaMode::blend; },
      [](Scene& s) { s.materials[0].alpha = 0.9f; },
      [](Scene& s) { s.materials[0].alpha_cutoff = 0.4f; },
      [](Scene& s) { s.materials[0].uses_vertex_alpha = false; },
      [](Scene& s) { s.materials[0].alpha_texture = 1; },
      [](Scene& s) { s.materials[0].alpha_texture = -1; },
      [](Scene& s) { s.textures[0].alpha[63] ^= 1; },
      [](Scene& s) { s.textures[0].wrap_s = Wrap::clamp; },
      [](Scene& s) { s.textures[0].wrap_t = Wrap::mirror; },
      [](Scene& s) { s.textures[0].nearest = true; },
      [](Scene& s) { std::tie(s.textures[0].width, s.textures[0].height) = std::pair(16u, 4u); },
  };
  for (std::size_t e = 0; e < edits.size(); ++e) {
    Scene edited = original;
    edits[e](edited);
    EXPECT_NE(object_key(edited, edited.meshes[0]), key) << "edit " << e;
  }
  EXPECT_EQ(object_key(original, original.meshes[0]), key);
  const Scene hair = strands_and_leaves();
  Scene thicker = hair;
  thicker.meshes[1].radii[5] *= 1.001f;
  EXPECT_NE(object_key(thicker, thicker.meshes[1]), object_key(hair, hair.meshes[1]));
}

TEST_F(BvhCache, ObjectsOfFewTrianglesHaveNoFiles) {
  Scene scene = single_object();
  scene.meshes[0] = random_mesh(3, 255, 1);
  const SceneBvh bvh = build_bvh(scene, cache_);
  EXPECT_EQ(bvh.statistics.cache.objects_written, 0u);
  EXPECT_TRUE(cached_files().empty());
  expect_same(bvh, build_bvh(scene));
}

TEST_F(BvhCache, AFileWithAnyBitFlippedIsNotRead) {
  const std::string file = fill_with_one();
  const Scene scene = single_object();
  const Checksum key = object_key(scene, scene.meshes[0]);
  const std::size_t bits = 8 * fs::file_size(file);
  std::vector<std::size_t> flipped;
  for (std::size_t bit = 0; bit < 8 * 1024; ++bit) flipped.push_back(bit);  // up to the nodes
  std::mt19937_64 random(5);
  for (int i = 0; i < 5000; ++i) flipped.push_back(random() % bits);
  std::string note;
  for (const std::size_t bit : flipped) {
    note.clear();
    flip_bit(file, bit);
    ASSERT_FALSE(read_cached_object(cache_, key, scene, note).has_value()) << bit;
    ASSERT_TRUE(contains(note, file + ": ")) << note;
    flip_bit(file, bit);
  }
  EXPECT_TRUE(read_cached_object(cache_, key, scene, note).has_value());
}

TEST_F(BvhCache, AFlippedBitIsBuiltAnewIntoTheSameTree) {
  const SceneBvh expected = build_bvh(single_object());
  const std::string file = fill_with_one();
  const std::size_t bits = 8 * fs::file_size(file);
  for (std::size_t i = 0; i < 100; ++i) {
    flip_bit(file, i * i * (bits / 10000));
    expect_rebuilt(file, expected);
    ASSERT_FALSE(HasFailure()) << i;
  }
  EXPECT_EQ(build_bvh(single_object(), cache_).statistics.cache.objects_read, 1u);
}

// Others may write in the folder, and know the names of its files.
TEST_F(BvhCache, ALinkInPlaceOfAFileIsReplacedAndNotFollowed) {
  const SceneBvh expected = build_bvh(single_object());
  const std::string file = fill_with_one();
  const std::string victim = cache_ + "/victim.txt";
  std::ofstream(victim) << "precious";
  fs::remove(file);
  fs::create_symlink(victim, file);
  expect_rebuilt(file, expected);
  EXPECT_FALSE(fs::is_symlink(file));
  EXPECT_EQ(fs::file_size(victim), 8u);
}

TEST_F(BvhCache, AFileCutShortAnywhereIsNotRead) {
  const std::string file = fill_with_one();
  const Scene scene = single_object();
  const Checksum key = object_key(scene, scene.meshes[0]);
  std::string note;
  ASSERT_TRUE(read_cached_object(cache_, key, scene, note).has_value());
  // The test of sealed files tries every length.
  for (std::size_t size = fs::file_size(file); size > 0;) {
    size -= std::min<std::size_t>(size, size > 1024 ? 97 : 1);
    fs::resize_file(file, size);
    note.clear();
    ASSERT_FALSE(read_cached_object(cache_, key, scene, note).has_value()) << size;
    ASSERT_TRUE(contains(note, file + ": ")) << note;
  }
  expect_rebuilt(file, build_bvh(scene), "it is empty");
}

/// Rewrites the file as another version of the builder or of the format would write it. If
/// `builder` is empty, the builder's version stays.
void rewrite(const std::string& path, const SealedKind& kind, const std::string& builder) {
  const SealedFile file = open_sealed_file(path, {"BVH cache", 1});
  std::vector<Section> sections;
  for (std::size_t i = 0; i < file.section_count(); ++i) sections.push_back(file.section(i));
  if (!builder.empty()) sections[1] = as_section(builder);
  write_sealed_file(path, kind, sections);
}

TEST_F(BvhCache, AFileOfAnotherVersionOrMeshIsReplaced) {
  const SceneBvh expected = build_bvh(single_object());
  const std::string file = fill_with_one();
  rewrite(file, {"BVH cache", 0}, "");
  expect_rebuilt(file, expected, "version 0, this program reads version 1");
  rewrite(file, {"BVH cache", 1}, "0123");
  expect_rebuilt(file, expected, "another version of dapple");
  rewrite(file, {"checkpoint", 1}, "");
  expect_rebuilt(file, expected, "no BVH cache file");
  write_bytes(file, "not a file of ours, but a text that is longer than the header would be: " +
                        std::string(500, '.'));
  expect_rebuilt(file, expected, "no BVH cache file");

  Scene other = single_object();
  other.meshes[0] = random_mesh(9, 300, 0);
  build_bvh(other, cache_);
  for (const std::string& path : cached_files()) {
    if (path != file) fs::rename(path, file);
  }
  expect_rebuilt(file, expected, "made of another mesh");
}

/// A copy of the cached object whose arrays can be edited.
ObjectBvh copy_of(const FinishedObject& object) {
  ObjectBvh copy;
  static_cast<ObjectSummary&>(copy) = object;
  copy.nodes.assign(object.nodes.begin(), object.nodes.end());
  copy.blocks.assign(object.blocks.begin(), object.blocks.end());
  copy.segments.assign(object.segments.begin(), object.segments.end());
  copy.textured.assign(object.textured.begin(), object.textured.end());
  copy.primitives.assign(object.primitives.begin(), object.primitives.end());
  return copy;
}

TEST_F(BvhCache, ASealedFileWithIndicesOutOfBoundsIsRefused) {
  fill_with_one();
  const Scene scene = single_object();
  const Checksum key = object_key(scene, scene.meshes[0]);
  std::string note;
  const CachedObject good = read_cached_object(cache_, key, scene, note).value();
  const std::vector<std::function<void(ObjectBvh&)>> edits = {
      [](ObjectBvh& o) { o.nodes.clear(); },
      [](ObjectBvh& o) { o.nodes.pop_back(); },
      [](ObjectBvh& o) { o.blocks.pop_back(); },
      [](ObjectBvh& o) { o.nodes[0].child_base = 0; },
      [](ObjectBvh& o) { o.nodes[0].child_base = 0xfffffff8u; },
      [](ObjectBvh& o) { o.nodes.back().inner_mask = 1; },
      [](ObjectBvh& o) { o.nodes.back().prim_base = 0xffffffffu; },
      [](ObjectBvh& o) {
        o.nodes.back().prim_base |= 7u << DAPPLE_FIRST_LANE_SHIFT;
        o.nodes.back().leaf_end[0] = 6;
      },
      [](ObjectBvh& o) { o.nodes.back().prim_base += static_cast<uint>(o.blocks.size()); },
      [](ObjectBvh& o) { o.nodes.back().leaf_end[0] = 63; },
      [](ObjectBvh& o) { o.blocks[3].opacity[0] = -400; },
      [](ObjectBvh& o) { o.blocks[3].opacity[0] = std::numeric_limits<float>::quiet_NaN(); },
      [](ObjectBvh& o) { o.textured[7].corner[0][1] |= 1023u; },
      [](ObjectBvh& o) { o.primitives.pop_back(); },
      [](ObjectBvh& o) { --o.stack; },
  };
  for (std::size_t e = 0; e < edits.size(); ++e) {
    ObjectBvh bad = copy_of(good.object);
    edits[e](bad);
    write_cached_object(cache_, key, {FinishedObject(std::move(bad)), 0});
    EXPECT_FALSE(read_cached_object(cache_, key, scene, note).has_value()) << "edit " << e;
    EXPECT_TRUE(contains(note, "not a valid BVH")) << note;
  }
}

TEST_F(BvhCache, ASealedFileWithInvalidStrandsIsRefused) {
  Scene scene = single_object();
  scene.meshes = {scene_test::curly_strands({.strands = 40}, 1)};
  build_bvh(scene, cache_);
  const Checksum key = object_key(scene, scene.meshes[0]);
  std::string note;
  const CachedObject good = read_cached_object(cache_, key, scene, note).value();
  const std::vector<std::function<void(ObjectBvh&)>> edits = {
      [](ObjectBvh& o) { o.segments.pop_back(); },
      [](ObjectBvh& o) { o.nodes.back().prim_base &= ~DAPPLE_SEGMENTS; },
      [](ObjectBvh& o) { o.segments[3].opacity = 1.5f; },
      [](ObjectBvh& o) { o.segments[3].radius = std::numeric_limits<float>::quiet_NaN(); },
  };
  for (std::size_t e = 0; e < edits.size(); ++e) {
    ObjectBvh bad = copy_of(good.object);
    edits[e](bad);
    write_cached_object(cache_, key, {FinishedObject(std::move(bad)), 0});
    EXPECT_FALSE(read_cached_object(cache_, key, scene, note).has_value()) << "edit " << e;
  }
}

TEST_F(BvhCache, AFileThatCannotBeReplacedIsANoteAndNotAnError) {
  const std::string file = fill_with_one();
  fs::remove(file);
  fs::create_directory(file);
  const SceneBvh bvh = build_bvh(single_object(), cache_);
  EXPECT_EQ(bvh.statistics.cache.objects_written, 0u);
  EXPECT_TRUE(contains(bvh.statistics.cache.note, "it is a folder")) << bvh.statistics.cache.note;
  expect_same(bvh, build_bvh(single_object()));
}

}  // namespace
}  // namespace dapple

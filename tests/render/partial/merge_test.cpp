// Parts of a picture add up to the bits of one render: shards of any sizes and crops, in any order,
// at once or in steps, with every layer. What is missing is said; parts of other pictures, damaged
// ones, unfinished ones and those that overlap are refused by name.
#include "render/partial/merge.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <numeric>
#include <random>

#include "render/partial/checkpoint.hpp"
#include "support/files/film_files.hpp"
#include "support/scenes/scene_on_device.hpp"
#include "support/scenes/swaying_tree.hpp"

namespace dapple {
namespace {

using namespace film_test;

RenderOptions small_picture() {
  RenderOptions options;
  options.width = 40;
  options.height = 36;
  options.spp = 11;
  options.ao_rays = 40;  // a shard has several slices
  options.back = options.beauty = true;
  options.camera_splitting = 2;
  options.cryptomattes = {true, true};
  options.report_bias = 0;  // a merged picture has no report in its metadata
  return options;
}

Scene tree() { return make_procedural("scene:tree?leaves=1000"); }

Film draw(const RenderOptions& options, const std::string& part = "") {
  RenderControl control;
  control.part = part;
  control.settings = {{"frame_seconds", "1.5"}};
  return render(tree(), options, control).film;
}

void expect_same(const Film& a, const Film& b) {
  EXPECT_EQ(a.data_window, b.data_window);
  ASSERT_EQ(a.planes.size(), b.planes.size());
  for (std::size_t i = 0; i < a.planes.size(); ++i) {
    EXPECT_EQ(a.planes[i].channel, b.planes[i].channel);
    EXPECT_EQ(bits_of(a.planes[i].pixels), bits_of(b.planes[i].pixels)) << a.planes[i].channel;
  }
  EXPECT_EQ(a.metadata.settings, b.metadata.settings);
  EXPECT_EQ(a.metadata.attributes, b.metadata.attributes);
  EXPECT_EQ(a.metadata.samples, b.metadata.samples);
  EXPECT_EQ(a.metadata.world_to_camera, b.metadata.world_to_camera);
  EXPECT_EQ(a.metadata.world_to_ndc, b.metadata.world_to_ndc);
  EXPECT_EQ(a.metadata.scene, b.metadata.scene);
  EXPECT_EQ(a.metadata.device, b.metadata.device);
}

class MergeParts : public FilmFile {
 protected:
  /// Renders a shard, and with a crop only a part of its pixels; returns its path.
  std::string part(int index, int count, std::optional<PixelRect> crop = {}) {
    RenderOptions options = small_picture();
    options.shard = {index, count};
    options.crop = crop;
    const std::string name = path(std::to_string(made_++) + ".dapple");
    draw(options, name);
    return name;
  }
  void expect_refused(const std::vector<std::string>& parts, const std::string& why,
                      ErrorKind kind = ErrorKind::usage) {
    const Error error = error_of([&] { merge_parts(parts, path("no.dapple")); });
    EXPECT_EQ(error.kind(), kind) << error.what();
    EXPECT_TRUE(contains(error.what(), why)) << why << " is not in: " << error.what();
    EXPECT_FALSE(std::filesystem::exists(path("no.dapple")));
  }

 private:
  int made_ = 0;
};

TEST_F(MergeParts, ShardsOfAnySizesInAnyOrderAreTheBitsOfOneRender) {
  const Film whole = draw(small_picture());
  std::vector<std::string> parts{part(1, 2), part(4, 6), part(5, 6), part(6, 6)};
  std::mt19937 random(3);
  for (int i = 0; i < 4; ++i) {
    std::shuffle(parts.begin(), parts.end(), random);
    const Merge merge = merge_parts(parts);
    EXPECT_EQ(merge.missing, "");
    EXPECT_TRUE(merge.result.statistics.notes.empty());
    expect_same(merge.result.film, whole);
  }
}

TEST_F(MergeParts, LayersThatAreMadeOfTheSameSumsAreThereIfOnePartHasThem) {
  RenderOptions options = small_picture();
  options.beauty = false;
  options.shard = {2, 2};
  draw(options, path("without.dapple"));
  options.visits = true;
  options.beauty = true;
  options.shard = {1, 2};
  draw(options, path("with.dapple"));
  for (const auto& [first, second] : {std::pair{"with", "without"}, {"without", "with"}}) {
    const Film film =
        merge_parts({path(std::string(first) + ".dapple"), path(std::string(second) + ".dapple")})
            .result.film;
    for (const char* channel : {"beauty.ambient.R", "beauty.sun.R", "visits.nodes"})
      EXPECT_NE(film.find(channel), nullptr) << channel << ", " << first;
  }
}

/// How much of what camera rays hit is hidden from behind.
double hidden_from_behind(const Film& film) {
  const auto total = [&](const char* channel) {
    const auto& pixels = film.find(channel)->pixels;
    return std::accumulate(pixels.begin(), pixels.end(), 0.0);
  };
  return (static_cast<double>(film.find("A")->pixels.size()) - total("ao.back.R")) / total("A");
}

TEST_F(MergeParts, PixelsWhoseBacksOtherShardsHaveTakeThoseOfTheirNeighbours) {
  RenderOptions options = small_picture();
  options.spp = options.back_every = 16;
  options.back = true;
  const double whole = hidden_from_behind(draw(options));
  options.shard = {2, 4};
  draw(options, path("backs.dapple"));
  EXPECT_NEAR(hidden_from_behind(merge_parts({path("backs.dapple")}).result.film), whole,
              0.1 * whole);
}

TEST_F(MergeParts, CropsStitchAndSoDoShardsOfCrops) {
  const Film whole = draw(small_picture());
  const PixelRect left{0, 0, 18, 35}, above{19, 0, 39, 20}, below{19, 21, 39, 35};
  const std::vector<std::string> parts{part(2, 3, left), part(1, 1, above), part(1, 3, left),
                                       part(1, 1, below), part(3, 3, left)};
  expect_same(merge_parts(parts).result.film, whole);
  const Merge lacking = merge_parts({parts[0], parts[1], parts[2], parts[3]});
  EXPECT_EQ(lacking.missing, "samples 8 to 11 of 11 of the pixels 0,0 to 18,35");
}

TEST_F(MergeParts, AMergeMayBeMergedAndGoesOnToMoreSamples) {
  const std::vector<std::string> parts{part(1, 4), part(2, 4), part(3, 4), part(4, 4)};
  merge_parts({parts[3], parts[0]}, path("outer.dapple"));
  merge_parts({parts[1], path("outer.dapple")}, path("three.dapple"));
  const Merge all = merge_parts({path("three.dapple"), parts[2]}, path("all.dapple"));
  expect_same(all.result.film, draw(small_picture()));
  merge_parts(parts, path("at_once.dapple"));
  // A merge of merges has no more in it. Seconds compress differently from run to run, and sections
  // are padded.
  EXPECT_NEAR(static_cast<double>(bytes_of(path("at_once.dapple")).size()),
              static_cast<double>(bytes_of(path("all.dapple")).size()), 1024);
  RenderOptions more = small_picture();
  more.spp = 20;
  RenderControl control;
  control.settings = {{"frame_seconds", "1.5"}};
  control.resume = path("all.dapple");
  const RenderResult resumed = render(tree(), more, control);
  more.footprint_spp = 11;
  expect_same(resumed.film, draw(more));
  control.resume = path("outer.dapple");
  const Error error = error_of([&] { render(tree(), more, control); });
  EXPECT_TRUE(contains(error.what(), "lacks samples 3 to 8 of 11")) << error.what();
}

TEST_F(MergeParts, WhatIsMissingIsSaidAndTheRestIsAPicture) {
  const std::vector<std::string> parts{part(1, 4), part(2, 4), part(4, 4)};
  const Merge merge = merge_parts(parts);
  EXPECT_EQ(merge.missing, "samples 6 to 8 of 11");
  EXPECT_TRUE(contains(merge.result.statistics.notes.at(0), "missing: samples 6 to 8 of 11"));
  EXPECT_EQ(merge.result.film.metadata.settings.back(),
            std::pair(std::string("missing"), std::string("samples 6 to 8 of 11")));
  for (const float count : merge.result.film.find("samples")->pixels) EXPECT_EQ(count, 8);
}

TEST_F(MergeParts, AnInterruptedShardResumesToTheSameFile) {
  RenderOptions options = small_picture();
  options.shard = {2, 2};
  const std::string whole = part(2, 2);
  RenderControl control;
  control.settings = {{"frame_seconds", "1.5"}};
  control.checkpoint = path("a.ckpt");
  control.part = path("part.dapple");
  int left = 1;
  control.stop = [&] { return left-- == 0; };
  EXPECT_TRUE(render(tree(), options, control).interrupted);
  EXPECT_FALSE(std::filesystem::exists(path("part.dapple"))) << "a part is whole or not there";
  expect_refused({path("a.ckpt")}, "a.ckpt: is not finished");
  control.resume = control.checkpoint;
  control.stop = {};
  EXPECT_FALSE(render(tree(), options, control).interrupted);
  const std::string first = part(1, 2);
  expect_same(merge_parts({first, path("part.dapple")}).result.film,
              merge_parts({first, whole}).result.film);
  options.shard = {1, 2};
  const Error error = error_of([&] { render(tree(), options, control); });
  EXPECT_TRUE(contains(error.what(), "--shard 2/2 of --spp 11, this run has --shard 1/2"))
      << error.what();
}

TEST_F(MergeParts, MotionVectorsAddUp) {
  const auto at = [](double seconds) {
    return make_procedural("scene:tree?leaves=1000&wind=1", seconds);
  };
  const auto draw_moving = [&](Shard shard, const std::string& name) {
    RenderOptions options = small_picture();
    options.motion = true;
    options.shard = shard;
    RenderControl control;
    control.part = name;
    return Renderer()
        .render_shutter([&](int) { return at(1); }, 1, options, control,
                        [&](int) { return at(1.04); })
        .film;
  };
  const Film whole = draw_moving({}, "");
  draw_moving({1, 2}, path("a.dapple"));
  draw_moving({2, 2}, path("b.dapple"));
  const Film merged = merge_parts({path("b.dapple"), path("a.dapple")}).result.film;
  const auto& motion = merged.find("motion.X")->pixels;
  EXPECT_TRUE(std::any_of(motion.begin(), motion.end(), [](float x) { return x != 0; }));
  expect_same(merged, whole);
}

// Two values of a material are settings of one name.
TEST_F(MergeParts, OpacitiesOfOneNameAreComparedInOrder) {
  RenderOptions options = small_picture();
  options.opacity = {{"leaf", 0.5f}, {"leaf", 0.85f}};
  const auto draw_half = [&](int half) {
    options.shard = {half, 2};
    const std::string name = path(std::to_string(half) + ".half.dapple");
    draw(options, name);
    return name;
  };
  const std::vector<std::string> halves{draw_half(1), draw_half(2)};
  EXPECT_EQ(merge_parts(halves).missing, "");
  options.opacity[0].second = 0.6f;
  draw_half(2);
  expect_refused(halves, "opacity_leaf 0.6");
}

TEST_F(MergeParts, ATileThatIsMissingAtTheBorderIsSaid) {
  const PixelRect left{0, 0, 18, 35}, middle{19, 0, 30, 35}, right{31, 0, 39, 35};
  const std::vector<std::string> tiles{part(1, 1, left), part(1, 1, middle), part(1, 1, right)};
  EXPECT_TRUE(merge_parts(tiles).result.statistics.notes.empty());
  const auto notes_of = [](const Merge& merge) { return merge.result.statistics.notes; };
  const std::vector<std::string> notes = notes_of(merge_parts({tiles[0], tiles[1]}));
  ASSERT_EQ(notes.size(), 1u);
  EXPECT_EQ(notes[0], "no part has pixels outside of 0,0 to 30,35; the picture is 40 x 36");
  EXPECT_TRUE(notes_of(merge_parts({tiles[0]})).empty()) << "a crop that was asked for";
  expect_refused({tiles[0], part(1, 1, PixelRect{10, 5, 25, 7})}, "of the pixels 10,5 to 18,7");
}

TEST_F(MergeParts, OverlapsAreRefusedWithTheirSamples) {
  const std::string half = part(1, 2), quarter = part(2, 4);
  expect_refused({half, quarter}, "0.dapple and ");
  expect_refused({quarter, half}, "overlap: samples 3 to 5 of the pixels 0,0 to 39,35 would count");
  expect_refused({half, half}, "0.dapple is named twice: its samples 1 to 5");
}

TEST_F(MergeParts, PartsOfOtherPicturesAreRefusedAndTheDifferenceNamed) {
  const std::string first = part(1, 2);
  using Change = std::function<void(RenderOptions&)>;
  const std::pair<const char*, Change> changes[] = {
      {"--seed 7, ", [](auto& o) { o.seed = 7; }},
      {"--width 41, ", [](auto& o) { o.width = 41; }},
      {"--passes ao,light,albedo, ", [](auto& o) { o.back = false; }},
      {"--back-every 4, ", [](auto& o) { o.back_every = 4; }},
      {"--cryptomatte none, ", [](auto& o) { o.cryptomattes = {}; }},
      {"--footprint 2, ", [](auto& o) { o.footprint = 2; }},
      {"--camera-splitting 4, ", [](auto& o) { o.camera_splitting = 4; }},
      {"--spp (footprints) 12, ", [](auto& o) { o.spp = 12; }},
      {"--ambient 3, ", [](auto& o) { o.ambient = 3.0f; }},
      {"in scene",
       [](auto& o) {
         o.opacity = {{"leaf", 0.5f}};
       }},
      {"in scene",
       [](auto& o) {  // from which another splitting factor follows
         o.opacity = {{"leaf", 0.1f}};
         o.camera_splitting = 0;
       }},
      {"in camera",
       [](auto& o) {
         o.look = LookAt{{9, 9, 9}};
       }},
  };
  for (const auto& [text, change] : changes) {
    RenderOptions options = small_picture();
    options.shard = {2, 2};
    change(options);
    draw(options, path("other.dapple"));
    expect_refused({first, path("other.dapple")}, text);
    expect_refused({path("other.dapple"), first}, "0.dapple");
  }
}

TEST_F(MergeParts, PartsWithOtherLightsAreRefused) {
  RenderOptions options = small_picture();
  options.shard = {2, 2};
  Scene scene = tree();
  std::vector<std::string> notes;
  scene.lights = daylight(choose_view(scene, options, notes).camera);
  scene.lights[0].radiance *= 2;
  RenderControl control;
  control.part = path("other.dapple");
  control.settings = {{"frame_seconds", "1.5"}};
  render(scene, options, control);
  expect_refused({part(1, 2), path("other.dapple")}, "in set of lights");
}

TEST_F(MergeParts, PartsOfSeveralDevicesAreNotedWithEachDeviceOnce) {
  const std::vector<std::string> parts{part(1, 3), part(2, 3), part(3, 3)};
  const std::string own = read_part(parts[0], PartContents::description).device;
  for (const std::string& moved : {parts[1], parts[2]}) {
    Checkpoint checkpoint = read_part(moved, PartContents::all);
    checkpoint.device = "GPU of a farm";
    write_checkpoint(moved, checkpoint, checkpoint.state);
  }
  const std::vector<std::string> expected{
      "parts were traced on " + own +
      " and GPU of a farm: the picture's bits are not those of one device"};
  const Merge merge = merge_parts(parts);
  EXPECT_EQ(merge.result.statistics.notes, expected);
  EXPECT_EQ(merge.result.statistics.device, own + " and GPU of a farm");
  merge_parts({parts[0], parts[1]}, path("two.dapple"));
  EXPECT_EQ(merge_parts({path("two.dapple"), parts[2]}).result.statistics.notes, expected);
}

TEST_F(MergeParts, DamagedFilesAreRefusedByName) {
  const std::string good = part(1, 2), bad = part(2, 2);
  const std::string bytes = bytes_of(bad);
  for (std::size_t bit = 77; bit < 8 * bytes.size(); bit += 8 * bytes.size() / 40) {
    write_bytes(bad, bytes);
    flip_bit(bad, bit);
    expect_refused({good, bad}, bad + ": ", ErrorKind::failed);
  }
  write_bytes(bad, bytes.substr(0, bytes.size() / 2));
  expect_refused({good, bad}, bad + ": ", ErrorKind::failed);
  expect_refused({good, path("nosuch.dapple")}, "nosuch.dapple: ", ErrorKind::input);
}

/// Files with a right checksum whose contents contradict each other.
TEST_F(MergeParts, FilesThatContradictThemselvesAreDamaged) {
  const std::string good = part(1, 2), bad = path("bad.dapple");
  const Checkpoint whole = read_part(good, PartContents::all);
  const std::function<void(Checkpoint&)> changes[] = {
      [](Checkpoint& c) { c.state.samples[7] += 2; },
      [](Checkpoint& c) { c.state.samples.pop_back(); },
      [](Checkpoint& c) { c.state.sums.pop_back(); },
      [](Checkpoint& c) { c.state.first_sample += 2; },
      [](Checkpoint& c) { c.state.mattes.clear(); },
      [](Checkpoint& c) { c.picture.crop.x1 = 50; },
      [](Checkpoint& c) { c.picture.options.camera_splitting = 1; },
      [](Checkpoint& c) { c.picture.lights.pop_back(); },
      [](Checkpoint& c) { c.picture.scales.depth = 0; },
      [](Checkpoint& c) { c.pieces[0].rect.y1 = 36; },
      [](Checkpoint& c) { c.pieces[0].rays.end = 1 << 21; },
  };
  for (const auto& change : changes) {
    Checkpoint changed = whole;
    change(changed);
    write_checkpoint(bad, changed, changed.state);
    expect_refused({bad}, bad + ": ", ErrorKind::failed);
  }
}

TEST_F(MergeParts, TargetsAndShardsThatAreNoneAreRefused) {
  RenderOptions options = small_picture();
  options.shard = {1, 2};
  options.target_rmse = 0.1f;
  EXPECT_TRUE(contains(error_of([&] { validate(options); }).what(),
                       "--shard does not go with --target-rmse: how many samples"));
  options.shard = {};
  RenderControl control;
  control.checkpoint = path("a.ckpt");
  render(tree(), options, control);
  expect_refused({path("a.ckpt")}, "a.ckpt: was made with a target error");
  options.target_rmse = 0;
  for (const Shard shard : {Shard{0, 2}, {3, 2}, {1, 0}, {-1, -1}, {1, 12}}) {
    options.shard = shard;
    EXPECT_TRUE(contains(error_of([&] { validate(options); }).what(), "--shard "));
  }
}

}  // namespace
}  // namespace dapple

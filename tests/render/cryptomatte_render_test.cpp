// Cryptomattes of pictures: what each object covers is the alpha of that object alone, for leaves
// that camera rays pass, instances and strands; crops, resumed renders and threads change
// nothing.
#include <bit>
#include <cmath>
#include <cstring>

#include "film/cryptomatte.hpp"
#include "support/programs/program_run.hpp"
#include "support/scenes/scene_on_device.hpp"

namespace dapple {
namespace {

using namespace scene_test;

/// Coverage of a name in each pixel, from the six ranks of a type's layers.
std::vector<float> coverage(const Film& film, const std::string& type, const std::string& name) {
  std::vector<float> sum(film.find("A")->pixels.size());
  for (const char* layer : {"00", "01", "02"}) {
    if (!film.find(type + layer + ".R")) break;  // fewer names than ranks
    for (const auto& [id, share] : {std::pair(".R", ".G"), {".B", ".A"}}) {
      const auto& ids = film.find(type + layer + id)->pixels;
      const auto& shares = film.find(type + layer + share)->pixels;
      for (std::size_t p = 0; p < sum.size(); ++p)
        if (std::bit_cast<std::uint32_t>(ids[p]) == matte_id(name)) sum[p] += shares[p];
    }
  }
  return sum;
}

double total(const std::vector<float>& values) {
  double sum = 0;
  for (const float value : values) sum += value;
  return sum;
}

/// Four objects side by side: two instances of one tree, a translucent square on a dark one, and
/// strands. The trees are too large to be merged.
Scene garden() {
  Scene scene = make_procedural("scene:tree?leaves=600");
  override_opacity(scene, "leaf", 0.4f);
  scene.meshes[0].name = "tree";
  scene.node_names = {"left tree", "right tree", "glass", "", "hair"};
  scene.instances[0].node = 0;
  const auto move = [&](float x) { scene.instances.back().to_world.setTranslation(V3f(x, 0, 0)); };
  move(-9);
  scene.instances.push_back(scene.instances[0]);
  scene.instances.back().node = 1;
  move(9);
  const auto add_square = [&](float z, float opacity, int node, const std::string& material) {
    scene.materials.push_back(material_of(opacity));
    scene.materials.back().name = material;
    Mesh square;
    append_grid(square, {-1.5f, 1, z}, {3, 0, 0}, {0, 3, 0}, 2,
                static_cast<std::uint32_t>(scene.materials.size() - 1));
    place(scene, std::move(square));
    scene.instances.back().node = node;
  };
  add_square(1, 0.3f, 2, "pane");
  add_square(0, 1, 3, "wall");
  Mesh strand;
  strand.name = "strands";
  strand.positions = {{0, 5, 0}, {0.5f, 8, 0}, {-0.5f, 10, 0}};
  strand.indices = {0, 1, 1, 2};
  strand.radii = {0.2f, 0.1f, 0.05f};
  strand.materials = {0, 0};
  place(scene, std::move(strand));
  scene.instances.back().node = 4;
  scene.cameras = {look_at({0, 5, 40}, {0, 5, 0}, {0, 1, 0}, 0.5f)};
  return scene;
}

RenderOptions small_picture(int splitting = 0) {
  RenderOptions options;
  options.width = 64;
  options.height = 32;
  options.spp = 32;
  options.ao = options.light = false;
  options.camera_splitting = splitting;
  options.cryptomattes = {true, true};
  return options;
}

/// The picture with the instances of one node only.
Film alone(Scene scene, int node, RenderOptions options) {
  std::erase_if(scene.instances, [&](const Instance& instance) { return instance.node != node; });
  return render(std::move(scene), options).film;
}

// Each sample may stop at another of them, as in the distance of a meadow whose plants are nodes.
Scene sheets_before_a_wall(int sheets, float opacity) {
  Scene scene;
  scene.materials = {material_of(opacity), material_of(1)};
  scene.materials[0].name = "leaf";
  scene.materials[1].name = "wall";
  for (int i = 0; i <= sheets; ++i) {
    Mesh square;
    append_grid(square, {-2, -2, 0.005f * static_cast<float>(i)}, {4, 0, 0}, {0, 4, 0}, 1,
                i == 0 ? 1 : 0);
    square.name = "sheet " + std::to_string(i);
    place(scene, std::move(square));
  }
  scene.cameras = {look_at({0, 0, 8}, {0, 0, 0}, {0, 1, 0}, 0.1f)};
  return scene;
}

/// Leaves and wall add up to alpha; `wall`: its share.
void expect_all_counted(const Scene& scene, Cryptomattes mattes, int spp, double wall) {
  RenderOptions options = small_picture(1);
  options.width = options.height = 4;
  options.spp = spp;
  options.cryptomattes = mattes;
  const Film film = render(scene, options).film;
  const std::vector<float> leaves = coverage(film, "crypto_material", "leaf"),
                           walls = coverage(film, "crypto_material", "wall");
  const double deviation = std::sqrt(wall * (1 - wall) / spp);
  for (std::size_t p = 0; p < leaves.size(); ++p) {
    EXPECT_NEAR(leaves[p] + walls[p], film.find("A")->pixels[p], 1e-6) << p;
    EXPECT_NEAR(walls[p], wall, 5 * deviation) << p;
  }
}

TEST(CryptomatteRender, SomeHundredObjectsInAPixelAreAllCounted) {
  expect_all_counted(sheets_before_a_wall(200, 0.02f), {true, true}, 512, std::pow(0.98, 200));
}

// More objects than slots: some 500 of them are hit.
TEST(CryptomatteRender, MaterialsAloneAreCountedHoweverManyObjectsThereAre) {
  expect_all_counted(sheets_before_a_wall(600, 0.004f), {false, true}, 2048, std::pow(0.996, 600));
}

TEST(CryptomatteRender, EachObjectCoversWhatItsAlphaAloneIs) {
  const Scene scene = garden();
  for (const int splitting : {1, 4}) {
    const RenderOptions options = small_picture(splitting);
    const Film film = render(scene, options).film;
    const std::pair<int, const char*> names[] = {
        {0, "left tree"}, {1, "right tree"}, {2, "glass"}, {4, "hair"}};
    for (const auto& [node, name] : names) {
      const std::vector<float> found = coverage(film, "crypto_object", name);
      const Film only = alone(scene, node, options);
      const std::vector<float>& expected = only.find("A")->pixels;
      EXPECT_GT(total(expected), 1) << name;
      for (std::size_t p = 0; p < found.size(); ++p)
        ASSERT_NEAR(found[p], expected[p], 1e-3) << name << " in pixel " << p;
    }
    // The wall behind the pane, which nobody named, has what the pane lets pass.
    const std::vector<float> wall = coverage(film, "crypto_object", "node_3"),
                             pane = coverage(film, "crypto_object", "glass");
    const Film only = alone(scene, 3, options);
    for (std::size_t p = 0; p < wall.size(); ++p)
      if (pane[p] > 0 && only.find("A")->pixels[p] == 1) {
        EXPECT_NEAR(wall[p], 1 - pane[p], 1e-6) << p;
      }
    EXPECT_GT(total(wall), 10);
  }
}

TEST(CryptomatteRender, ObjectsAndMaterialsAddUpToAlpha) {
  const Film film = render(garden(), small_picture()).film;
  std::vector<float> objects(film.find("A")->pixels.size()), materials = objects;
  for (const char* name : {"left tree", "right tree", "glass", "node_3", "hair"}) {
    const auto part = coverage(film, "crypto_object", name);
    for (std::size_t p = 0; p < part.size(); ++p) objects[p] += part[p];
  }
  for (const char* name : {"leaf", "bark", "pane", "wall"}) {
    const auto part = coverage(film, "crypto_material", name);
    EXPECT_GT(total(part), 1) << name;
    for (std::size_t p = 0; p < part.size(); ++p) materials[p] += part[p];
  }
  for (std::size_t p = 0; p < objects.size(); ++p) {
    EXPECT_NEAR(objects[p], film.find("A")->pixels[p], 1e-6) << p;
    EXPECT_NEAR(materials[p], film.find("A")->pixels[p], 1e-6) << p;
  }
}

TEST(CryptomatteRender, OtherLayersAreTheSameBitsWithAndWithout) {
  RenderOptions options = small_picture();
  options.spp = 4;
  options.ao = options.light = true;
  const Film with = render(garden(), options).film;
  options.cryptomattes = {};
  const Film without = render(garden(), options).film;
  EXPECT_EQ(with.planes.size(), without.planes.size() + 12 + 8);
  for (const Plane& plane : without.planes)
    EXPECT_EQ(film_test::bits_of(with.find(plane.channel)->pixels),
              film_test::bits_of(plane.pixels))
        << plane.channel;
}

TEST(CryptomatteRender, ACropIsThatPartOfThePicture) {
  RenderOptions options = small_picture();
  const Film whole = render(garden(), options).film;
  options.crop = PixelRect{5, 3, 50, 28};
  const Film part = render(garden(), options).film;
  for (const Plane& plane : part.planes) {
    if (!plane.channel.starts_with("crypto_")) continue;
    for (int y = 3; y <= 28; ++y)
      for (int x = 5; x <= 50; ++x)
        ASSERT_EQ(std::bit_cast<std::uint32_t>(
                      plane.pixels[static_cast<std::size_t>(y - 3) * 46 + (x - 5)]),
                  std::bit_cast<std::uint32_t>(
                      whole.find(plane.channel)->pixels[static_cast<std::size_t>(y) * 64 + x]))
            << plane.channel << " at " << x << ", " << y;
  }
}

class CryptomatteResume : public film_test::FilmFile {};

TEST_F(CryptomatteResume, ARenderThatGoesOnHasTheSameMattes) {
  RenderOptions options = small_picture();
  options.width = 256;
  options.height = 128;
  options.spp = 40;  // several slices
  const Film whole = render(garden(), options).film;
  RenderControl control;
  control.checkpoint = path("a.ckpt");
  control.stop = [left = 2]() mutable { return left-- == 0; };
  ASSERT_TRUE(render(garden(), options, control).interrupted);
  control.stop = {};
  control.resume = control.checkpoint;
  const RenderResult rest = render(garden(), options, control);
  ASSERT_FALSE(rest.interrupted);
  for (const Plane& plane : whole.planes)
    if (plane.channel.starts_with("crypto_")) {
      EXPECT_EQ(film_test::bits_of(rest.film.find(plane.channel)->pixels),
                film_test::bits_of(plane.pixels))
          << plane.channel;
    }
  Scene renamed = garden();
  renamed.node_names[1] = "left tree";  // then there are fewer objects
  const Error error = film_test::error_of([&] { render(renamed, options, control); });
  EXPECT_EQ(error.kind(), ErrorKind::usage);
  EXPECT_TRUE(film_test::contains(error.what(), "names of objects")) << error.what();
  options.cryptomattes = {};
  EXPECT_TRUE(film_test::contains(
      film_test::error_of([&] { render(garden(), options, control); }).what(), "--cryptomatte"));
}

// Of each pixel the first moment has the camera rays 1 and 2, and the second 3 and 4: those of the
// two shards of a picture. So the mean of two pictures that stand still is the same but for
// rounding.
TEST(CryptomatteRender, MovingObjectsAreCountedAtEveryMoment) {
  RenderOptions options = small_picture(1);
  options.spp = 4;
  const auto scene_at = [](int k) {
    Scene scene = garden();
    for (Instance& instance : scene.instances)
      if (instance.node == 3) instance.to_world.setTranslation(V3f(0, k ? 12.0f : 0.0f, 0));
    return scene;
  };
  const auto still = [&](int k) {
    RenderOptions half = options;
    half.shard = {k + 1, 2};
    return render(scene_at(k), half).film;
  };
  const Film moving = Renderer().render_shutter(scene_at, 2, options).film;
  const Film first = still(0), second = still(1);
  for (const char* name : {"node_3", "glass"}) {
    const std::vector<float> found = coverage(moving, "crypto_object", name),
                             a = coverage(first, "crypto_object", name),
                             b = coverage(second, "crypto_object", name);
    EXPECT_GT(total(a), 2) << name;
    EXPECT_GT(total(b), 2) << name;
    for (std::size_t p = 0; p < found.size(); ++p)
      EXPECT_NEAR(found[p], (a[p] + b[p]) / 2, 1e-6) << name << " in pixel " << p;
  }
}

class CryptomatteProgram : public program_test::ProgramRun {};

const char* const kForest =
    "render 'scene:forest?trees=9&leaves=2000' --width 64 --height 36 --spp 8 -q --opacity "
    "leaf=0.3 --passes ao --cryptomatte object,material -o ";

TEST_F(CryptomatteProgram, TheNumberOfThreadsChangesNothing) {
  ASSERT_EQ(dapple(std::string(kForest) + "one.exr", "POCL_MAX_PTHREAD_COUNT=1 taskset -c 0").code,
            0);
  ASSERT_EQ(dapple(std::string(kForest) + "two.exr", "POCL_MAX_PTHREAD_COUNT=2").code, 0);
  EXPECT_EQ(film_test::bytes_of(path("one.exr")), film_test::bytes_of(path("two.exr")));
}

/// A command that decodes a file with a reader of EXR files and a hash that are not dapple's.
std::string decode(const std::string& arguments) {
  return "python3 '" DAPPLE_SOURCE_FOLDER "/tests/film/decode_cryptomatte.py' " + arguments +
         " >/dev/null 2>&1";
}

bool has_python() { return std::system("python3 -c 'import json, zlib' 2>/dev/null") == 0; }

TEST_F(CryptomatteProgram, AnotherProgramDecodesTheMattes) {
  if (!has_python()) GTEST_SKIP() << "needs python3";
  ASSERT_EQ(dapple(std::string(kForest) + "all.exr").code, 0);
  ASSERT_EQ(dapple(std::string(kForest) + "parts.exr --multipart --half all").code, 0);
  for (const char* file : {"all.exr", "parts.exr"}) {
    for (const char* type : {"crypto_object", "crypto_material"})
      EXPECT_EQ(std::system(decode("'" + path(file) + "' " + type).c_str()), 0) << file << type;
  }
}

TEST_F(CryptomatteProgram, ToAnotherProgramEachObjectCoversWhatItsAlphaAloneIs) {
  if (!has_python()) GTEST_SKIP() << "needs python3";
  const Scene scene = garden();
  const RenderOptions options = small_picture(1);
  write_exr(dapple::render(scene, options).film, path("all.exr"));
  const std::pair<int, std::string> names[] = {
      {0, "left tree"}, {1, "right tree"}, {2, "glass"}, {4, "hair"}};
  for (const auto& [node, name] : names) {
    write_exr(alone(scene, node, options), path("alone.exr"));
    const auto same = [&](const std::string& other) {
      return std::system(decode("'" + path("all.exr") + "' crypto_object '" + other + "' '" +
                                path("alone.exr") + "'")
                             .c_str()) == 0;
    };
    EXPECT_TRUE(same(name)) << name;
    EXPECT_FALSE(same("node_3")) << "not the wall";
  }
}

TEST_F(CryptomatteProgram, WrongTypesAreRefused) {
  expect_failure(render("--cryptomatte foo"), 2,
                 "--cryptomatte foo: there are object and material");
  expect_failure(render("--cryptomatte object,"), 2, "--cryptomatte object,");
}

}  // namespace
}  // namespace dapple

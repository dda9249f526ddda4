// Scalar kernels, which GPUs use, find what the vector kernels find: occlusion rays ray by ray, and
// pictures pixel by pixel.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <memory>

#include "support/scenes/traced_scenes.hpp"

namespace dapple {
namespace {

using namespace scene_test;

// A device whose rays are traced by the kernels of that kind.
const Device& device_with(Packets packets) {
  static const Device single("", "", Packets::none), scalar("", "", Packets::scalar);
  return packets == Packets::scalar ? scalar : single;
}

std::vector<Scene> scenes_of_every_kind() {
  std::vector<Scene> scenes;
  scenes.push_back(make_procedural("scene:tree?leaves=2000"));
  // So thin that rays pass more surfaces than they keep.
  scenes.push_back(make_procedural("scene:cloud?leaves=3000&opacity=0.05"));
  scenes.push_back(forest_scaled_non_uniformly());
  scenes.push_back(textured_cards());
  scenes.push_back(make_procedural("scene:hair?strands=400"));
  return scenes;
}

// The kernels round differently, so a ray near the border of a box, of a triangle or of a footprint
// may hit in one and miss in the other: at most 2 in a thousand.
constexpr double kOtherWay = 2e-3;

TEST(ScalarKernels, FindTheTransmittanceOfVectorKernelsRayByRay) {
  for (const Scene& scene : scenes_of_every_kind()) {
    const SceneBvh bvh = build_bvh(scene);
    std::vector<Ray> rays = rays_through(bvh.bounds, 8000, bvh.bounds.size().length(), 1e-3f, 5);
    for (std::size_t i = 0; i < rays.size(); ++i) {
      if (i % 3 == 0)
        rays[i].t_max = 0.01f * bvh.bounds.size().length() * static_cast<float>(i % 150);
      rays[i].key = static_cast<std::uint32_t>(i) * 0x9e3779b9u;
    }
    for (const Estimator estimator : {Estimator::exact, Estimator::prefiltered}) {
      SCOPED_TRACE(scene.source + ", " + name_of(estimator));
      std::vector<Occlusion> found[2];
      for (const Packets packets : {Packets::none, Packets::scalar}) {
        const Device& device = device_with(packets);
        found[packets == Packets::scalar] =
            trace(device, upload(device, scene, bvh), rays, estimator);
      }
      int different = 0;
      // A scalar ray that is stopped goes on to the end of its round, of up to 16 nodes.
      double difference = 0, hidden = 0, stopped = 0;
      double visits[2] = {}, tests[2] = {}, all_visits[2] = {};
      for (std::size_t i = 0; i < rays.size(); ++i) {
        const float apart = found[1][i].transmittance - found[0][i].transmittance;
        different += !(std::fabs(apart) <= 1e-4f);
        difference += apart;
        hidden += found[0][i].transmittance < 1;
        const bool is_stopped = found[0][i].transmittance == 0 || found[1][i].transmittance == 0;
        stopped += is_stopped;
        for (const int k : {0, 1}) {
          all_visits[k] += found[k][i].visits & 65535u;
          if (is_stopped) continue;
          visits[k] += found[k][i].visits & 65535u;
          tests[k] += found[k][i].visits >> 16;
        }
      }
      const auto count = static_cast<double>(rays.size());
      std::printf("%s, %s: %d differ, mean %.2g, visits %.2f and %.2f\n", scene.source.c_str(),
                  name_of(estimator).c_str(), different, difference / count, visits[0] / count,
                  visits[1] / count);
      EXPECT_GT(hidden, 0.2 * count) << "nothing in the way";
      EXPECT_LE(different, kOtherWay * count);
      EXPECT_LT(std::fabs(difference / count), 2e-4);
      EXPECT_NEAR(visits[1], visits[0], 0.01 * visits[0]);
      EXPECT_NEAR(tests[1], tests[0], 0.01 * tests[0]);
      EXPECT_LE(all_visits[1], 1.01 * all_visits[0] + 16 * stopped);
    }
  }
}

// Rays that start a hundred million times as far away as the scene is large hit the boxes of empty
// slots, too.
TEST(ScalarKernels, RaysFromFarAwayTestTheTrianglesOfTheSceneAlone) {
  const Scene scene = make_procedural("scene:cloud?leaves=1");
  const SceneBvh bvh = build_bvh(scene);
  std::vector<Ray> rays = rays_through(bvh.bounds, 2000, bvh.bounds.size().length(), 0.0f, 7);
  for (Ray& ray : rays) {
    for (int axis = 0; axis < 3; ++axis) ray.origin[axis] -= 1e8f * ray.direction[axis];
    ray.t_max = 1e9f;
  }
  std::vector<Occlusion> found[2];
  for (const Packets packets : {Packets::none, Packets::scalar}) {
    const Device& device = device_with(packets);
    found[packets == Packets::scalar] =
        trace(device, upload(device, scene, bvh), rays, Estimator::exact);
  }
  double tests[2] = {};
  for (std::size_t i = 0; i < rays.size(); ++i) {
    for (const int k : {0, 1}) {  // at such distances both round coarsely, and hit different ones
      EXPECT_LE(found[k][i].visits >> 16, 2u) << "a leaf has two triangles";
      tests[k] += found[k][i].visits >> 16;
    }
  }
  EXPECT_GT(tests[0], 0);
  EXPECT_GT(tests[1], 0);
}

// Opacities fade with the distance in covered nodes and on surfaces.
TEST(ScalarKernels, FadeOcclusionWithTheDistanceAsVectorKernelsDo) {
  for (const Scene& scene : scenes_of_every_kind()) {
    SCOPED_TRACE(scene.source);
    const SceneBvh bvh = build_bvh(scene);
    Points random(3);
    std::vector<V3f> points, normals;
    for (int i = 0; i < 300; ++i) {
      points.push_back(bvh.bounds.center() + V3f(bvh.bounds.size() * random.in_cube(0.5f)));
      normals.push_back(random.on_sphere());
    }
    OcclusionOptions options;
    options.rays = 16;
    options.distance = 0.4f * bvh.bounds.size().length();
    options.falloff = 2;
    std::vector<float> ao[2];
    for (const Packets packets : {Packets::none, Packets::scalar}) {
      const Device& device = device_with(packets);
      ao[packets == Packets::scalar] =
          occlusion(device, upload(device, scene, bvh), points, normals, options);
    }
    double sum = 0, squares = 0;
    for (std::size_t i = 0; i < points.size(); ++i) {
      sum += ao[0][i];
      squares += (ao[1][i] - ao[0][i]) * (ao[1][i] - ao[0][i]);
    }
    EXPECT_LT(sum, 0.997 * 300) << "nothing in the way";
    EXPECT_LT(std::sqrt(squares / 300), 2e-3);
  }
}

// The difference of the means of a channel in two pictures, and its RMSE over the pixels.
struct Deviation {
  double mean = 0, rmse = 0;
};

Deviation deviation_of(const Film& a, const Film& b, const std::string& channel) {
  const Plane *in_a = a.find(channel), *in_b = b.find(channel);
  EXPECT_TRUE(in_a && in_b) << channel;
  Deviation deviation;
  if (!in_a || !in_b) return deviation;
  const std::size_t count = in_a->pixels.size();
  for (std::size_t i = 0; i < count; ++i) {
    if (in_a->pixels[i] == in_b->pixels[i]) continue;  // infinite depths too
    const double apart = in_b->pixels[i] - in_a->pixels[i];
    deviation.mean += apart / static_cast<double>(count);
    deviation.rmse += apart * apart / static_cast<double>(count);
  }
  deviation.rmse = std::sqrt(deviation.rmse);
  return deviation;
}

void expect_the_same_picture(Scene scene, RenderOptions options) {
  options.width = options.height = 48;
  options.spp = 16;
  options.packets = Packets::none;
  const Film vector = render(scene, options).film;
  options.packets = Packets::scalar;
  const Film scalar = render(scene, options).film;
  for (const char* channel : {"A", "ao.R", "N.X", "N.Y", "Z"}) {
    const Deviation found = deviation_of(vector, scalar, channel);
    std::printf("%s %s: mean %.2g, RMSE %.2g\n", scene.source.c_str(), channel, found.mean,
                found.rmse);
    // One sample in some thousand sees another surface; in a pixel it counts a sixteenth.
    const double scale = std::string(channel) == "Z" ? 30 : 1;
    EXPECT_LT(std::fabs(found.mean), 2e-4 * scale) << channel;
    EXPECT_LT(found.rmse, 4e-3 * scale) << channel;
  }
}

TEST(ScalarKernels, RenderThePicturesOfVectorKernels) {
  for (Scene& scene : scenes_of_every_kind()) {
    SCOPED_TRACE(scene.source);
    RenderOptions options;
    options.light = false;
    options.ground = true;
    expect_the_same_picture(std::move(scene), options);
  }
}

// Every kind of light: the weights, directions and distances of its rays are in its layer.
TEST(ScalarKernels, SampleEveryKindOfLightAsVectorKernelsDo) {
  Scene scene = make_procedural("scene:tree?leaves=2000");
  const auto add = [&](const char* name, LightKind kind) -> Light& {
    Light light;
    light.name = name;
    light.kind = kind;
    light.position = V3f(3, 9, 2);
    light.direction = V3f(-0.3f, -0.9f, 0.1f).normalized();
    light.edge_u = V3f(1, 0, 0.3f);
    light.edge_v = V3f(0, 0.3f, 1);
    light.radius = 0.5f;
    light.angular_radius = 0.05f;
    scene.lights.push_back(light);
    return scene.lights.back();
  };
  add("parallelogram", LightKind::rect);
  Light& rect = add("rect", LightKind::rect);
  rect.edge_u = V3f(0, 0, 1).cross(rect.direction);
  rect.edge_v = rect.direction.cross(rect.edge_u) * 2;
  add("disk", LightKind::disk);
  add("ceiling", LightKind::disk).radius = 30;
  add("sphere", LightKind::sphere);
  Light& spot = add("spot", LightKind::sphere);
  spot.cos_inner = 0.99f;
  spot.cos_outer = 0.8f;
  add("sun", LightKind::sun);
  add("even", LightKind::dome);
  Light& sky = add("sky", LightKind::dome);
  auto image = std::make_shared<Environment>();
  image->width = 8;
  image->height = 4;
  for (int texel = 0; texel < 32; ++texel)
    image->radiance.emplace_back(0.1f + static_cast<float>(texel % 7), 0.5f, 1);
  sky.environment = image;
  add("glow", LightKind::mesh).double_sided = true;
  Mesh emitter;
  append_grid(emitter, {-3, 9, -1}, {6, 0, 0}, {0, 1.5f, 1}, 6, 0);
  place(scene, std::move(emitter), {}, static_cast<int>(scene.lights.size()) - 1);
  RenderOptions options;
  options.width = options.height = 32;
  options.spp = 4;
  options.light_rays = 4;
  options.ground = true;
  options.packets = Packets::none;
  const Film vector = render(scene, options).film;
  options.packets = Packets::scalar;
  const Film scalar = render(scene, options).film;
  for (const Light& light : scene.lights) {
    const std::string channel = "light." + light.name + ".R";
    const Deviation found = deviation_of(vector, scalar, channel);
    double sum = 0;
    for (const float value : vector.find(channel)->pixels) sum += value;
    const double mean = sum / (32.0 * 32.0);
    std::printf("%s: %.4g, mean %.2g, RMSE %.2g\n", channel.c_str(), mean, found.mean, found.rmse);
    EXPECT_GT(mean, 1e-4) << channel;
    EXPECT_LT(std::fabs(found.mean), 2e-3 * mean) << channel;
    EXPECT_LT(found.rmse, 0.03 * mean) << channel;
  }
}

// Shading normals and colours: of corners, and of textures whose texels are small in a pixel.
TEST(ScalarKernels, ShadeAsVectorKernelsDo) {
  Scene cards = textured_cards();
  ColorTexture colors;
  colors.width = colors.height = 64;
  for (int i = 0; i < 3 * 64 * 64; ++i)
    colors.rgb.push_back(static_cast<std::uint8_t>(i * 37 % 251));
  cards.color_textures = {colors};
  for (Material& material : cards.materials) material.color_texture = 0;
  for (const Scene& scene : {make_procedural("scene:flower"), std::move(cards)}) {
    RenderOptions options;
    options.width = options.height = 64;
    options.spp = 16;
    options.light = false;
    options.packets = Packets::none;
    const Film vector = render(scene, options).film;
    options.packets = Packets::scalar;
    const Film scalar = render(scene, options).film;
    for (const char* channel : {"N.X", "N.Y", "N.Z", "albedo.R", "albedo.G", "albedo.B"}) {
      const Deviation found = deviation_of(vector, scalar, channel);
      const std::vector<float>& pixels = vector.find(channel)->pixels;
      const auto [least, most] = std::minmax_element(pixels.begin(), pixels.end());
      const bool upright_cards = scene.source == "cards" && std::string(channel) == "N.Y";
      EXPECT_TRUE(upright_cards || *most - *least > 0.05f) << channel << " is the same all over";
      EXPECT_LT(std::fabs(found.mean), 1e-4) << scene.source << " " << channel;
      EXPECT_LT(found.rmse, 4e-3) << scene.source << " " << channel;
    }
  }
}

// With a target, sparse nodes are media, in which rays stop by their random bits.
TEST(ScalarKernels, StopInTheSameMedia) {
  const Scene scene = make_procedural("scene:cloud?leaves=30000&opacity=0.05");
  RenderOptions options;
  options.light = false;
  options.max_spp = 16;
  options.footprint_spp = 1;
  options.target_rmse = 0.05f;
  expect_the_same_picture(scene, options);
  options.width = options.height = 48;
  options.spp = 16;
  options.packets = Packets::scalar;
  const RenderResult media = render(scene, options);
  options.target_rmse = 0;
  const RenderResult surfaces = render(scene, options);
  EXPECT_LT(media.statistics.camera.visits, 0.5 * surfaces.statistics.camera.visits) << "no medium";
}

}  // namespace
}  // namespace dapple

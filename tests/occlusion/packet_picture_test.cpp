// Pictures whose rays are traced in packets: they agree with those of single rays, and their bytes
// do not depend on the number of threads.
#include <gtest/gtest.h>
#include <unistd.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>

#include "support/scenes/scene_on_device.hpp"

namespace dapple {
namespace {

using namespace scene_test;

float sum_of(const Film& film, const std::string& channel) {
  const Plane* plane = film.find(channel);
  EXPECT_NE(plane, nullptr) << channel;
  float sum = 0;
  for (const float value : plane ? plane->pixels : std::vector<float>{}) sum += value;
  return sum;
}

TEST(PacketPicture, LightAndAoPassesAgreeWithExactOnesAndEmittersNeverOccludeThemselves) {
  Scene scene = make_procedural("scene:tree?leaves=2000");
  Light glow;
  glow.name = "glow";
  glow.kind = LightKind::mesh;
  glow.double_sided = true;
  scene.lights.push_back(glow);
  // A folded emitter: one half would occlude the other from most of the ground.
  Mesh folded;
  append_grid(folded, {-3, 9, -1}, {6, 0, 0}, {0, 1.5f, 1}, 6, 0);
  append_grid(folded, {-3, 9, 1}, {6, 0, 0}, {0, 1.5f, -1}, 6, 0);
  place(scene, std::move(folded), {}, 0);
  Light sun;
  sun.name = "sun";
  sun.kind = LightKind::sun;
  sun.direction = V3f(-0.4f, -1, 0.2f).normalized();
  sun.angular_radius = 0.1f;
  scene.lights.push_back(sun);
  RenderOptions options;
  options.width = 24;
  options.height = 20;
  options.spp = 4;
  options.ao_rays = 9;
  options.light_rays = 25;
  options.ground = true;
  options.estimator = Estimator::exact;
  const Film exact = render(scene, options).film;
  options.estimator = Estimator::prefiltered;
  options.packets = Packets::point;
  options.footprint = 0;
  const RenderResult zero = render(scene, options);
  EXPECT_EQ(zero.statistics.estimator, "prefiltered");
  options.footprint = 1;
  const Film packet = render(scene, options).film;
  options.packets = Packets::none;
  const Film prefiltered = render(scene, options).film;
  for (const char* channel : {"ao.R", "light.glow.R", "light.sun.R"}) {
    const float truth = sum_of(exact, channel);
    std::printf(
        "%s: exact %.4f, point packets at footprint 0 %.4f, point packets %.4f, single rays %.4f\n",
        channel, truth, sum_of(zero.film, channel), sum_of(packet, channel),
        sum_of(prefiltered, channel));
    // At most one ray in a thousand passes an edge on the other side.
    EXPECT_NEAR(sum_of(zero.film, channel), truth, 1e-3 * truth) << channel;
    EXPECT_NEAR(sum_of(packet, channel), sum_of(prefiltered, channel), 0.01 * truth) << channel;
  }
}

std::string rendered_bytes(const std::string& environment, const std::string& estimator) {
  namespace fs = std::filesystem;
  const fs::path path =
      fs::temp_directory_path() / ("dapple_packet_" + std::to_string(getpid()) + ".exr");
  const std::string command = environment + " '" + DAPPLE_PROGRAM +
                              "' render scene:demo --width 40 --height 30 --spp 2 -q -o '" +
                              path.string() + "' --ao-rays 70 --light-rays 9 --estimator " +
                              estimator;
  EXPECT_EQ(std::system(command.c_str()), 0) << command;
  std::ifstream file(path, std::ios::binary);
  const std::string bytes{std::istreambuf_iterator<char>(file), {}};
  fs::remove(path);
  return bytes;
}

TEST(PacketPicture, TheProgramWritesTheSameBytesWithAnyNumberOfDeviceThreads) {
  for (const char* estimator : {"prefiltered", "exact"}) {
    const std::string one = rendered_bytes("POCL_MAX_PTHREAD_COUNT=1", estimator);
    EXPECT_GT(one.size(), 5000u);
    EXPECT_EQ(rendered_bytes("POCL_MAX_PTHREAD_COUNT=2", estimator), one) << estimator;
  }
}

}  // namespace
}  // namespace dapple

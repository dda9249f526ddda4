// The option --packets: each grouping of rays can be chosen, and results do not depend on it but
// for roundings.
#include <gtest/gtest.h>

#include <cmath>

#include "support/programs/program_run.hpp"
#include "support/scenes/scene_on_device.hpp"

namespace dapple {
namespace {

using namespace scene_test;

// Kernels round differently, so near borders of boxes and triangles a ray may hit in one and not in
// another: a few rays in ten thousand. The others agree within the rounding of optical depths.
TEST(PacketGroupings, ExactTransmittancesAgreeInEveryGrouping) {
  const Scene scene = make_procedural("scene:tree?leaves=2000");
  const SceneBvh bvh = build_bvh(scene);
  const auto rays = rays_through(bvh.bounds, 10'000, bvh.bounds.size().length(), 0, 5);
  std::vector<Occlusion> alone;
  for (const Packets packets : {Packets::none, Packets::pixel, Packets::point}) {
    const Device chosen("", "", packets);
    const DeviceScene uploaded = upload(chosen, scene, bvh);
    const auto found = trace(chosen, uploaded, rays, Estimator::exact);
    if (alone.empty()) alone = found;
    int different = 0;
    for (std::size_t i = 0; i < rays.size(); ++i)
      different += std::fabs(found[i].transmittance - alone[i].transmittance) > 1e-4f;
    EXPECT_LE(different, 10);
  }
}

class PacketsOption : public program_test::ProgramRun {};

TEST_F(PacketsOption, RenderAcceptsEveryValueAndRefusesOthers) {
  expect_failure(render("--packets nobody"), 2, "--packets nobody: it is auto, none");
  for (const char* packets : {"auto", "none", "pixel", "point", "scalar"})
    EXPECT_EQ(render(std::string("-q --packets ") + packets).code, 0) << packets;
}

TEST_F(PacketsOption, DevicesCommandReportsWhetherEveryKernelRuns) {
  const auto run = dapple("devices --check");
  EXPECT_EQ(run.code, 0) << run.err;
  EXPECT_TRUE(film_test::contains(run.out, "runs every kernel; ")) << run.out;
  EXPECT_TRUE(film_test::contains(run.err, "compiling every kernel for ")) << run.err;
  film_test::write_bytes(path("kernels/occlusion/packet.cl"), "this is no OpenCL C\n");
  const auto broken = dapple("devices --check --kernel-dir kernels");
  EXPECT_EQ(broken.code, 4) << broken.err;
  EXPECT_TRUE(film_test::contains(broken.out, "cannot be used: occlusion/packet.cl: "))
      << broken.out;
}

}  // namespace
}  // namespace dapple

// --passes beauty: it brings the lights with it, whichever other passes are named.
#include <gtest/gtest.h>

#include <algorithm>
#include <string>
#include <tuple>

#include "dapple/film.hpp"
#include "support/programs/program_run.hpp"

namespace dapple {
namespace {

using namespace film_test;
using program_test::Outcome;

class BeautyCommand : public program_test::ProgramRun {
 protected:
  [[nodiscard]] Film picture(const std::string& scene, const std::string& options) const {
    const Outcome run =
        dapple("render '" + scene + "' --width 16 --height 12 --spp 4 -o out.exr " + options);
    EXPECT_EQ(run.code, 0) << run.err;
    return read_exr(path("out.exr"));
  }
};

bool has_light(const Film& film, const std::string& channel) {
  const Plane* plane = film.find(channel);
  return plane != nullptr && std::any_of(plane->pixels.begin(), plane->pixels.end(),
                                         [](float value) { return value > 0; });
}

TEST_F(BeautyCommand, ShowsWhatThePassLightWouldBring) {
  write_bytes(path("sun.json"),
              R"({"lights": [{"type": "sun", "name": "lamp", "direction": [0, -1, -0.5],)"
              R"( "irradiance": 3}]})");
  const std::string from_file = "--lights sun.json ";
  for (const std::string passes : {"beauty", "ao,beauty", "albedo,beauty"}) {
    SCOPED_TRACE(passes);
    // The lights of a file, those of the scene, and those that dapple adds.
    for (const auto& [scene, options, light] :
         {std::tuple{"scene:tree?leaves=500", from_file, "lamp"},
          std::tuple{"scene:demo", std::string(), "sun"},
          std::tuple{"scene:tree?leaves=500", std::string(), "sun"}}) {
      const Film alone = picture(scene, options + "--passes " + passes);
      const Film with_light = picture(scene, options + "--passes light," + passes);
      EXPECT_TRUE(has_light(alone, std::string("beauty.") + light + ".R"));
      EXPECT_TRUE(has_light(alone, std::string("light.") + light + ".R"));
      ASSERT_EQ(alone.planes.size(), with_light.planes.size());
      for (const Plane& plane : with_light.planes)
        EXPECT_EQ(alone.find(plane.channel)->pixels, plane.pixels) << plane.channel;
    }
  }
}

TEST_F(BeautyCommand, TheOtherPassesBringNoLights) {
  const Film film = picture("scene:tree?leaves=500", "--passes ao,albedo");
  for (const Plane& plane : film.planes)
    EXPECT_FALSE(plane.channel.starts_with("light.")) << plane.channel;
}

}  // namespace
}  // namespace dapple

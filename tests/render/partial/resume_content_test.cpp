// What a checkpoint is of beside its options: the lights, which must be the same, and the device,
// which may be another one and is named then.
#include <gtest/gtest.h>

#include <algorithm>

#include "camera/view.hpp"
#include "render/partial/checkpoint.hpp"
#include "support/files/film_files.hpp"

namespace dapple {
namespace {

using namespace film_test;

RenderOptions small_picture() {
  RenderOptions options;
  options.width = options.height = 16;
  options.spp = 2;
  options.report_bias = 0;
  return options;
}

/// A tree in daylight.
Scene tree() {
  Scene scene = make_procedural("scene:tree?leaves=100");
  std::vector<std::string> notes;
  scene.lights = daylight(choose_view(scene, small_picture(), notes).camera);
  return scene;
}

class ResumeContent : public FilmFile {
 protected:
  RenderResult begin(const RenderOptions& options) const {
    RenderControl control;
    control.checkpoint = path("a.ckpt");
    return render(tree(), options, control);
  }
  RenderResult resume(Scene scene, const RenderOptions& options) const {
    RenderControl control;
    control.resume = path("a.ckpt");
    return render(std::move(scene), options, control);
  }
};

using Change = void (*)(std::vector<Light>&);

constexpr Change kOtherLights[] = {
    [](std::vector<Light>& lights) { lights[0].radiance = V3f(0); },
    [](std::vector<Light>& lights) { lights[0].direction = V3f(0, -1, 0); },
    [](std::vector<Light>& lights) { lights[0].angular_radius *= 2; },
    [](std::vector<Light>& lights) { lights[1].rotation += 1; },
    [](std::vector<Light>& lights) { lights.pop_back(); },
};

TEST_F(ResumeContent, OtherLightsAreRefused) {
  begin(small_picture());
  EXPECT_NO_THROW(resume(tree(), small_picture()));
  for (const Change& change : kOtherLights) {
    SCOPED_TRACE(&change - kOtherLights);
    Scene scene = tree();
    change(scene.lights);
    const Error error = error_of([&] { resume(scene, small_picture()); });
    EXPECT_EQ(error.kind(), ErrorKind::usage);
    EXPECT_EQ(error.what(), "--resume " + path("a.ckpt") + ": differs from this run in lights");
  }
}

// Sums are of lights of radiance 1.
TEST_F(ResumeContent, OtherRadiancesAreThoseOfTheResumedRender) {
  begin(small_picture());
  Scene scene = tree();
  scene.lights[0].radiance *= 2;
  const Film whole = render(scene, small_picture()).film;
  const Film resumed = resume(scene, small_picture()).film;
  EXPECT_EQ(resumed.find("light.sun.R")->pixels, whole.find("light.sun.R")->pixels);
  EXPECT_EQ(resumed.find("R")->pixels, whole.find("R")->pixels);
}

TEST_F(ResumeContent, WithoutThePassLightOtherLightsAreNoDifference) {
  RenderOptions options = small_picture();
  options.light = false;
  begin(options);
  for (const Change& change : kOtherLights) {
    Scene scene = tree();
    change(scene.lights);
    EXPECT_NO_THROW(resume(scene, options));
  }
}

TEST_F(ResumeContent, AnotherDeviceIsNoted) {
  begin(small_picture());
  const auto notes_of_device = [&] {
    std::vector<std::string> notes = resume(tree(), small_picture()).statistics.notes;
    std::erase_if(notes, [](const std::string& note) { return !contains(note, " traced on "); });
    return notes;
  };
  EXPECT_TRUE(notes_of_device().empty());
  Checkpoint moved = read_checkpoint(path("a.ckpt"));
  moved.device = "GPU of a farm";
  write_checkpoint(path("a.ckpt"), moved, moved.state);
  EXPECT_EQ(notes_of_device(),
            std::vector{path("a.ckpt") + " was traced on GPU of a farm: the picture's bits are not "
                                         "those of one device"});
}

}  // namespace
}  // namespace dapple

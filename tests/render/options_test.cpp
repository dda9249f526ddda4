// Ranges of options: a value out of range is refused with the name of its flag; every value in
// range, the ends included, is accepted.
#include "dapple/options.hpp"

#include <gtest/gtest.h>

#include <functional>
#include <limits>
#include <string>
#include <vector>

#include "dapple/error.hpp"

namespace dapple {
namespace {

constexpr float kNan = std::numeric_limits<float>::quiet_NaN();
constexpr float kInfinity = std::numeric_limits<float>::infinity();

using Change = std::function<void(RenderOptions&)>;

/// The message of the usage Error that validate() throws, or "accepted".
std::string verdict(const Change& change) {
  RenderOptions options;
  change(options);
  try {
    validate(options);
  } catch (const Error& error) {
    EXPECT_EQ(error.kind(), ErrorKind::usage) << error.what();
    return error.what();
  }
  return "accepted";
}

template <class T>
Change set(T RenderOptions::*field, T value) {
  return [=](RenderOptions& options) { options.*field = value; };
}

Change crop(PixelRect rect) {
  return [=](RenderOptions& options) {
    options.width = 10;
    options.height = 5;
    options.crop = rect;
  };
}

Change falloff(float distance, float power) {
  return [=](RenderOptions& options) {
    options.ao_distance = distance;
    options.ao_falloff = power;
  };
}

Change rays(int spp, int RenderOptions::*field, int count) {
  return [=](RenderOptions& options) {
    options.spp = spp;
    options.*field = count;
  };
}

Change look(V3f from, V3f at, V3f up) {
  return [=](RenderOptions& options) { options.look = LookAt{from, at, up}; };
}

using O = RenderOptions;

TEST(Options, TheDefaultsAndTheEndsOfEveryRangeAreAccepted) {
  const Change changes[] = {
      [](O&) {},
      set(&O::width, 1),
      set(&O::width, 65535),
      set(&O::height, 1),
      set(&O::height, 65535),
      set(&O::spp, 1),
      set(&O::spp, 1 << 20),
      set(&O::camera_splitting, 4),
      set(&O::ao_rays, 4096),
      set(&O::light_rays, 4096),
      set(&O::back_every, 1),
      set(&O::back_every, 64),
      set(&O::footprint, 0.0f),
      set(&O::footprint, 1e6f),
      set(&O::ao_distance, 1e30f),
      [](O& o) { o.ambient = 0; },
      [](O& o) { o.ambient = 1e30f; },
      set(&O::fov_degrees, 0.01f),
      set(&O::fov_degrees, 179.0f),
      falloff(1, 100),
      falloff(1, 0),
      crop({0, 0, 9, 4}),
      crop({9, 4, 9, 4}),
      rays(1 << 12, &O::ao_rays, 1 << 12),
      rays(1 << 20, &O::light_rays, 16),
  };
  int index = 0;
  for (const Change& change : changes) EXPECT_EQ(verdict(change), "accepted") << index++;
}

TEST(Options, ValuesOutOfRangeAreRefusedWithTheirFlag) {
  struct Case {
    const char* flag;
    Change change;
  };
  const Case cases[] = {
      {"--width", set(&O::width, 0)},
      {"--width", set(&O::width, -1)},
      {"--width", set(&O::width, 65536)},
      {"--width", set(&O::width, std::numeric_limits<int>::min())},
      {"--height", set(&O::height, 0)},
      {"--height", set(&O::height, 65536)},
      {"--spp", set(&O::spp, 0)},
      {"--spp", set(&O::spp, (1 << 20) + 1)},
      {"--camera-splitting", set(&O::camera_splitting, 3)},
      {"--ambient", [](O& o) { o.ambient = -1; }},
      {"--ambient", [](O& o) { o.ambient = kNan; }},
      {"--camera-splitting", set(&O::camera_splitting, -1)},
      {"--camera-splitting", set(&O::camera_splitting, 8)},
      {"--ao-rays", set(&O::ao_rays, 0)},
      {"--ao-rays", set(&O::ao_rays, 4097)},
      {"--light-rays", set(&O::light_rays, -5)},
      {"--light-rays", set(&O::light_rays, 4097)},
      {"--back-every", set(&O::back_every, 0)},
      {"--back-every", set(&O::back_every, 12)},
      {"--back-every", set(&O::back_every, 65)},
      {"--footprint", set(&O::footprint, -0.001f)},
      {"--footprint", set(&O::footprint, kNan)},
      {"--footprint", set(&O::footprint, kInfinity)},
      {"--roulette", set(&O::roulette, -0.01f)},
      {"--estimator", set(&O::estimator, static_cast<Estimator>(7))},
      {"--normals", set(&O::normals, static_cast<Normals>(7))},
      {"--packets", set(&O::packets, static_cast<Packets>(77))},
      {"--roulette", set(&O::roulette, 1.0f)},
      {"--roulette", set(&O::roulette, kNan)},
      {"--report-bias", set(&O::report_bias, -0.01f)},
      {"--report-bias", set(&O::report_bias, 1.01f)},
      {"--max-bias", set(&O::max_bias, std::optional(-0.01f))},
      {"--max-bias", set(&O::max_bias, std::optional(kNan))},
      {"--ao-distance", set(&O::ao_distance, -1.0f)},
      {"--ao-distance", set(&O::ao_distance, kNan)},
      {"--ao-distance", set(&O::ao_distance, kInfinity)},
      {"--ao-falloff", falloff(1, -1)},
      {"--ao-falloff", falloff(1, kNan)},
      {"--ao-falloff", falloff(1, 101)},
      {"--ao-distance", falloff(0, 1)},
      {"--fov", set(&O::fov_degrees, -10.0f)},
      {"--fov", set(&O::fov_degrees, 180.0f)},
      {"--fov", set(&O::fov_degrees, kNan)},
      {"--look-from", look({kNan, 0, 0}, {0, 0, 0}, {0, 1, 0})},
      {"--look-at", look({0, 0, 0}, {0, kInfinity, 0}, {0, 1, 0})},
      {"--up", look({0, 0, 0}, {0, 0, 1}, {0, 0, kNan})},
      {"--crop", crop({0, 0, 10, 4})},
      {"--crop", crop({0, 0, 9, 5})},
      {"--crop", crop({-1, 0, 9, 4})},
      {"--crop", crop({5, 0, 4, 4})},
      {"--crop", crop({0, 3, 9, 2})},
      {"--ao-rays", rays(1 << 20, &O::ao_rays, 17)},
      {"--light-rays", rays(1 << 20, &O::light_rays, 17)},
  };
  int index = 0;
  for (const Case& c : cases) {
    EXPECT_NE(verdict(c.change).find(c.flag), std::string::npos)
        << "case " << index << ", " << c.flag << ": " << verdict(c.change);
    ++index;
  }
}

TEST(FootprintSamples, AreTheOptionOrWhatATargetNeeds) {
  RenderOptions options;
  options.spp = 12;
  EXPECT_EQ(footprint_samples(options), 12);
  options.target_rmse = 0.05f;
  EXPECT_EQ(footprint_samples(options), 12);
  options.target_rmse = 0.01f;
  EXPECT_EQ(footprint_samples(options), 32);
  options.target_rmse = 0;
  options.target_error = 0.01f;
  EXPECT_EQ(footprint_samples(options), 64);
  options.target_error = 1e-6f;
  EXPECT_EQ(footprint_samples(options), options.max_spp);
  options.footprint_spp = 7;
  EXPECT_EQ(footprint_samples(options), 7);
}

}  // namespace
}  // namespace dapple

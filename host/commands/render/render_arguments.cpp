// The options of `dapple render`. In: the command line. Out: the arguments as typed.
#include "commands/render/render_arguments.hpp"

#include <fmt/format.h>

#include "commands/arguments/argument_errors.hpp"
#include "commands/arguments/shared_options.hpp"

namespace dapple {
namespace {

void add_sampling_options(CLI::App& app, RenderArguments& a) {
  RenderOptions& o = a.options;
  app.add_option("--spp", a.spp,
                 "Camera rays per pixel. With a target this is the minimum, and each pixel gets at "
                 "least 8 samples: camera rays times --camera-splitting")
      ->check(of_values("1..1048576"))
      ->default_str(fmt::format("{}; 1 with --target-rmse", o.spp));
  app.add_option("--target-error", o.target_error,
                 "Sample each pixel until its estimated standard error is below this; 0: no "
                 "target. A light's error is divided by the largest irradiance that it gives "
                 "anywhere without occlusion. Not with --target-rmse")
      ->check(of_values("0..1"))
      ->capture_default_str();
  app.add_option("--target-rmse", o.target_rmse,
                 "Sample until the estimated RMSE over all pixels is below this in each pass; 0: "
                 "no target. Faster than --target-error, but the error varies more from pixel to "
                 "pixel. Not with --target-error")
      ->check(of_values("0..1"))
      ->capture_default_str();
  app.add_option("--max-spp", o.max_spp,
                 "With a target: the largest number of camera rays per pixel")
      ->check(of_values("1..1048576"))
      ->capture_default_str();
  app.add_option(
         "--camera-splitting", o.camera_splitting,
         "Number of surfaces that each camera ray shades: 1, 2 or 4; 0: dapple chooses from "
         "the opacities of the scene. Larger values suit thin leaves and hair")
      ->check(of_values("{0,1,2,4}"))
      ->capture_default_str();
  app.add_option(
         "--ao-rays", o.ao_rays,
         "AO rays per camera ray. The surfaces that the camera ray shades share them; each gets at "
         "least one")
      ->check(of_values("1..4096"))
      ->capture_default_str();
  app.add_option("--light-rays", o.light_rays, "Rays per light and shaded surface")
      ->check(of_values("1..4096"))
      ->capture_default_str();
  add_prefiltering_options(app, a.estimator, o.footprint, a.report_bias)
      ->each([&a](const std::string&) { a.footprint_given = true; });
  app.add_option(
         "--roulette", o.roulette,
         "With --estimator exact: rays of less transmittance than this end at random, and "
         "the others count for them: the same mean, sooner, with a little more noise; below 1; "
         "0: none ends")
      ->check(of_values("0..1"))
      ->capture_default_str();
  app.add_option(
         "--max-bias", o.max_bias,
         "Choose the largest footprint, from --footprint down to 0, whose bias is below this in "
         "each layer; 0: take --footprint. Without it, --footprint, --frame and a target: a "
         "smaller footprint if a part of the rays shows that the bias is above 0.002")
      ->check(of_values("0..1"))
      ->type_name("FLOAT");
}

void add_layer_options(CLI::App& app, RenderArguments& a) {
  RenderOptions& o = a.options;
  app.add_option(
         "--passes", a.passes,
         "With commas between: ao, light, albedo (colours), beauty (what the sky and each "
         "light add to RGB; brings light), back (AO and light of the side that faces away from the "
         "camera), motion (pixels until the next frame), visits (nodes and triangles tested)")
      ->capture_default_str();
  app.add_option("--back-every", o.back_every,
                 "With --passes back: one in so many samples is traced on that side, too: 1, 2, 4, "
                 "8, 16, 32 or 64. With 1 these layers have as little noise as those in front, and "
                 "a render takes up to 1.7 times as long")
      ->check(of_values("{1,2,4,8,16,32,64}"))
      ->capture_default_str();
  app.add_option(
         "--ambient", o.ambient,
         "Radiance of a uniform sky that lights the RGBA picture through AO. Default: 1 without "
         "lights, 0 with a dome, otherwise a tenth of the radiance that the lights give white "
         "surfaces without occlusion (90th percentile of the pixels)")
      ->check(of_values("0..1e+30"));
  app.add_option("--normals", a.normals,
                 "shading: the normals of the meshes; geometric: flat facets")
      ->capture_default_str();
  app.add_option("--cryptomatte", a.cryptomatte,
                 "Also make Cryptomattes: object, material, or both with a comma between");
  add_ao_range_options(app, o.ao_distance, o.ao_falloff);
  app.add_option("--seed", o.seed, "Seed of the random numbers: another seed gives other noise")
      ->capture_default_str();
}

void add_picture_options(CLI::App& app, RenderArguments& a) {
  RenderOptions& o = a.options;
  app.add_option("--width", o.width, "Image width, pixels")
      ->check(of_values("1..65535"))
      ->capture_default_str();
  app.add_option("--height", o.height, "Image height, pixels")
      ->check(of_values("1..65535"))
      ->capture_default_str();
  app.add_option("--crop", a.crop,
                 "Only this part: X0,Y0,X1,Y1, pixels from the top left, both ends included");
  add_sampling_options(app, a);
  add_layer_options(app, a);
}

void add_scene_options(CLI::App& app, RenderArguments& a) {
  RenderOptions& o = a.options;
  CLI::Option& camera =
      *app.add_option("--camera", o.camera,
                      "Camera by name; default: the scene's first, or one that shows all of it");
  CLI::Option& look_from =
      *app.add_option("--look-from", a.look_from, "Camera position X,Y,Z, metres (with --look-at)");
  look_from.excludes(&camera);
  app.add_option("--look-at", a.look_at, "Point that this camera looks at: X,Y,Z");
  app.add_option("--up", a.up,
                 "Up direction of this camera: X,Y,Z; default 0,1,0, or 0,0,-1 for one that looks "
                 "straight up or down")
      ->needs(&look_from);
  app.add_option("--fov", a.fov,
                 "Vertical field of view, degrees; default: the camera's own, or 40")
      ->check(of_values("0.01..179"));
  app.add_option("--aperture", o.aperture,
                 "Depth of field: radius of the camera's lens, metres; 0: everything is sharp; "
                 "default: the camera's own")
      ->check(of_values("0..1000000"));
  app.add_option(
      "--focus-distance", o.focus_distance,
      "Distance along the view direction that is sharp, metres; default: the camera's own, "
      "--look-at, or the middle of the scene. Needs --aperture or a camera with a lens");
  app.add_option("--lights", a.lights, "JSON file of lights, in place of the scene's own");
  app.add_option(
      "--dome", a.dome,
      "Latitude-longitude image, OpenEXR or Radiance HDR, that lights the scene from all "
      "around, in addition to the other lights");
  add_rotation_option(app, "--dome-rotation", "dome", a.dome_rotation);
  add_light_radius_option(app, a.scene_options.light_radius);
  app.add_option("--line-radius", a.scene_options.line_radius,
                 "Turn a glTF file's lines into strands of this radius, metres; 0: ignore them")
      ->capture_default_str();
  add_outside_option(app, a.scene_options.allow_outside);
  add_opacity_option(app, a.opacity);
  app.add_flag("--ground", o.ground, "Put an opaque plane under the scene");
  app.add_option("--ground-height", o.ground_height,
                 "Where that plane is: its y, metres; default: just below the scene's lowest point")
      ->check(of_values("-1e+12..1e+12"));
}

void add_checkpoint_options(CLI::App& app, RenderArguments& a) {
  CLI::Option& checkpoint = *app.add_option("--checkpoint", a.checkpoint,
                                            "Write the state of the render to this file, for "
                                            "--resume: periodically, on interruption and at the "
                                            "end");
  app.add_option("--checkpoint-every", a.checkpoint_every,
                 "Time between two saves: 30 or 30s (seconds), 5m, 1h")
      ->capture_default_str()
      ->needs(&checkpoint);
  CLI::Option& resume = *app.add_option(
      "--resume", a.resume,
      "Continue from this checkpoint, with the same scene and options; you may raise --spp and "
      "--max-spp, and lower the targets");
  app.add_option("--resume-or-begin", a.resume_or_begin,
                 "The same for scripts: begin anew where it is missing, damaged or does not fit")
      ->excludes(&resume);
  app.add_option("--shard", a.shard,
                 "Trace only a part of the samples, for dapple merge: I/N, the I-th of N parts, as "
                 "in 2/8; --spp is that of the whole image");
}

void add_motion_options(CLI::App& app, RenderArguments& a) {
  CLI::Option& frame =
      *app.add_option("--frame", a.frame,
                      "Time to render, in seconds (not a frame number); default: the rest pose");
  app.add_option("--frames", a.frames,
                 "Render a sequence: A-B or A-B:STEP, frame n at n / fps seconds; write # "
                 "characters in output names for the frame number")
      ->excludes(&frame);
  app.add_flag("--animate-seed", a.animate_seed,
               "With --frames: other noise in each frame, whose number is added to --seed");
  app.add_option("--fps", a.fps, "Frames per second, for --frames, --shutter and motion vectors")
      ->default_str("24");
  CLI::Option& shutter = *app.add_option(
      "--shutter", a.shutter,
      "Motion blur: OPEN,CLOSE, when the shutter opens and closes, in frames relative to the "
      "frame's time, as in --shutter=-0.25,0.25. Needs --frame or --frames");
  app.add_option("--motion-samples", a.motion_samples,
                 "Number of times at which the shutter is sampled; --spp is divided among them. "
                 "Default: the most from 4 to 8 that divide --spp, else 8, at most --spp")
      ->check(of_values("1..1024"))
      ->needs(&shutter);
  app.add_option("--animation", a.scene_options.animation,
                 "The glTF animation that plays, by name; *: all at once; default: the first. "
                 "Needs --frame or --frames");
}

}  // namespace

void add_file_options(CLI::App& app, RenderArguments& a) {
  app.add_option("--png", a.png,
                 "Also write an 8-bit preview NAME.png; with --passes visits, also a heat map, "
                 "NAME_visits.png");
  app.add_option(
         "--exposure", a.exposure,
         "Exposure of the PNG in stops: 1 is twice as bright; auto: dapple chooses it from the "
         "brightness of the picture")
      ->capture_default_str();
  app.add_option("--background", a.background,
                 "Background of the PNG: sky (above a grey plain), none (keeps alpha), or a linear "
                 "colour R,G,B "
                 "from 0 to 1")
      ->capture_default_str();
  app.add_option(
      "--half", a.half,
      "Layers to store as 16-bit floats: names separated by commas, or all. Z, P, motion, "
      "samples and Cryptomattes stay 32-bit");
  app.add_flag("--multipart", a.multipart, "Write a part for each layer");
  app.add_option("--compression", a.compression,
                 "Compression of the EXR: zip, zips, piz, none; dwaa (lossy, for colours only; "
                 "with --multipart)")
      ->capture_default_str();
}

void add_render_options(CLI::App& app, RenderArguments& a) {
  app.add_option("SCENE", a.scene,
                 "glTF file (.gltf, .glb), hair (.hair) or a procedural scene, "
                 "\"scene:tree?leaves=50000\"")
      ->required();
  app.add_option("-o,--output", a.output,
                 "OpenEXR file to write; FILE.dapple: a part for dapple merge")
      ->required();
  add_file_options(app, a);
  app.add_option("--deep", a.deep,
                 "Also write a deep OpenEXR file: the opacity (A) at depths (Z) of each pixel");
  add_picture_options(app, a);
  add_scene_options(app, a);
  add_motion_options(app, a);
  add_checkpoint_options(app, a);
  app.add_option("--packets", a.packets,
                 "How occlusion rays are traced: none (one by one), pixel (packets of rays from "
                 "neighbouring pixels), point (packets of rays from one point), scalar (for GPUs: "
                 "every ray, those of the camera too, in a work-item of its own), auto (the device "
                 "decides)")
      ->capture_default_str();
  add_device_options(app, a.options.device, a.options.kernel_dir, a.options.cache);
  add_report_options(app, a.stats_json, a.quiet);
}

}  // namespace dapple

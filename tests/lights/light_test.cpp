// Compares the irradiance of each kind of light with its closed form. Emissive meshes must not
// occlude their own samples, but must occlude AO.
#include <gtest/gtest.h>

#include <algorithm>
#include <functional>

#include "film/layers.hpp"
#include "support/scenes/point_on_ground.hpp"

namespace dapple {
namespace {

using namespace scene_test;
using namespace point_on_ground_test;

// Irradiance at the origin, facing +Y, of a polygon of radiance 1 above the horizon: Lambert's
// sum over its edges (Arvo, "The Irradiance Jacobian for Partially Occluded Polyhedral
// Sources", 1994, equation 2). Positive for both windings.
double polygon_irradiance(const std::vector<V3f>& corners) {
  double sum = 0;
  for (std::size_t i = 0; i < corners.size(); ++i) {
    const V3d a = V3d(corners[i]).normalized();
    const V3d b = V3d(corners[(i + 1) % corners.size()]).normalized();
    sum += std::acos(std::clamp(a.dot(b), -1.0, 1.0)) * a.cross(b).normalized().y;
  }
  return std::fabs(sum) / 2;
}

double rect_irradiance(const Light& light) {
  const V3f& p = light.position;
  const V3f u = light.edge_u * 0.5f, v = light.edge_v * 0.5f;
  return polygon_irradiance({p - u - v, p + u - v, p + u + v, p - u + v});
}

Light rect(const std::string& name, V3f position, V3f edge_u, V3f edge_v, V3f direction) {
  Light light;
  light.name = name;
  light.position = position;
  light.edge_u = edge_u;
  light.edge_v = edge_v;
  light.direction = direction.normalized();
  return light;
}

Light sphere(const std::string& name, V3f position, float radius) {
  Light light;
  light.name = name;
  light.kind = LightKind::sphere;
  light.position = position;
  light.radius = radius;
  return light;
}

Light sun(const std::string& name, V3f towards, float angular_radius) {
  Light light;
  light.name = name;
  light.kind = LightKind::sun;
  light.direction = -towards.normalized();
  light.angular_radius = angular_radius;
  return light;
}

/// Lights over the ground, and the irradiance of each at radiance 1.
struct ExpectedLights {
  Scene scene = point_on_ground();
  std::vector<double> irradiance;

  void add(Light light, double expected) {
    scene.lights.push_back(std::move(light));
    irradiance.push_back(expected);
  }

  /// Renders the lights with a radiance that is different in each channel.
  void expect_irradiance() {
    for (Light& light : scene.lights) light.radiance = V3f(1, 2, 0.25f);
    RenderOptions options = one_pixel();
    options.ao = false;
    const Film film = render(scene, options).film;
    for (std::size_t i = 0; i < irradiance.size(); ++i) {
      const std::string layer = "light." + layer_name(scene.lights[i].name);
      SCOPED_TRACE(layer);
      const double error = kSampling * irradiance[i] + 1e-12;
      EXPECT_NEAR(value(film, layer + ".R"), irradiance[i], error);
      EXPECT_NEAR(value(film, layer + ".G"), 2 * irradiance[i], 2 * error);
      EXPECT_NEAR(value(film, layer + ".B"), irradiance[i] / 4, error / 4);
    }
  }
};

TEST(Light, IrradianceOfRectsIsTheirClosedFormAndZeroBehindThem) {
  ExpectedLights lights;
  // A rect parallel to the ground, centred above the point: 4 times B-3 of Howell's form factor
  // catalogue.
  const auto parallel = [](double x, double y) {
    const double p = std::sqrt(1 + x * x), q = std::sqrt(1 + y * y);
    return 2 * (x / p * std::atan(y / p) + y / q * std::atan(x / q));
  };
  lights.add(rect("parallel", {0, 2, 0}, {1, 0, 0}, {0, 0, 3}, {0, -1, 0}), parallel(0.25, 0.75));
  lights.add(rect("large", {0, 1, 0}, {8, 0, 0}, {0, 0, 6}, {0, -1, 0}), parallel(4, 3));
  const Light wall = rect("perpendicular", {0, 1, -2}, {3, 0, 0}, {0, 2, 0}, {0, 0, 1});
  lights.add(wall, rect_irradiance(wall));
  const Light tilted =
      rect("tilted", {1, 2, -1}, {1, 0.5f, 0}, {0, 0.7f, 1.2f}, {-0.6f, 1.2f, -0.7f});
  Light facing = tilted;
  facing.direction = tilted.edge_u.cross(tilted.edge_v).normalized();
  if (facing.direction.dot(facing.position) > 0) facing.direction = -facing.direction;
  lights.add(facing, rect_irradiance(facing));
  Light away = facing;
  away.name = "away";
  away.direction = -away.direction;
  lights.add(away, 0);
  lights.expect_irradiance();
}

TEST(Light, IrradianceOfSpheresAndSpotsIsTheirClosedForm) {
  ExpectedLights lights;
  // A sphere that is completely above the horizon: pi (r / d)^2 cos.
  const V3f there(1, 2, -1);
  const double cosine = 2 / std::sqrt(6.0);
  lights.add(sphere("sphere", there, 0.5f), kPi * 0.25 / 6 * cosine);
  lights.add(sphere("near", {0, 1.2f, 0}, 1), kPi / 1.44);
  lights.add(sphere("tiny", there, 1e-3f), kPi * 1e-6 / 6 * cosine);
  // Spot cones as in KHR_lights_punctual: 1 inside the inner one, between the two
  // ((c - outer) / (inner - outer))^2.
  Light spot = sphere("spot", {0, 2, 0}, 0.1f);
  spot.direction = V3f(0, -1, 1).normalized();
  spot.cos_outer = 0.5f;
  spot.cos_inner = 0.9f;
  const double edge = (std::sqrt(0.5) - 0.5) / 0.4;
  lights.add(spot, kPi * 0.01 / 4 * edge * edge);
  lights.expect_irradiance();
}

TEST(Light, IrradianceOfSunsIsTheirProjectedSolidAngle) {
  ExpectedLights lights;
  for (const double radius : {0.00465, 0.2, 1.0}) {
    // Every sun is completely above the horizon; the widest is straight above.
    const V3f up = radius < 0.5 ? V3f(1, 2, -1) : V3f(0, 1, 0);
    const double cosine = radius < 0.5 ? 2 / std::sqrt(6.0) : 1.0;
    const double sine = std::sin(radius);
    lights.add(
        sun("sun" + std::to_string(lights.scene.lights.size()), up, static_cast<float>(radius)),
        kPi * sine * sine * cosine);
  }
  lights.expect_irradiance();
}

TEST(Light, AnOccluderBetweenTakesItsOpacityFromEveryKind) {
  Scene scene = point_on_ground();
  scene.lights = {rect("rect", {0, 2, 0}, {1, 0, 0}, {0, 0, 1}, {0, -1, 0}),
                  sphere("sphere", {0, 2, 0}, 0.5f), sun("sun", {0, 1, 0}, 0.1f)};
  RenderOptions options = one_pixel();
  options.ao = false;
  const Film free = render(scene, options).film;
  scene.materials.push_back(material_of(0.25f));
  place(scene, square_mesh(6, 1.25f, 1, 1));  // above the camera, below the lights
  const Film shaded = render(scene, options).film;
  for (const char* channel : {"light.rect.R", "light.sphere.R", "light.sun.R"}) {
    // Both films use the same rays; they differ only by fixed point and at the quad's diagonal,
    // which few rays hit.
    EXPECT_NEAR(value(shaded, channel), 0.75 * value(free, channel), 1e-3 * value(free, channel));
  }
}

// A box of side 1 around `centre` whose faces point outwards, each of `divisions` x `divisions`
// squares.
Mesh box_mesh(const V3f& centre, int divisions, std::uint32_t material) {
  Mesh mesh;
  for (int axis = 0; axis < 3; ++axis) {
    V3f out(0.0f), u(0.0f), v(0.0f);
    out[axis] = 1;
    u[(axis + 1) % 3] = 1;
    v[(axis + 2) % 3] = 1;  // u x v = out
    append_grid(mesh, centre + (out - u - v) * 0.5f, u, v, divisions, material);
    append_grid(mesh, centre + (-out - v - u) * 0.5f, v, u, divisions, material);
  }
  return mesh;
}

// Irradiance of the box: the sum over the faces that face the origin, which do not occlude each
// other.
double box_irradiance(const V3f& centre) {
  double sum = 0;
  for (int axis = 0; axis < 3; ++axis) {
    V3f u(0.0f), v(0.0f), out(0.0f);
    u[(axis + 1) % 3] = 0.5f;
    v[(axis + 2) % 3] = 0.5f;
    for (const float side : {-0.5f, 0.5f}) {
      out[axis] = side;
      const V3f middle = centre + out;
      if (out.dot(middle) >= 0) continue;
      sum += polygon_irradiance({middle - u - v, middle + u - v, middle + u + v, middle - u + v});
    }
  }
  return sum;
}

Light mesh_light(bool double_sided = false) {
  Light light;
  light.name = "glow";
  light.kind = LightKind::mesh;
  light.double_sided = double_sided;
  return light;
}

// Where the point is close to an edge, the directions to the edge's ends are nearly opposite.
TEST(Light, IrradianceBelowAnEdgeOfATriangleDoesNotDependOnItsFirstCorner) {
  for (const float height : {1e-2f, 1e-3f, 1e-4f}) {
    const std::vector<V3f> corners = {{-0.7f, height, 0}, {0.7f, height, 0}, {0, height, -0.7f}};
    const double expected = polygon_irradiance(corners);
    for (std::uint32_t first = 0; first < 3; ++first) {
      Scene scene = point_on_ground();
      scene.lights = {mesh_light(true)};
      scene.lights[0].radiance = V3f(1);
      Mesh triangle;
      triangle.positions = corners;
      triangle.indices = {first, (first + 1) % 3, (first + 2) % 3};
      triangle.materials = {0};
      place(scene, std::move(triangle), {}, 0);
      const SceneOnDevice on(std::move(scene));
      const auto found = irradiance(device(), on.uploaded, on.scene.lights, std::vector{V3f(0)},
                                    std::vector{V3f(0, 1, 0)}, {4096, Estimator::exact, 1, 0});
      EXPECT_NEAR(found[0].irradiance[0].x, expected, kSampling * expected)
          << height << ", " << first;
    }
  }
}

// As lamps are built into ceilings: rays end at points that lie in the ceiling but for roundings.
TEST(Light, IsNotHiddenByASurfaceInWhosePlaneItLies) {
  for (const float tilt : {0.0f, 0.3f}) {
    Scene open = point_on_ground();
    M44f turn;
    turn.rotate(V3f(tilt, 0, 0));
    const V3f x(1, 0, 0), z = V3f(0, 0, 1) * turn, down = V3f(0, -1, 0) * turn;
    for (int i = 0; i < 6; ++i) {
      const V3f at = V3f(0, 2.7f, 0) + x * (0.37f * static_cast<float>(i) - 1) + z * 0.21f;
      Light disk = rect("disk", at, x, z, down);
      disk.kind = LightKind::disk;
      disk.radius = 0.4f;
      open.lights.insert(open.lights.end(), {rect("rect", at, x, z, down), disk});
    }
    Scene closed = open;
    Mesh ceiling;
    append_grid(ceiling, V3f(0, 2.7f, 0) - x * 3 - z * 3, x * 6, z * 6, 5, 0);
    place(closed, std::move(ceiling));
    RenderOptions options = one_pixel();
    options.ao = false;
    for (const Packets packets : {Packets::automatic, Packets::scalar}) {
      options.packets = packets;
      const Film under_sky = render(open, options).film;
      const Film under_ceiling = render(closed, options).film;
      for (const std::string& layer : light_names(open.lights)) {
        const float expected = value(under_sky, "light." + layer + ".R");
        EXPECT_GT(expected, 0);
        EXPECT_NEAR(value(under_ceiling, "light." + layer + ".R"), expected, 1e-5f * expected)
            << layer << ", tilt " << tilt;
      }
    }
  }
}

TEST(Light, AShadeCloseBelowALampHidesItFarFromTheOriginToo) {
  for (const float x : {0.0f, 30'000.0f}) {
    Scene scene = point_on_ground();
    scene.lights.push_back(rect("lamp", {0, 2, 0}, {0.5f, 0, 0}, {0, 0, 0.5f}, {0, -1, 0}));
    place(scene, square_mesh(4, 1.9f, 1, 0), {});
    const M44f aside = M44f().setTranslation(V3f(x, 0, 0));
    for (Instance& instance : scene.instances) instance.to_world = instance.to_world * aside;
    for (Camera& camera : scene.cameras) camera.to_world = camera.to_world * aside;
    scene.lights[0].position.x += x;
    RenderOptions options = one_pixel();
    options.ao = false;
    EXPECT_EQ(value(render(scene, options).film, "light.lamp.R"), 0) << x;
  }
}

TEST(EmissiveMesh, NeverOccludesItsOwnSamplesAndDoesOccludeAo) {
  for (const V3f& centre : {V3f(0, 1.7f, 0), V3f(1.5f, 2, -0.8f)}) {
    Scene scene = point_on_ground();
    scene.lights.push_back(mesh_light());
    place(scene, box_mesh(centre, 8, 0), {}, 0);
    const double expected = box_irradiance(centre);
    for (const auto& [estimator, footprint] : {std::pair{Estimator::exact, 1.0f},
                                               {Estimator::prefiltered, 1.0f},
                                               {Estimator::prefiltered, 1000.0f}}) {
      SCOPED_TRACE(testing::Message() << "box at " << centre << ", footprint " << footprint);
      const Film film = render(scene, one_pixel(estimator, footprint)).film;
      // Half of the samples are on faces that point away, so the noise is larger; with independent
      // random samples it would be about 4 / sqrt(4096).
      const float glow = value(film, "light.glow.R");
      EXPECT_NEAR(glow, expected, 0.01 * expected);
      // The box is opaque and convex, so it occludes the directions that it lights. Wide footprints
      // blur its outline; the SolidCube tests bound that.
      if (footprint > 1) continue;
      EXPECT_NEAR(value(film, "ao.R"), 1 - expected / kPi, 0.003);
    }
  }
}

TEST(EmissiveMesh, ItsFrontPartDoesNotShadeThePartBehind) {
  Scene scene = point_on_ground();
  scene.lights.push_back(mesh_light());
  Mesh two_squares;
  double expected = 0;
  for (const float height : {1.5f, 2.5f}) {
    append_grid(two_squares, {-1, height, -1}, {2, 0, 0}, {0, 0, 2}, 4, 0);  // facing down
    expected +=
        polygon_irradiance({{-1, height, -1}, {1, height, -1}, {1, height, 1}, {-1, height, 1}});
  }
  place(scene, std::move(two_squares), {}, 0);
  for (const float footprint : {0.0f, 1.0f, 1000.0f}) {
    const Film film = render(scene, one_pixel(Estimator::prefiltered, footprint)).film;
    EXPECT_NEAR(value(film, "light.glow.R"), expected, 0.01 * expected) << footprint;
  }
}

TEST(EmissiveMesh, ShinesInProportionToItsOpacity) {
  const auto glow = [](const std::function<void(Scene&, Mesh&)>& change) {
    Scene scene = point_on_ground();
    scene.lights.push_back(mesh_light());
    scene.materials.push_back(scene.materials[0]);
    scene.materials[1].alpha_mode = AlphaMode::blend;
    Mesh square;
    append_grid(square, {-0.1f, 2, -0.1f}, {0.2f, 0, 0}, {0, 0, 0.2f}, 1, 1);
    change(scene, square);
    place(scene, std::move(square), {}, 0);
    RenderOptions options = one_pixel();
    options.ao = false;
    return value(render(scene, options).film, "light.glow.R");
  };
  const float all = glow([](Scene&, Mesh&) {});
  EXPECT_GT(all, 0);
  EXPECT_NEAR(glow([](Scene& scene, Mesh&) { scene.materials[1].alpha = 0.5f; }), all / 2,
              0.01f * all);
  const auto a_quarter = [](Scene& scene, Mesh& mesh) {
    Texture texture;  // a quarter in a corner
    texture.width = texture.height = 64;
    for (std::uint32_t i = 0; i < 64 * 64; ++i)
      texture.alpha.push_back(i % 64 < 32 && i / 64 < 32 ? 255 : 0);
    scene.textures = {texture};
    scene.materials[1].alpha_mode = AlphaMode::mask;
    scene.materials[1].alpha_texture = 0;
    for (const V3f& p : mesh.positions) mesh.uvs.emplace_back(5 * p.x + 0.5f, 5 * p.z + 0.5f);
  };
  EXPECT_NEAR(glow(a_quarter), all / 4, 0.02f * all);
}

TEST(EmissiveMesh, EmitsFromItsFrontUnlessDoubleSidedAlsoWhenPlacedMirrored) {
  struct Side {
    bool mirrored, faces_down, double_sided, lit;
  };
  M44f mirror;
  mirror.setScale(V3f(-1, 1, 1));
  for (const Side& side : {Side{false, true, false, true},
                           {false, false, false, false},
                           {false, false, true, true},
                           {true, true, false, true},
                           {true, false, false, false}}) {
    Scene scene = point_on_ground();
    scene.lights.push_back(mesh_light(side.double_sided));
    Mesh square;
    const V3f x(2, 0, 0), z(0, 0, 2);
    append_grid(square, {-1, 2, -1}, side.faces_down ? x : z, side.faces_down ? z : x, 1, 0);
    place(scene, std::move(square), side.mirrored ? mirror : M44f{}, 0);
    RenderOptions options = one_pixel();
    options.ao = false;
    const double expected =
        side.lit ? polygon_irradiance({{-1, 2, -1}, {1, 2, -1}, {1, 2, 1}, {-1, 2, 1}}) : 0.0;
    EXPECT_NEAR(value(render(scene, options).film, "light.glow.R"), expected, 0.01 * expected)
        << "mirrored " << side.mirrored << " faces down " << side.faces_down << " double sided "
        << side.double_sided;
  }
}

}  // namespace
}  // namespace dapple

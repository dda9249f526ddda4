// Embree traverses the scene with its robust intersectors. Filter functions reject every hit that
// does not stop the ray. The hit point is then computed again, in double, from the triangle.
#include "oracle/embree_oracle.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <numbers>
#include <stdexcept>
#include <vector>

#include "oracle/embree_ray.hpp"
#include "oracle/oracle_primitives.hpp"

namespace dapple::oracle {
namespace {

/// Smaller transmittances count as 0: a hundredth of the smallest difference that tests look for.
constexpr double kBlack = 1e-6;

std::uint64_t mix(std::uint64_t z) {
  z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9u;
  z = (z ^ (z >> 27)) * 0x94d049bb133111ebu;
  return z ^ (z >> 31);
}

/// The hit with the triangle's shading normal. Where the surface is convex, in one direction at
/// least, rays start from the mean of the point's projections to planes of the corners, which lean
/// as these differ from the interpolated normal, as far as they lie above. `along`: the direction
/// of the ray that sees it; a normal that faces away turns across the facet until it faces the
/// viewer as much.
Hit shaded(const Triangle& triangle, const Weights& weights, const V3d& along, Hit hit) {
  V3d sum(0.0), projected = hit.position;
  for (int k = 0; k < 3; ++k) sum += triangle.normal[k] * weights.of[k];
  if (!(sum.length2() > 0)) return hit;
  const V3d total = triangle.normal[0] + triangle.normal[1] + triangle.normal[2];
  const bool other_side = total.dot(hit.facet) < 0;
  for (int k = 0; k < 3; ++k) {
    const V3d& normal = triangle.normal[k];
    const double height = (hit.position - V3d(triangle.corner[k])).dot(sum - normal);
    const double on_side = other_side ? std::min(0.0, height) : std::max(0.0, height);
    projected += normal * (weights.of[k] * on_side);
  }
  hit.normal = sum.normalized() * (other_side ? -1 : 1);
  const double away = hit.normal.dot(along);
  if (away > 0) {
    const V3d leaning = hit.normal - hit.facet * hit.normal.dot(hit.facet);
    hit.normal = (hit.normal - leaning * (2 * away / leaning.dot(along))).normalized();
  }
  hit.hides = !((projected - hit.position).dot(hit.facet) > 0);
  if (!hit.hides) hit.start = projected;
  return hit;
}

/// Embree joins two segments when their first vertices follow each other in the buffer.
RTCGeometry strand_geometry(RTCDevice device, const std::vector<Curve>& curves) {
  std::vector<float> vertices;
  std::vector<unsigned> first;
  const auto add = [&](const Curve& curve, int k) {
    vertices.insert(vertices.end(),
                    {curve.end[k].x, curve.end[k].y, curve.end[k].z, curve.radius[k]});
  };
  for (const Curve& curve : curves) {
    first.push_back(static_cast<unsigned>(vertices.size() / 4));
    add(curve, 0);
    if (!curve.goes_on) add(curve, 1);
  }
  const RTCGeometry geometry = rtcNewGeometry(device, RTC_GEOMETRY_TYPE_ROUND_LINEAR_CURVE);
  void* const to = rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT4,
                                           4 * sizeof(float), vertices.size() / 4);
  void* const indices = rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT,
                                                sizeof(unsigned), first.size());
  if (!to || !indices) throw std::runtime_error("Embree: no memory for the strands");
  std::memcpy(to, vertices.data(), vertices.size() * sizeof(float));
  std::memcpy(indices, first.data(), first.size() * sizeof(unsigned));
  rtcCommitGeometry(geometry);
  return geometry;
}

/// All triangles as one geometry of Embree; primitive numbers are positions in `triangles`.
RTCGeometry soup_geometry(RTCDevice device, const std::vector<Triangle>& triangles) {
  const RTCGeometry geometry = rtcNewGeometry(device, RTC_GEOMETRY_TYPE_TRIANGLE);
  auto* corners = static_cast<float*>(rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0,
                                                              RTC_FORMAT_FLOAT3, 3 * sizeof(float),
                                                              3 * triangles.size()));
  auto* indices = static_cast<unsigned*>(
      rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3,
                              3 * sizeof(unsigned), triangles.size()));
  if (!corners || !indices) throw std::runtime_error("Embree: no memory for the triangles");
  for (std::size_t i = 0; i < 3 * triangles.size(); ++i) {
    const V3f& corner = triangles[i / 3].corner[i % 3];
    for (int axis = 0; axis < 3; ++axis) *corners++ = corner[axis];
    indices[i] = static_cast<unsigned>(i);
  }
  rtcCommitGeometry(geometry);
  return geometry;
}

}  // namespace

std::uint64_t Random::bits() { return mix(state_ += 0x9e3779b97f4a7c15u); }

V3d Random::direction() {
  const double height = between(-1, 1);
  const double angle = between(0, 2 * std::numbers::pi);
  const double radius = std::sqrt(1 - height * height);
  return {radius * std::cos(angle), radius * std::sin(angle), height};
}

struct EmbreeOracle::Embree {
  explicit Embree(const Scene& scene)
      : primitives(scene), device(rtcNewDevice(nullptr)), rtc_scene(rtcNewScene(device)) {
    // High quality would split triangles in space; here each triangle is in one leaf only.
    rtcSetSceneBuildQuality(rtc_scene, RTC_BUILD_QUALITY_MEDIUM);
    rtcSetSceneFlags(rtc_scene, static_cast<RTCSceneFlags>(RTC_SCENE_FLAG_ROBUST |
                                                           RTC_SCENE_FLAG_CONTEXT_FILTER_FUNCTION));
    if (!primitives.triangles.empty())
      attach(soup_geometry(device, primitives.triangles), kTriangles);
    if (!primitives.curves.empty()) attach(strand_geometry(device, primitives.curves), kStrands);
    rtcCommitScene(rtc_scene);
    if (rtcGetDeviceError(device) != RTC_ERROR_NONE) throw std::runtime_error("Embree failed");
  }
  ~Embree() {
    rtcReleaseScene(rtc_scene);
    rtcReleaseDevice(device);
  }
  Embree(const Embree&) = delete;
  Embree& operator=(const Embree&) = delete;

  static constexpr unsigned kTriangles = 0, kStrands = 1;

  void attach(RTCGeometry geometry, unsigned number) {
    rtcAttachGeometryByID(rtc_scene, geometry, number);
    rtcReleaseGeometry(geometry);
  }

  Primitives primitives;
  RTCDevice device;
  RTCScene rtc_scene;

  /// The data of a query, for its filter. Embree passes on the pointer to `context`; that is the
  /// first member, so the pointer is also one to the Query.
  struct Query {
    RTCIntersectContext context;
    const Embree* embree;
    const Segment* segment;
    std::uint64_t key;
    double transmittance;
    std::vector<unsigned> intersected;
  };

  static Query& query_of(const RTCFilterFunctionNArguments* arguments) {
    return *reinterpret_cast<Query*>(arguments->context);
  }
  [[nodiscard]] unsigned primitive_of(const RTCFilterFunctionNArguments* arguments) const {
    const unsigned number = RTCHitN_primID(arguments->hit, arguments->N, 0);
    const bool strand = RTCHitN_geomID(arguments->hit, arguments->N, 0) == kStrands;
    return number + (strand ? static_cast<unsigned>(primitives.triangles.size()) : 0);
  }

  /// Whether the hit is an exit from a strand. Strands are closed, and only entries count.
  static bool leaves_strand(const RTCFilterFunctionNArguments* arguments) {
    RTCHitN* const hit = arguments->hit;
    RTCRayN* const ray = arguments->ray;
    if (RTCHitN_geomID(hit, 1, 0) != kStrands) return false;
    return RTCHitN_Ng_x(hit, 1, 0) * RTCRayN_dir_x(ray, 1, 0) +
               RTCHitN_Ng_y(hit, 1, 0) * RTCRayN_dir_y(ray, 1, 0) +
               RTCHitN_Ng_z(hit, 1, 0) * RTCRayN_dir_z(ray, 1, 0) >=
           0;
  }

  /// Multiplies the transmittance. Embree may report a hit twice, so a list of primitives is kept.
  static void composite(const RTCFilterFunctionNArguments* arguments) {
    Query& query = query_of(arguments);
    arguments->valid[0] = 0;
    if (leaves_strand(arguments)) return;
    const unsigned primitive = query.embree->primitive_of(arguments);
    if (std::find(query.intersected.begin(), query.intersected.end(), primitive) ==
        query.intersected.end()) {
      query.intersected.push_back(primitive);
      query.transmittance *= 1 - query.embree->primitives.opacity(primitive, *query.segment);
    }
    if (query.transmittance < kBlack) arguments->valid[0] = -1;
  }

  /// Accepts a hit with the probability of its opacity. The random number is a hash of the
  /// primitive, so a triangle that Embree reports twice gets the same answer.
  static void stop_by_chance(const RTCFilterFunctionNArguments* arguments) {
    const Query& query = query_of(arguments);
    const unsigned primitive = query.embree->primitive_of(arguments);
    if (leaves_strand(arguments)) {
      arguments->valid[0] = 0;
      return;
    }
    Random chance(mix(query.key + 0x632be59bd9b4e019u * (primitive + 1)));
    if (chance.real() >= query.embree->primitives.opacity(primitive, *query.segment))
      arguments->valid[0] = 0;
  }

  Query query(const Segment& segment, RTCFilterFunctionN filter) const {
    Query query{{}, this, &segment, 0, 1.0, {}};
    rtcInitIntersectContext(&query.context);
    query.context.filter = filter;
    return query;
  }
};

EmbreeOracle::EmbreeOracle(const Scene& scene) : embree_(std::make_unique<Embree>(scene)) {}
EmbreeOracle::~EmbreeOracle() = default;

double EmbreeOracle::transmittance(const Segment& segment) const {
  Embree::Query query = embree_->query(segment, &Embree::composite);
  RTCRay ray = embree_ray(segment);
  rtcOccluded1(embree_->rtc_scene, &query.context, &ray);
  return query.transmittance < kBlack ? 0 : query.transmittance;
}

std::optional<Hit> EmbreeOracle::first_hit(const Segment& segment, std::uint64_t key) const {
  Embree::Query query = embree_->query(segment, &Embree::stop_by_chance);
  query.key = key;
  RTCRayHit found{embree_ray(segment), {}};
  found.hit.geomID = RTC_INVALID_GEOMETRY_ID;
  rtcIntersect1(embree_->rtc_scene, &query.context, &found);
  if (found.hit.geomID == RTC_INVALID_GEOMETRY_ID) return std::nullopt;
  if (found.hit.geomID == Embree::kStrands) {
    const V3d normal(found.hit.Ng_x, found.hit.Ng_y, found.hit.Ng_z);
    const V3d position = V3d(segment.origin) + V3d(segment.direction) * double{found.ray.tfar};
    return Hit{position, normal.normalized(), normal.normalized(), position};
  }
  const Triangle& triangle = embree_->primitives.triangles[found.hit.primID];
  const V3d direction(segment.direction);
  const V3d corner[3] = {V3d(triangle.corner[0]), V3d(triangle.corner[1]), V3d(triangle.corner[2])};
  const Weights weights = weights_at(triangle, V3d(segment.origin), direction);
  const V3d position = interpolate(weights, corner);
  V3d facet = normal_of(triangle).normalized();
  if (facet.dot(direction) > 0) facet = -facet;
  return shaded(triangle, weights, direction, {position, facet, facet, position});
}

}  // namespace dapple::oracle

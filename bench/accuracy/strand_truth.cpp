// Embree finds the segments whose boxes a ray hits; the functions here intersect them.
#include "accuracy/strand_truth.hpp"

#include <embree3/rtcore.h>

#include <cmath>
#include <limits>

#include "oracle/embree_ray.hpp"

namespace dapple::bench {
namespace {

/// The root (-b - sqrt(b^2 - a c)) / a of a t^2 + 2 b t + c; NaN if there is none.
double first_root(double a, double b, double c) { return (-b - std::sqrt(b * b - a * c)) / a; }

/// Whether `p` lies between the planes at the ends of the segment.
bool is_between(const StrandSegment& s, const V3d& p) {
  return (p - V3d(s.point[0])).dot(V3d(s.plane[0])) >= 0 &&
         (p - V3d(s.point[1])).dot(V3d(s.plane[1])) < 0;
}

bool enters_side(const StrandSegment& s, const V3d& origin, const V3d& direction, double t_max) {
  const V3d axis = V3d(s.point[1]) - V3d(s.point[0]), offset = origin - V3d(s.point[0]);
  const double square = axis.dot(axis), taper = double{s.radius[1]} - s.radius[0];
  const double along = offset.dot(axis) / square, slope = direction.dot(axis) / square;
  const V3d across = offset - axis * along, slant = direction - axis * slope;
  const double radius = s.radius[0] + taper * along, growth = taper * slope;
  const double t =
      first_root(slant.dot(slant) - growth * growth, across.dot(slant) - radius * growth,
                 across.dot(across) - radius * radius);
  return t > 0 && t < t_max && radius + growth * t > 0 && is_between(s, origin + direction * t);
}

bool enters_cap(const StrandSegment& s, int end, const V3d& origin, const V3d& direction,
                double t_max) {
  const V3d middle(s.point[end]), offset = origin - middle;
  const double radius = s.radius[end];
  const double t = first_root(direction.dot(direction), offset.dot(direction),
                              offset.dot(offset) - radius * radius);
  const double height = (offset + direction * t).dot(V3d(s.plane[end]));
  return t > 0 && t < t_max && (end ? height >= 0 : height < 0);
}

bool enters(const StrandSegment& s, const V3d& origin, const V3d& direction, double t_max) {
  if (enters_side(s, origin, direction, t_max)) return true;
  for (int end = 0; end < 2; ++end) {
    if (s.cap[end] && enters_cap(s, end, origin, direction, t_max)) return true;
  }
  return false;
}

/// Embree passes the pointer to `context` to the callback. So it must be the first member.
struct Query {
  RTCIntersectContext context;
  const oracle::Segment* ray;
  double transmittance;
};

}  // namespace

struct StrandTruth::Embree {
  explicit Embree(std::vector<StrandSegment> all)
      : segments(std::move(all)), device(rtcNewDevice(nullptr)), scene(rtcNewScene(device)) {
    const RTCGeometry geometry = rtcNewGeometry(device, RTC_GEOMETRY_TYPE_USER);
    rtcSetGeometryUserPrimitiveCount(geometry, static_cast<unsigned>(segments.size()));
    rtcSetGeometryUserData(geometry, this);
    rtcSetGeometryBoundsFunction(geometry, &bound, nullptr);
    rtcSetGeometryOccludedFunction(geometry, &intersect);
    rtcCommitGeometry(geometry);
    rtcAttachGeometry(scene, geometry);
    rtcReleaseGeometry(geometry);
    rtcCommitScene(scene);
  }
  ~Embree() {
    rtcReleaseScene(scene);
    rtcReleaseDevice(device);
  }
  Embree(const Embree&) = delete;
  Embree& operator=(const Embree&) = delete;

  static const StrandSegment& segment(void* data, unsigned number) {
    return static_cast<const Embree*>(data)->segments[number];
  }

  static void bound(const RTCBoundsFunctionArguments* arguments) {
    const Box3f box = bounds(segment(arguments->geometryUserPtr, arguments->primID));
    *arguments->bounds_o = {box.min.x, box.min.y, box.min.z, 0, box.max.x, box.max.y, box.max.z, 0};
  }

  static void intersect(const RTCOccludedFunctionNArguments* arguments) {
    if (!arguments->valid[0]) return;
    Query& query = *reinterpret_cast<Query*>(arguments->context);
    const StrandSegment& hit = segment(arguments->geometryUserPtr, arguments->primID);
    if (enters(hit, V3d(query.ray->origin), V3d(query.ray->direction), query.ray->t_max)) {
      query.transmittance *= 1.0 - hit.opacity;
    }
  }

  std::vector<StrandSegment> segments;
  RTCDevice device;
  RTCScene scene;
};

StrandTruth::StrandTruth(std::vector<StrandSegment> segments)
    : embree_(std::make_unique<Embree>(std::move(segments))) {}
StrandTruth::~StrandTruth() = default;

double StrandTruth::transmittance(const oracle::Segment& ray) const {
  Query query{{}, &ray, 1.0};
  rtcInitIntersectContext(&query.context);
  RTCRay embree_ray = oracle::embree_ray(ray);
  rtcOccluded1(embree_->scene, &query.context, &embree_ray);
  return query.transmittance;
}

}  // namespace dapple::bench

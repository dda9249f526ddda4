#include "rivals/embree/embree_scene.hpp"

#include <fmt/format.h>

#include <chrono>

#include "dapple/error.hpp"
#include "rivals/embree/alpha_filter.hpp"

namespace dapple::bench {
namespace {

/// Embree calls this at every change of its memory use, from any thread.
bool count_bytes(void* counter, ssize_t bytes, bool) {
  *static_cast<std::atomic<std::int64_t>*>(counter) += bytes;
  return true;
}

void add_filters(RTCGeometry geometry, const EmbreeMesh& mesh) {
  rtcSetGeometryUserData(geometry, const_cast<OpacityTable*>(&mesh.opacity));
  rtcSetGeometryOccludedFilterFunction(geometry, filter_occluded);
  rtcSetGeometryIntersectFilterFunction(geometry, filter_intersected);
}

RTCGeometry curve_geometry(RTCDevice device, const EmbreeMesh& mesh, unsigned number) {
  const RTCGeometry geometry = rtcNewGeometry(device, RTC_GEOMETRY_TYPE_ROUND_LINEAR_CURVE);
  rtcSetSharedGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT4,
                             mesh.curve_vertices.data(), 0, 4 * sizeof(float),
                             mesh.curve_vertices.size() / 4);
  const std::vector<unsigned>& first = mesh.curves[number];
  rtcSetSharedGeometryBuffer(geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT, first.data(), 0,
                             sizeof(unsigned), first.size());
  if (number == kTranslucentGeometry) add_filters(geometry, mesh);
  rtcCommitGeometry(geometry);
  return geometry;
}

RTCGeometry triangle_geometry(RTCDevice device, const EmbreeMesh& mesh, unsigned number) {
  const RTCGeometry geometry = rtcNewGeometry(device, RTC_GEOMETRY_TYPE_TRIANGLE);
  rtcSetSharedGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3,
                             mesh.positions.data(), 0, sizeof(V3f), mesh.positions.size() - 1);
  const std::vector<unsigned>& indices = mesh.triangles[number];
  rtcSetSharedGeometryBuffer(geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3, indices.data(),
                             0, 3 * sizeof(unsigned), indices.size() / 3);
  if (number == kTranslucentGeometry) add_filters(geometry, mesh);
  rtcCommitGeometry(geometry);
  return geometry;
}

}  // namespace

EmbreeScene::EmbreeScene(const EmbreeGeometry& geometry, RTCBuildQuality quality)
    : geometry_(geometry), quality_(quality), device_(rtcNewDevice(nullptr)) {
  rtcSetDeviceMemoryMonitorFunction(device_, count_bytes, &held_bytes_);
  const auto start = std::chrono::steady_clock::now();
  if (geometry_.flat) {
    top_ = new_scene();
    attach_meshes(top_, geometry_.meshes[0]);
  } else {
    for (const EmbreeMesh& mesh : geometry_.meshes) {
      objects_.push_back(new_scene());
      attach_meshes(objects_.back(), mesh);
      rtcCommitScene(objects_.back());
    }
    top_ = new_scene();
    attach_placements();
  }
  rtcCommitScene(top_);
  build_seconds_ = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  bytes_ = static_cast<std::size_t>(held_bytes_.load());
  check();
}

EmbreeScene::~EmbreeScene() {
  rtcReleaseScene(top_);
  for (const RTCScene object : objects_) rtcReleaseScene(object);
  rtcReleaseDevice(device_);
}

RTCScene EmbreeScene::new_scene() {
  const RTCScene scene = rtcNewScene(device_);
  // Neither robust nor compact, which is Embree's fastest mode.
  rtcSetSceneBuildQuality(scene, quality_);
  return scene;
}

void EmbreeScene::attach_meshes(RTCScene scene, const EmbreeMesh& mesh) {
  for (const unsigned number : {kOpaqueGeometry, kTranslucentGeometry}) {
    if (mesh.triangles[number].empty() && mesh.curves[number].empty()) continue;
    const RTCGeometry geometry = mesh.has_strands() ? curve_geometry(device_, mesh, number)
                                                    : triangle_geometry(device_, mesh, number);
    rtcAttachGeometryByID(scene, geometry, number);
    rtcReleaseGeometry(geometry);
  }
}

void EmbreeScene::attach_placements() {
  for (const EmbreePlacement& placement : geometry_.placements) {
    const RTCGeometry instance = rtcNewGeometry(device_, RTC_GEOMETRY_TYPE_INSTANCE);
    rtcSetGeometryInstancedScene(instance, objects_[placement.mesh]);
    // Imath multiplies row vectors by matrices, Embree column vectors: rows become columns.
    float columns[12];
    for (int c = 0; c < 4; ++c)
      for (int axis = 0; axis < 3; ++axis) columns[3 * c + axis] = placement.to_world[c][axis];
    rtcSetGeometryTransform(instance, 0, RTC_FORMAT_FLOAT3X4_COLUMN_MAJOR, columns);
    rtcCommitGeometry(instance);
    rtcAttachGeometry(top_, instance);
    rtcReleaseGeometry(instance);
  }
}

void EmbreeScene::check() const {
  const RTCError error = rtcGetDeviceError(device_);
  if (error == RTC_ERROR_NONE) return;
  throw Error(ErrorKind::failed,
              fmt::format("Embree could not build the scene (error {}); {} bytes were held: try "
                          "a smaller scene",
                          static_cast<int>(error), bytes_));
}

}  // namespace dapple::bench

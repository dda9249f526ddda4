// The buffers of a scene in device memory, which all tracing kernels use. In: a scene and its BVH,
// by upload() and update(). Out: buffers.
#pragma once

#include "dapple/shared/corner_normals.h"
#include "dapple/shared/light_record.h"
#include "dapple/shared/pass_params.h"
#include "device/context.hpp"
#include "device/upload/color_upload.hpp"

namespace dapple {

struct DeviceBuffers {
  explicit DeviceBuffers(const Device& d) : device(d) {}
  /// Waits for kernels that still run, as after an error, because they may read the values below.
  ~DeviceBuffers() { device.context().wait(); }
  DeviceBuffers(const DeviceBuffers&) = delete;
  DeviceBuffers& operator=(const DeviceBuffers&) = delete;
  Device device;
  Buffer nodes, blocks, segments, textured, materials, texels, instances;
  Buffer normals;  ///< of a scene that is uploaded for shading; empty: all triangles are flat
  Buffer color_words, color_materials, color_texels;  ///< of a scene uploaded with colours
  Buffer lights, emitters, environments;
  UploadOptions uploaded;
  SceneParams params{};
  Box3f bounds;  ///< world space
  // The buffers use these values themselves when device and host share memory.
  ConstArray<BvhNode> node_values;
  ConstArray<TriangleBlock> block_values;
  ConstArray<SegmentBlock> segment_values;
  ConstArray<TexturedTriangle> textured_values;
  ConstArray<InstanceRecord> instance_records;
  std::vector<MaterialRecord> material_records;
  std::vector<uchar> texel_data;
  std::vector<CornerNormals> corner_normals;
  SurfaceColors colors;
  Checksum color_key{};
  std::vector<LightRecord> light_records;
  std::vector<bool> dark_lights;  ///< by light: its radiance is 0
  std::vector<EmitterTriangle> emitter_triangles;
  std::vector<float> environment_data;
};

/// Throws Error usage if no scene was uploaded, or if an Error of update() left none.
void check_uploaded(const DeviceScene& scene);

}  // namespace dapple

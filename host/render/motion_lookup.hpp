// Motion vectors: how far the points that a picture shows move in the image until the next frame.
// In: two scenes after merge_single_instances(), with their views, and the BVH of the first. Out:
// for a hit of a camera ray, pixels.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "camera/view.hpp"
#include "dapple/bvh.hpp"
#include "dapple/scene.hpp"
#include "render/frame_match.hpp"

namespace dapple {

/// A scene as one frame shows it.
struct FrameScene {
  Scene scene;
  View view;
};

class MotionLookup {
 public:
  /// `now` must live as long as this. Both scenes must have been through name_objects().
  MotionLookup(const Scene& now, const View& view, const SceneBvh& bvh, FrameScene next);

  /// The motion of a hit at `position` (world space), pixels to the right and up. `instance` and
  /// `primitive` are those that the camera pass kept. (0, 0) for points behind the next camera.
  /// What is not in the next frame counts as standing still.
  [[nodiscard]] Imath::V2d at(std::uint32_t instance, std::uint32_t primitive,
                              const V3f& position) const;

 private:
  /// A lane of a block: the part that it is in, and the primitive of that part's mesh.
  struct PartPrimitive {
    std::uint32_t part = 0, primitive = 0;
  };
  struct Movement {
    Imath::M44d now_to_object, next_to_world;
    bool still = false;     ///< the instance does not move
    bool is_there = false;  ///< in the next frame, too
  };

  [[nodiscard]] V3d shift_in_object(const PartPrimitive& of, const V3d& at_object) const;

  const Scene& now_;
  FrameScene next_;
  FrameMatch match_;
  std::vector<PartPrimitive> triangles_, segments_;  ///< by lane
  std::vector<Movement> movements_;                  ///< by InstanceRecord
  Projection project_now_, project_next_;
  bool camera_stands_;
};

}  // namespace dapple

// A ray of the oracle in Embree's form. In: a Segment. Out: an RTCRay.
#pragma once

#include <embree3/rtcore.h>

#include "oracle/embree_oracle.hpp"

namespace dapple::oracle {

inline RTCRay embree_ray(const Segment& segment) {
  RTCRay ray{};
  ray.org_x = segment.origin.x;
  ray.org_y = segment.origin.y;
  ray.org_z = segment.origin.z;
  ray.dir_x = segment.direction.x;
  ray.dir_y = segment.direction.y;
  ray.dir_z = segment.direction.z;
  ray.tnear = 0;
  ray.tfar = segment.t_max;
  ray.mask = ~0u;
  return ray;
}

}  // namespace dapple::oracle

/* Reports the layout of every shared struct as the device's compiler sees it, in the order of
   layout_members.h: the size of each struct, and offset and size of each member. */
#include "dapple/shared/bvh_node.h"
#include "dapple/shared/corner_normals.h"
#include "dapple/shared/geometry.h"
#include "layout_members.h"
#include "dapple/shared/light_record.h"
#include "dapple/shared/pass_params.h"
#include "dapple/shared/ray.h"
#include "dapple/shared/surface_color.h"

#define DAPPLE_REPORT_STRUCT(Type) \
  report[next++] = (uint)sizeof(Type);
#define DAPPLE_REPORT_MEMBER(Type, member)                          \
  {                                                                 \
    Type value;                                                     \
    report[next++] = (uint)((uchar*)&value.member - (uchar*)&value); \
    report[next++] = (uint)sizeof(value.member);                    \
  }

__kernel void layout(__global uint* report) {
  if (get_global_id(0) != 0) return;
  uint next = 0;
  DAPPLE_LAYOUT(DAPPLE_REPORT_STRUCT, DAPPLE_REPORT_MEMBER)
}

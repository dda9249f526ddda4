/* The camera pass's traversal: the nearest surface that the ray does not slip through.
   A surface of opacity a is met with probability a, decided by hashing the ray's key with
   primitive and instance, so that stacked layers are independent. */
#include "pass_params.h"
#include "prefetch.clh"
#include "random.clh"
#include "triangle_block.clh"

typedef struct Nearest {
  float t, u, v;
  uint block, lane;
  uint instance;  /* 0xffffffff: world space */
  uint visits, tests;
} Nearest;

#define DAPPLE_INSTANCE_ENTRY 0x80000000u
#define DAPPLE_WORLD 0xffffffffu

inline bool is_met(float opacity, uint key, uint block, uint lane, uint instance) {
  if (opacity >= 1.0f) return true;
  const uint bits = hash_pair(hash_pair(block * 8u + lane, instance), key);
  return unit_float(bits) < opacity;
}

inline void closest_in_block(Scene scene, Span span, uint block_index, uint lanes, uint key,
                             uint instance, Nearest* nearest) {
  __global const TriangleBlock* block = scene.blocks + block_index;
  const BlockHits hits = intersect_block(block, span, lanes);
  if (!any_lane(hits.hit)) return;
  Lanes t, u, v, opacity;
  t.v = hits.t;
  u.v = hits.u;
  v.v = hits.v;
  opacity.v = block_opacity(scene, block, hits);
  for (ulong left = lane_bytes(hits.hit); left; left &= left - 1UL) {
    const uint lane = first_lane(left);
    if (t.f[lane] >= nearest->t || !is_met(opacity.f[lane], key, block_index, lane, instance)) continue;
    nearest->t = t.f[lane];
    nearest->u = u.f[lane];
    nearest->v = v.f[lane];
    nearest->block = block_index;
    nearest->lane = lane;
    nearest->instance = instance;
  }
}

/* Pushes `entry` among those from `base` up, farthest at the bottom. */
inline uint push_by_distance(uint* stack, float* enter, uint base, uint top, uint entry, float t) {
  uint at = top;
  for (; at > base && enter[at - 1u] < t; --at) {
    stack[at] = stack[at - 1u];
    enter[at] = enter[at - 1u];
  }
  stack[at] = entry;
  enter[at] = t;
  return top + 1u;
}

inline Nearest find_closest(Scene scene, SceneParams where, Ray ray) {
  Span world = make_span((float3)(ray.origin[0], ray.origin[1], ray.origin[2]),
                         (float3)(ray.direction[0], ray.direction[1], ray.direction[2]), ray.t_max);
  Span span = world;
  uint stack[DAPPLE_STACK_SIZE];
  float enter[DAPPLE_STACK_SIZE];
  uint top = 0, object_base = 0, instance = DAPPLE_WORLD;
  bool in_top = where.has_top != 0u;
  Nearest nearest = {ray.t_max, 0.0f, 0.0f, 0u, 0u, DAPPLE_WORLD, 0u, 0u};
  stack[top] = where.root;
  enter[top++] = 0.0f;
  while (top) {
    if (object_base && top == object_base) {
      span = world;
      object_base = 0;
      in_top = true;
    }
    const uint entry = stack[--top];
    if (enter[top] > nearest.t) continue;
    if (entry & DAPPLE_INSTANCE_ENTRY) {
      instance = entry & ~DAPPLE_INSTANCE_ENTRY;
      __global const InstanceRecord* record = scene.instances + instance;
      span = make_span(transform_point(record->to_object, world.origin),
                       transform_vector(record->to_object, world.direction), nearest.t);
      object_base = top;
      in_top = false;
      stack[top] = record->root;
      enter[top++] = 0.0f;
      continue;
    }
    __global const BvhNode* node = scene.nodes + entry;
    ++nearest.visits;
    span.t_max = nearest.t;
    const BoxHits hits = intersect_boxes(node, span);
    Lanes distance;
    distance.v = hits.enter;
    ulong bits = 0;
    const uint base = top, inner_mask = node->inner_mask;
    for (ulong lanes = lane_bytes(hits.hit); lanes; lanes &= lanes - 1UL) {
      const uint slot = first_lane(lanes);
      uint next;
      if (inner_mask >> slot & 1u) {
        next = node->child_base + popcount(inner_mask & ((1u << slot) - 1u));
        prefetch_node(scene.nodes + next);
      } else if (in_top) {
        next = DAPPLE_INSTANCE_ENTRY | (node->prim_base + bvh_leaf_end(node->leaf_end, slot) - 1u);
      } else {
        bits |= leaf_bits(node, slot);
        continue;
      }
      top = push_by_distance(stack, enter, base, top, next, distance.f[slot]);
    }
    nearest.tests += (uint)popcount(bits);
    for (uint block = node->prim_base; bits; bits >>= 8, ++block) {
      const uint lanes = (uint)(bits & 255UL);
      if (lanes) closest_in_block(scene, span, block, lanes, ray.key, instance, &nearest);
    }
  }
  return nearest;
}

/* How far rays must start from a point made as vertex + u edge1 + v edge2 and carried
   through the instance's matrix: 16 roundings of the largest term (after Waechter and
   Binder, "A Fast and Robust Method for Avoiding Self-Intersection", 2019). */
inline float rounding_offset(float3 vertex, float3 edge1, float3 edge2) {
  const float3 terms = fabs(vertex) + fabs(edge1) + fabs(edge2);
  return fmax(terms.x, fmax(terms.y, terms.z)) * 9.5e-7f;
}

inline void store_point(Scene scene, Nearest hit, Ray ray, __global SurfacePoint* point) {
  __global const TriangleBlock* block = scene.blocks + hit.block;
  const uint lane = hit.lane;
  const float3 vertex = (float3)(block->vertex[0][lane], block->vertex[1][lane], block->vertex[2][lane]);
  const float3 edge1 = (float3)(block->edge1[0][lane], block->edge1[1][lane], block->edge1[2][lane]);
  const float3 edge2 = (float3)(block->edge2[0][lane], block->edge2[1][lane], block->edge2[2][lane]);
  float3 position = vertex + hit.u * edge1 + hit.v * edge2;
  float3 normal = cross(edge1, edge2);
  float offset = rounding_offset(vertex, edge1, edge2);
  if (hit.instance != DAPPLE_WORLD) {
    __global const InstanceRecord* instance = scene.instances + hit.instance;
    position = transform_point(instance->to_world, position);
    normal = transform_normal(instance->to_object, normal);
    __global const float* m = instance->to_world;
    const float3 object_terms = fabs(vertex) + fabs(edge1) + fabs(edge2);
    const float3 world_terms = (float3)(
        fabs(m[0]) * object_terms.x + fabs(m[1]) * object_terms.y + fabs(m[2]) * object_terms.z + fabs(m[3]),
        fabs(m[4]) * object_terms.x + fabs(m[5]) * object_terms.y + fabs(m[6]) * object_terms.z + fabs(m[7]),
        fabs(m[8]) * object_terms.x + fabs(m[9]) * object_terms.y + fabs(m[10]) * object_terms.z + fabs(m[11]));
    offset = rounding_offset(world_terms, (float3)(0.0f), (float3)(0.0f));
  }
  normal = normalize(normal);
  const float3 direction = (float3)(ray.direction[0], ray.direction[1], ray.direction[2]);
  if (dot(normal, direction) > 0.0f) normal = -normal;
  store3(point->position, position);
  store3(point->normal, normal);
  point->t = hit.t;
  point->offset = offset;
  point->area = ray.first_area + ray.solid_angle * hit.t * hit.t;
}

__kernel void closest_hit(__global const BvhNode* nodes, __global const TriangleBlock* blocks,
                          __global const TexturedTriangle* textured,
                          __global const TextureRecord* textures, __global const uchar* texels,
                          __global const InstanceRecord* instances, __global const Ray* rays,
                          __global SurfacePoint* points, OcclusionParams params) {
  const uint item = get_global_id(0);
  if (item >= params.ray_count) return;
  const Scene scene = {nodes, blocks, textured, textures, texels, instances};
  const Ray ray = rays[item];
  const Nearest nearest = find_closest(scene, params.scene, ray);
  __global SurfacePoint* point = points + item;
  point->visits = min(nearest.visits, 65535u) | min(nearest.tests, 65535u) << 16;
  if (nearest.t < ray.t_max) {
    store_point(scene, nearest, ray, point);
  } else {
    point->t = -1.0f;
  }
}

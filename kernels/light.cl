/* The light pass: rays from every active point to one light, weighted so that their mean
   transmittance times weight is the irradiance of that light at radiance 1. */
#include "direction.clh"
#include "dome.clh"
#include "light_record.h"
#include "pass_params.h"
#include "point_rays.clh"

typedef struct LightSample {
  float3 direction;   /* towards the light, unit */
  float distance;
  float solid_angle;  /* 1 / pdf; also the weight but for the receiver's cosine and radiance */
  float radiance;     /* dome: the luminance from there; else 1 */
} LightSample;

/* A point of a flat emitter, uniform over `area`. */
inline LightSample towards(float3 from, float3 to, float3 light_normal, float area, bool two_sided) {
  LightSample sample;
  sample.radiance = 1.0f;
  const float3 way = to - from;
  const float square = fmax(dot(way, way), 1e-20f);
  sample.distance = sqrt(square);
  sample.direction = way / sample.distance;
  const float cosine = -dot(sample.direction, light_normal);
  sample.solid_angle = area * fmax(two_sided ? fabs(cosine) : cosine, 0.0f) / square;
  return sample;
}

inline LightSample sample_rect(__global const LightRecord* light, float3 from, float2 u) {
  const float3 to = load3(light->position) + (u.x - 0.5f) * load3(light->edge_u) +
                    (u.y - 0.5f) * load3(light->edge_v);
  return towards(from, to, load3(light->direction), light->area, false);
}

/* Uniform in the cone that the sphere subtends; from inside, over all directions. */
inline LightSample sample_sphere(__global const LightRecord* light, float3 from, float2 u) {
  LightSample sample;
  sample.radiance = 1.0f;
  const float3 way = load3(light->position) - from;
  const float distance = length(way);
  const float3 axis = distance > 0.0f ? way / distance : (float3)(0.0f, 1.0f, 0.0f);
  const float sine = light->radius / fmax(distance, light->radius);
  const bool inside = distance <= light->radius;
  const float one_minus_cos = inside ? 2.0f : sine * sine / (1.0f + sqrt(fmax(0.0f, 1.0f - sine * sine)));
  sample.direction = sample_cone(axis, one_minus_cos, u);
  sample.solid_angle = 2.0f * M_PI_F * one_minus_cos;
  const float along = dot(sample.direction, way);
  const float inside_square = light->radius * light->radius - (distance * distance - along * along);
  const float half_chord = sqrt(fmax(0.0f, inside_square));
  sample.distance = inside ? along + half_chord : along - half_chord;
  if (light->cos_outer > -1.0f) {
    /* KHR_lights_punctual's cone, seen from the light. */
    const float cosine = -dot(axis, load3(light->direction));
    const float edge = clamp((cosine - light->cos_outer) / fmax(0.001f, light->cos_inner - light->cos_outer),
                             0.0f, 1.0f);
    sample.solid_angle *= edge * edge;
  }
  return sample;
}

inline LightSample sample_sun(__global const LightRecord* light, float2 u) {
  LightSample sample;
  sample.radiance = 1.0f;
  sample.direction = sample_cone(-load3(light->direction), light->one_minus_cos, u);
  sample.solid_angle = 2.0f * M_PI_F * light->one_minus_cos;
  sample.distance = INFINITY;
  return sample;
}

inline LightSample sample_mesh(__global const LightRecord* light,
                               __global const EmitterTriangle* emitters, float3 from, float2 u) {
  uint low = 0, high = light->triangle_count - 1u;
  __global const EmitterTriangle* first = emitters + light->first_triangle;
  while (low < high) {
    const uint middle = (low + high) / 2u;
    if (first[middle].cumulative > u.x) {
      high = middle;
    } else {
      low = middle + 1u;
    }
  }
  const float before = low ? first[low - 1u].cumulative : 0.0f;
  const float share = first[low].cumulative - before;
  const float x = clamp((u.x - before) / fmax(share, 1e-30f), 0.0f, 1.0f);
  const float root = sqrt(x);
  const float3 edge1 = load3(first[low].edge1), edge2 = load3(first[low].edge2);
  const float3 to = load3(first[low].vertex) + (1.0f - root) * edge1 + u.y * root * edge2;
  return towards(from, to, normalize(cross(edge1, edge2)), light->area, light->two_sided != 0u);
}

inline LightSample sample_around(__global const LightRecord* light,
                                 __global const float* environments, float3 normal, float2 u) {
  const Dome dome = dome_of(light, environments);
  LightSample sample;
  sample.direction = sample_dome(&dome, normal, u, &sample.solid_angle, &sample.radiance);
  sample.distance = INFINITY;
  return sample;
}

inline LightSample sample_source(__global const LightRecord* light,
                                 __global const EmitterTriangle* emitters, float3 from, float2 u) {
  switch (light->kind) {
    case DAPPLE_LIGHT_RECT: return sample_rect(light, from, u);
    case DAPPLE_LIGHT_SPHERE: return sample_sphere(light, from, u);
    case DAPPLE_LIGHT_SUN: return sample_sun(light, u);
    default: return sample_mesh(light, emitters, from, u);
  }
}

inline void store_ray(__global const SurfacePoint* point, __global const LightRecord* light,
                      __global const EmitterTriangle* emitters,
                      __global const float* environments, float2 u, uint key, LightParams params,
                      __global Ray* ray) {
  const float3 normal = load3(point->normal);
  const float3 origin = load3(point->position) + normal * point->offset;
  const LightSample sample = light->kind == DAPPLE_LIGHT_DOME
                                 ? sample_around(light, environments, normal, u)
                                 : sample_source(light, emitters, origin, u);
  const float weight =
      sample.solid_angle * fmax(dot(normal, sample.direction), 0.0f) * sample.radiance;
  store3(ray->origin, origin);
  store3(ray->direction, sample.direction);
  /* A ray that can bring nothing is not traced: it ends before it starts. */
  ray->t_max = weight > 0.0f ? sample.distance : -1.0f;
  ray->solid_angle = fmin(2.0f * M_PI_F, sample.solid_angle * params.inverse_count);
  ray->first_area = point->area;
  ray->light = light->id;
  ray->weight = weight;
  ray->key = key;
}

__kernel void light_rays(__global const SurfacePoint* points, __global const uint* active_list,
                         __global const LightRecord* lights,
                         __global const EmitterTriangle* emitters,
                         __global const float* environments, __global Ray* queue,
                         LightParams params) {
  const uint first = get_global_id(0) * DAPPLE_RAY_LANES;
  const uint end = params.point_count * params.rays;
  if (first >= end) return;
  PointRays rays;
  choose_rays(points, active_list, first, end, params.rays, DAPPLE_PAIR_LIGHT + params.light,
              params.seed, &rays);
  for (uint i = 0; i < rays.count; ++i) {
    store_ray(points + rays.point[i], lights + params.light, emitters, environments,
              (float2)(rays.u[i], rays.v[i]), rays.key[i], params, queue + first + i);
  }
}

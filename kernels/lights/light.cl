/* The light pass: generates rays from every active point to one light. In: surface points and the light.
   Out: rays whose weights make the mean of weight times transmittance the irradiance at radiance 1. */
#include "sampling/direction.clh"
#include "lights/dome_samples.clh"
#include "dapple/shared/light_record.h"
#include "dapple/shared/pass_params.h"
#include "occlusion/point_rays.clh"

/* Always inlined, since a sample would be returned through memory. */
typedef struct LightSample {
  float3 direction;   /* towards the light, unit */
  float distance;
  float solid_angle;  /* 1 / pdf; the weight without cosine */
} LightSample;

/* Sample of a flat emitter, uniform over `area`. */
DAPPLE_INLINE LightSample towards(float3 from, float3 to, float3 light_normal, float area,
                                  bool two_sided) {
  LightSample sample;
  const float3 way = to - from;
  const float square = fmax(dot(way, way), 1e-20f);
  sample.distance = sqrt(square);
  sample.direction = way / sample.distance;
  const float cosine = -dot(sample.direction, light_normal);
  sample.solid_angle = area * fmax(two_sided ? fabs(cosine) : cosine, 0.0f) / square;
  return sample;
}

/* Sample of a sphere, uniform in the cone that it subtends; from inside, over all directions. */
DAPPLE_INLINE LightSample sample_sphere(__global const LightRecord* light, float3 from, float2 u) {
  LightSample sample;
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

DAPPLE_INLINE LightSample sample_mesh(__global const LightRecord* light,
                                      __global const EmitterTriangle* emitters, float3 from,
                                      float2 u) {
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

DAPPLE_INLINE LightSample sample_disk(__global const LightRecord* light, float3 from, float2 u) {
  float x, y;
  concentric_disk(u.x, u.y, &x, &y);
  const float3 to = load3(light->position) + x * load3(light->edge_u) + y * load3(light->edge_v);
  return towards(from, to, load3(light->direction), light->area, false);
}

/* Sample of a sphere, a disk or a mesh. */
DAPPLE_INLINE LightSample sample_source(__global const LightRecord* light,
                                        __global const EmitterTriangle* emitters, float3 from,
                                        float2 u) {
  switch (light->kind) {
    case DAPPLE_LIGHT_SPHERE: return sample_sphere(light, from, u);
    case DAPPLE_LIGHT_DISK: return sample_disk(light, from, u);
    default: return sample_mesh(light, emitters, from, u);
  }
}

/* As towards(), for sixteen points of the rectangle. */
inline void sample_rect(__global const LightRecord* light, const PointRays* rays,
                        LightSamples* samples) {
  const float16 u = rays->u.v - 0.5f, v = rays->v.v - 0.5f;
  float16 way[3], square = (float16)(1e-20f), against = (float16)(0.0f);
  DAPPLE_UNROLL for (uint axis = 0; axis < 3u; ++axis) {
    way[axis] = light->position[axis] + u * light->edge_u[axis] + v * light->edge_v[axis] -
                rays->origin[axis].v;
    square += way[axis] * way[axis];
  }
  const float16 distance = sqrt(square);
  DAPPLE_UNROLL for (uint axis = 0; axis < 3u; ++axis) {
    samples->direction[axis].v = way[axis] / distance;
    against -= samples->direction[axis].v * light->direction[axis];
  }
  samples->distance.v = distance;
  samples->solid_angle.v = light->area * at_least_0(against) / square;
}

/* Directions uniform in the cone that the sun subtends. */
inline void sample_sun(__global const LightRecord* light, const PointRays* rays,
                       LightSamples* samples) {
  const float16 height = rays->u.v * light->one_minus_cos;
  const float16 sine = sqrt(at_least_0(height * (2.0f - height)));
  const Floats16 turn = rays->v;
  Floats16 x, y;
  for (uint i = 0; i < DAPPLE_RAY_LANES; ++i)
    circle_point((uint)(turn.f[i] * 0x1p32f), x.f + i, y.f + i);
  const float3 axis = -load3(light->direction);
  float3 tangent, bitangent;
  make_frame(axis, &tangent, &bitangent);
  float16 direction[3];
  direction[0] = (x.v * tangent.x + y.v * bitangent.x) * sine + axis.x * (1.0f - height);
  direction[1] = (x.v * tangent.y + y.v * bitangent.y) * sine + axis.y * (1.0f - height);
  direction[2] = (x.v * tangent.z + y.v * bitangent.z) * sine + axis.z * (1.0f - height);
  const float16 length = sqrt(dot_16(direction, direction));
  DAPPLE_UNROLL for (uint i = 0; i < 3u; ++i) samples->direction[i].v = direction[i] / length;
  samples->solid_angle.v = (float16)(2.0f * M_PI_F * light->one_minus_cos);
  samples->distance.v = (float16)(INFINITY);
}

/* Samples of a light of which scalars are computed. */
inline void sample_each(__global const LightRecord* light,
                        __global const EmitterTriangle* emitters, const PointRays* rays,
                        LightSamples* samples) {
  for (uint i = 0; i < DAPPLE_RAY_LANES; ++i) {
    const float2 u = (float2)(rays->u.f[i], rays->v.f[i]);
    const float3 origin =
        (float3)(rays->origin[0].f[i], rays->origin[1].f[i], rays->origin[2].f[i]);
    const LightSample sample = sample_source(light, emitters, origin, u);
    samples->direction[0].f[i] = sample.direction.x;
    samples->direction[1].f[i] = sample.direction.y;
    samples->direction[2].f[i] = sample.direction.z;
    samples->distance.f[i] = sample.distance;
    samples->solid_angle.f[i] = sample.solid_angle;
  }
}

inline void sample_light(__global const LightRecord* light,
                         __global const EmitterTriangle* emitters,
                         __global const float* environments, const PointRays* rays,
                         LightSamples* samples) {
  samples->radiance.v = (float16)(1.0f);
  if (light->kind == DAPPLE_LIGHT_DOME) {
    const Dome dome = dome_of(light, environments);
    sample_dome(&dome, rays, samples);
  } else if (light->kind == DAPPLE_LIGHT_RECT) {
    sample_rect(light, rays, samples);
  } else if (light->kind == DAPPLE_LIGHT_SUN) {
    sample_sun(light, rays, samples);
  } else {
    sample_each(light, emitters, rays, samples);
  }
}

/* A ray without a contribution gets t_max < 0 and is not traced. */
inline void aim_light_rays(const PointRays* rays, const LightSamples* samples, float inverse_count,
                           RayDirections* directions) {
  float16 cosine = (float16)(0.0f);
  DAPPLE_UNROLL for (uint axis = 0; axis < 3u; ++axis) {
    directions->direction[axis].v = samples->direction[axis].v;
    cosine += rays->normal[axis].v * samples->direction[axis].v;
  }
  const float16 solid_angle = samples->solid_angle.v;
  directions->weight.v = solid_angle * at_least_0(cosine) * samples->radiance.v;
  directions->t_max.v = directions->weight.v > 0.0f ? samples->distance.v : (float16)(-1.0f);
  directions->solid_angle.v = min(solid_angle * inverse_count, 2.0f * M_PI_F);
}

__kernel void light_rays(__global const SurfacePoint* points, __global const uint* active_list,
                         __global const LightRecord* lights,
                         __global const EmitterTriangle* emitters,
                         __global const float* environments, __global Ray* queue,
                         LightParams params) {
  const uint first = get_global_id(0) * DAPPLE_RAY_LANES;
  const uint end = params.point_count * params.rays;
  if (first >= end) return;
  __global const LightRecord* light = lights + params.light;
  PointRays rays;
  LightSamples samples;
  RayDirections directions;
  load_points(points, active_list, first, end, params.rays, &rays);
  sample_unit_squares(DAPPLE_PAIR_LIGHT + params.light, params.seed, &rays);
  sample_light(light, emitters, environments, &rays, &samples);
  aim_light_rays(&rays, &samples, params.inverse_count, &directions);
  if (params.shaded) hide_below(&rays, &directions);
  store_rays(&rays, &directions, light->id, queue + first);
}

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

DAPPLE_INLINE LightSample sample_triangles(__global const LightRecord* light,
                                           __global const EmitterTriangle* emitters,
                                           float3 from, float2 u) {
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

/* As towards(), for sixteen points `a` and `b` edges away from the light's position. */
inline void sample_flat(__global const LightRecord* light, const PointRays* rays, float16 a,
                        float16 b, LightSamples* samples) {
  float16 way[3], square = (float16)(1e-20f), against = (float16)(0.0f);
  DAPPLE_UNROLL for (uint axis = 0; axis < 3u; ++axis) {
    way[axis] = light->position[axis] + a * light->edge_u[axis] + b * light->edge_v[axis] -
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

inline void sample_rect(__global const LightRecord* light, const PointRays* rays,
                        LightSamples* samples) {
  sample_flat(light, rays, rays->u.v - 0.5f, rays->v.v - 0.5f, samples);
}

inline void sample_disk(__global const LightRecord* light, const PointRays* rays,
                        LightSamples* samples) {
  const Floats16 u = rays->u, v = rays->v;
  Floats16 x, y;
  for (uint i = 0; i < DAPPLE_RAY_LANES; ++i) concentric_disk(u.f[i], v.f[i], x.f + i, y.f + i);
  sample_flat(light, rays, x.v, y.v, samples);
}

/* Directions about axes, uniform in cones whose 1 - cos are `one_minus_cos`. */
inline void sample_cones(const float16* axis, float16 one_minus_cos, const PointRays* rays,
                         LightSamples* samples) {
  const float16 height = rays->u.v * one_minus_cos;
  const float16 sine = sqrt(at_least_0(height * (2.0f - height)));
  const Floats16 turn = rays->v;
  Floats16 x, y;
  for (uint i = 0; i < DAPPLE_RAY_LANES; ++i)
    circle_point((uint)(turn.f[i] * 0x1p32f), x.f + i, y.f + i);
  float16 tangent[3], bitangent[3], direction[3];
  make_frames(axis[0], axis[1], axis[2], tangent, bitangent);
  DAPPLE_UNROLL for (uint i = 0; i < 3u; ++i)
    direction[i] = (x.v * tangent[i] + y.v * bitangent[i]) * sine + axis[i] * (1.0f - height);
  const float16 length = sqrt(dot_16(direction, direction));
  DAPPLE_UNROLL for (uint i = 0; i < 3u; ++i) samples->direction[i].v = direction[i] / length;
  samples->solid_angle.v = 2.0f * M_PI_F * one_minus_cos;
}

inline void sample_sun(__global const LightRecord* light, const PointRays* rays,
                       LightSamples* samples) {
  const float16 axis[3] = {(float16)(-light->direction[0]), (float16)(-light->direction[1]),
                           (float16)(-light->direction[2])};
  sample_cones(axis, (float16)(light->one_minus_cos), rays, samples);
  samples->distance.v = (float16)(INFINITY);
}

/* Uniform in the cones that the sphere subtends; from inside, over all directions. */
inline void sample_sphere(__global const LightRecord* light, const PointRays* rays,
                          LightSamples* samples) {
  float16 way[3], axis[3];
  DAPPLE_UNROLL for (uint i = 0; i < 3u; ++i) way[i] = light->position[i] - rays->origin[i].v;
  const float16 square = dot_16(way, way), distance = sqrt(square);
  const int16 away = distance > 0.0f;
  DAPPLE_UNROLL for (uint i = 0; i < 3u; ++i)
    axis[i] = away ? way[i] / distance : (float16)(i == 1u ? 1.0f : 0.0f);
  const float16 sine = light->radius / max(distance, light->radius);
  const int16 inside = distance <= light->radius;
  const float16 one_minus_cos =
      inside ? (float16)(2.0f) : sine * sine / (1.0f + sqrt(at_least_0(1.0f - sine * sine)));
  sample_cones(axis, one_minus_cos, rays, samples);
  const float16 along = samples->direction[0].v * way[0] + samples->direction[1].v * way[1] +
                        samples->direction[2].v * way[2];
  const float16 half_chord =
      sqrt(at_least_0(light->radius * light->radius - (square - along * along)));
  samples->distance.v = inside ? along + half_chord : along - half_chord;
  if (light->cos_outer > -1.0f) {
    /* KHR_lights_punctual's cone, seen from the light. */
    const float16 cosine = -(axis[0] * light->direction[0] + axis[1] * light->direction[1] +
                             axis[2] * light->direction[2]);
    const float16 edge = clamp(
        (cosine - light->cos_outer) / fmax(0.001f, light->cos_inner - light->cos_outer), 0.0f, 1.0f);
    samples->solid_angle.v *= edge * edge;
  }
}

/* Each sample searches for its triangle. */
inline void sample_mesh(__global const LightRecord* light,
                        __global const EmitterTriangle* emitters, const PointRays* rays,
                        LightSamples* samples) {
  for (uint i = 0; i < DAPPLE_RAY_LANES; ++i) {
    const float2 u = (float2)(rays->u.f[i], rays->v.f[i]);
    const float3 origin =
        (float3)(rays->origin[0].f[i], rays->origin[1].f[i], rays->origin[2].f[i]);
    const LightSample sample = sample_triangles(light, emitters, origin, u);
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
  } else if (light->kind == DAPPLE_LIGHT_SPHERE) {
    sample_sphere(light, rays, samples);
  } else if (light->kind == DAPPLE_LIGHT_DISK) {
    sample_disk(light, rays, samples);
  } else {
    sample_mesh(light, emitters, rays, samples);
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
  keep_clear_of_view(&rays, params.viewpoint, &directions);
  if (params.shaded) hide_below(&rays, &directions);
  store_rays(&rays, &directions, light->id, queue + first);
}

// Chooses how a queue of rays is traced: as single rays, of vector or of scalar kernels, in pixel
// packets or in point packets; and cuts queues into the batches and tickets of packet kernels.
#pragma once

#include "dapple/options.hpp"
#include "dapple/shared/pass_params.h"
#include "device/context.hpp"

namespace dapple {

/// What consecutive rays of a queue have in common.
enum class RayOrder {
  any,       ///< groups of rays_per_point rays share an origin
  by_pixel,  ///< they start on neighbouring pixels: CPUs trace them in pixel packets
};

/// The packets for a queue with `rays_per_point` rays from each origin: those that the device was
/// opened with, or the fastest. Independent of the number of rays, so that a crop reproduces the
/// full picture bit for bit (the kernels round differently).
Packets choose_packets(Estimator estimator, uint rays_per_point, RayOrder order,
                       const DeviceContext& context);

/// The packets of a picture's occlusion rays. `rays`: AO rays, or rays to one light, of each
/// sample.
Packets packets_in_picture(const DeviceContext& context, Estimator estimator, int rays);

/// Whether each ray, camera rays too, has a work-item of its own that takes one box or triangle at
/// a time (kernels/scalar/).
bool traces_scalar(const DeviceContext& context);

/// Sets large_batches for a queue of ray_count pixel rays; returns the number of batches, each of
/// which is a ticket. Independent of the number of threads, since batches decide how visits are
/// counted.
uint split_pixel_rays(OcclusionParams& params);

/// Sets batches_per_ticket for a queue of ray_count point rays; returns the number of tickets.
uint split_point_rays(bool on_cpu, OcclusionParams& params);

}  // namespace dapple

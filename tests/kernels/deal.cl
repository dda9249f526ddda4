#include "deal.clh"

__kernel void deal_items(__global uint* places, uint items, uint count) {
  const uint item = get_global_id(0);
  if (item < items) places[item] = deal(item, count);
}

__kernel void deal_items_in_runs(__global uint* places, uint items, uint count, uint run) {
  const uint item = get_global_id(0);
  if (item < items) places[item] = deal_runs(item, count, run);
}

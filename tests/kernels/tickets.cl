#include "vectors/tickets.clh"

/* How often each piece is taken. */
__kernel void take_pieces(__global uint* taken, __global uint* turns, uint first_turn,
                          uint pieces) {
  for (uint piece; (piece = take_turn(turns, first_turn)) < pieces;) atomic_inc(taken + piece);
}
